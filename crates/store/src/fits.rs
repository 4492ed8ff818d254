//! Fits: what is to be fitted, what came out, what could not be done.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::journal::{Entry, Line, read_line};
use super::new_run::RunRow;
use super::results::{self, NewResult, ResultDocument, ResultKind, StoredResult, Subject};
use super::rows::{JOURNAL_LINE, RowHash, check};
use super::{StepError, Store, StoreError, Transaction};
use ieap_domain::tag::keys;
use ieap_domain::{
    AlongCurve, AskedFit, ClimateCurve, CurveSource, Drive, Fit, RunCurve, RunKind, RunRecord, RunState,
};

/// A run that can be fitted, with what its last fit depended on.
#[derive(Debug, Clone, PartialEq)]
pub struct FitTask {
    /// Row id of the run.
    pub run_id: i64,
    /// The run's name.
    pub path: String,
    /// Which revision of it.
    pub revision: u32,
    /// The drive.
    pub drive: Drive,
    /// Active area, cm2.
    pub area_cm2: f64,
    /// Free length, cm, where it is known.
    pub length_cm: Option<f64>,
    /// Resistance of both electrodes along the strip, Ohm per square, where it was measured.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
    /// Its standard error, where it is known.
    pub electrode_resistance_error_ohm_per_sq: Option<f64>,
    /// Sample of the run, by its tag.
    pub sample: Option<String>,
    /// Instrument that recorded it, by its tag.
    pub instrument: Option<String>,
    /// When it began, by its tag.
    pub started_at: Option<String>,
    /// Hash of the readings, with the clock offsets that are applied and the tags that leave readings out.
    pub data_hash: String,
    /// Hash of what logs say of the climate around it, where one covers it.
    pub climate_hash: Option<String>,
    /// How the last fit of any revision of the run was asked for.
    pub last_asked: AskedFit,
}

/// How a fit was asked for by hand: the run's row id, and what was asked for.
pub type AskedOf<'a> = (i64, &'a AskedFit);

/// What tells whether anything changed of a run, its readings and its fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StateOfRun {
    /// Hash of its row, which states those of its readings and of what is drawn beside them.
    pub run: RowHash,
    /// The same of the row of its fit; none where it has none.
    pub fit: Option<RowHash>,
}

impl ResultDocument for Fit {
    const DRAWN: &'static [&'static str] = &["curves", "along"];
}

/// What pages draw of a fit.
#[derive(Debug, Clone, Default, PartialEq, serde::Deserialize)]
pub struct FitCurves {
    /// Readings with the fitted value and the residual beside each.
    pub curves: Vec<RunCurve>,
    /// The same along the strip.
    pub along: Vec<AlongCurve>,
}

impl Store {
    /// Current runs in state `ready` whose drive and area are known, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn fit_tasks(&self) -> Result<Vec<FitTask>, StoreError> {
        let _moment = self.snapshot()?;
        let words = self.words()?;
        let said_of = self.said_of_all()?;
        let runs = self.current_rows(RunKind::Actuation)?;
        let ready = runs.iter().filter(|run| run.state == RunState::Ready);
        Ok(ready
            .filter_map(|run| fit_task(run, words.said_of(&said_of[&run.path]).asked))
            .collect())
    }

    /// Stores fits, or why there are none, each as the current result of its run, and how those were asked for that came out;
    /// tells of each whether it is stored.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_fits(
        &mut self,
        now: &str,
        fits: &[NewResult<'_, Fit>],
        asked: &[AskedOf<'_>],
    ) -> Result<Vec<bool>, StoreError> {
        if fits.is_empty() {
            return Ok(Vec::new());
        }
        self.write("storing fits", now, |transaction| {
            let kept = results::keep(transaction, now, ResultKind::Fit, fits)?;
            let came_out = |run_id: i64| {
                let mut fits = fits.iter().zip(&kept);
                fits.any(|(fit, kept)| *kept && fit.found.is_ok() && fit.of == Subject::Run(run_id))
            };
            for &(run_id, asked) in asked.iter().filter(|(run_id, _)| came_out(*run_id)) {
                say_asked(transaction, now, run_id, asked)?;
            }
            Ok(kept)
        })
    }

    /// What pages draw of the current fit of a run, as it is stored; nothing where there is none, or where the fit came from
    /// elsewhere.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn fit_curves(&self, run: &str) -> Result<FitCurves, StoreError> {
        Ok(self.drawn(ResultKind::Fit, run)?.unwrap_or_default())
    }

    /// What tells whether anything changed of each current run, by row id: the hashes of its row and of that of its fit.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn states_of_runs(&self) -> Result<Arc<BTreeMap<i64, StateOfRun>>, StoreError> {
        self.whole("states of runs", |store| {
            let fits = store.fits()?;
            let of_fits: BTreeMap<&str, RowHash> = (fits.iter())
                .map(|fit| (fit.origin.name.as_str(), fit.origin.row_hash))
                .collect();
            let runs = store.all_current_rows()?.into_iter();
            let state = |run: Arc<RunRow>| {
                let fit = of_fits.get(run.path.as_str()).copied();
                (
                    run.id,
                    StateOfRun {
                        run: run.row_hash,
                        fit,
                    },
                )
            };
            Ok(runs.map(state).collect())
        })
    }

    /// What tells whether any current fit changed.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn state_of_all_fits(&self) -> Result<String, StoreError> {
        self.state_of_lists(&["result fit"])
    }

    /// Every current fit, by run.
    pub(super) fn fits(&self) -> Result<Arc<Vec<StoredResult<Fit>>>, StoreError> {
        self.all_results("fits", ResultKind::Fit)
    }

    /// Fills in the fits of runs, and why there is none where it was tried.
    pub(super) fn fill_in_fits(&self, records: &mut [RunRecord]) -> Result<(), StoreError> {
        let fits = self.fits()?;
        for record in records {
            let stored = fits.binary_search_by(|stored| stored.origin.name.cmp(&record.path));
            fill_in_fit(record, stored.ok().map(|at| fits[at].clone()));
        }
        Ok(())
    }
}

/// Says how the fit of a run was asked for, under the name that the run has now, where that is not what holds already.
fn say_asked(
    transaction: &Transaction<'_>,
    now: &str,
    run_id: i64,
    asked: &AskedFit,
) -> Result<(), StepError> {
    let Some(run) = RunRow::current(transaction, run_id)? else {
        return Ok(());
    };
    let sql = JOURNAL_LINE.select("", "WHERE what = 'asked' AND name = ?1 ORDER BY n DESC LIMIT 1");
    let mut statement = transaction.prepare_cached(&sql)?;
    let mut newest: Option<Line> = None;
    for of in run.said_of(&BTreeSet::new()) {
        let mut rows = statement.query([&of])?;
        if let Some(row) = rows.next()? {
            check(JOURNAL_LINE, row)?;
            let line = read_line(row)?;
            newest = newest.filter(|newest| newest.n > line.n).or(Some(line));
        }
    }
    let holds = match newest.map(|line| line.entry) {
        Some(Entry::Asked { asked, .. }) => asked,
        _ => AskedFit::default(),
    };
    if holds == *asked || (holds.is_open() && asked.is_open()) {
        return Ok(());
    }
    let asked = if asked.is_open() {
        AskedFit::default()
    } else {
        asked.clone()
    };
    transaction.says(now, Entry::Asked { run: run.path, asked })
}

/// Fills in the fit of a run, or why there is none where it was tried.
pub(super) fn fill_in_fit(record: &mut RunRecord, stored: Option<StoredResult<Fit>>) {
    match stored {
        Some(StoredResult {
            found: Ok(fit),
            origin,
        }) => {
            record.fit = Some(fit);
            record.fit_made_by = Some(origin.made_by);
        }
        Some(StoredResult {
            found: Err(issue), ..
        }) => record.issues.push(issue),
        None => {}
    }
}

impl CurveSource for Store {
    fn curves(&self, run_id: i64) -> Result<Vec<RunCurve>, String> {
        let run = self.run_of(run_id).map_err(|e| e.to_string())?;
        let curves = self.fit_curves(&run.path).map_err(|e| e.to_string())?.curves;
        if !curves.is_empty() {
            return Ok(curves);
        }
        let channels = self.channels(run_id).map_err(|e| e.to_string())?;
        Ok(channels
            .iter()
            .filter(|c| c.quantity.is_response() && c.position_mm.is_none() && !c.is_empty())
            .map(|c| c.drawn())
            .collect())
    }

    fn climate_curves(&self, run_id: i64) -> Result<Vec<ClimateCurve>, String> {
        self.run_climate_curves(run_id).map_err(|e| e.to_string())
    }

    fn drawn_from(&self, run_id: i64) -> Result<Option<String>, String> {
        let states = self.states_of_runs().map_err(|e| e.to_string())?;
        Ok(states.get(&run_id).map(|state| format!("{state:?}")))
    }
}

/// What is to be fitted of a run, where its drive and area are known.
fn fit_task(run: &RunRow, last_asked: AskedFit) -> Option<FitTask> {
    let tagging = &run.tagging;
    let error = tagging.chosen.get(keys::ELECTRODE_RESISTANCE_ERROR);
    let error: Option<f64> = error.and_then(|error| error.parse().ok());
    Some(FitTask {
        run_id: run.id,
        revision: run.revision,
        drive: tagging.drive.clone()?,
        area_cm2: tagging.area_cm2?,
        length_cm: tagging.length_cm,
        electrode_resistance_ohm_per_sq: tagging.electrode_resistance_ohm_per_sq,
        // It is the error of what is known, and of nothing else.
        electrode_resistance_error_ohm_per_sq: tagging
            .electrode_resistance_ohm_per_sq
            .and(error.filter(|error| error.is_finite() && *error > 0.0)),
        sample: tagging.chosen.get(keys::SAMPLE).cloned(),
        instrument: tagging.chosen.get(keys::INSTRUMENT).cloned(),
        started_at: tagging.chosen.get(keys::STARTED_AT).cloned(),
        data_hash: run.readings_hash(),
        climate_hash: tagging.climate_curves_hash.clone(),
        last_asked,
        path: run.path.clone(),
    })
}
