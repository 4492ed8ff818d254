//! Fits: what is to be fitted, what came out, what could not be done.

use std::collections::BTreeMap;

use rusqlite::params;

use super::columns::{json_in, to_json};
use super::journal::Entry;
use super::results::{self, NewResult, ResultDocument, ResultKind, StoredResult};
use super::{StepError, Store, StoreError, Subject, Transaction};
use ieap_domain::{AlongCurve, AskedFit, ClimateCurve, CurveSource, Drive, Fit, RunCurve, RunRecord};

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
    /// Hash of the readings, with the clock offsets that are applied and the tags that leave readings out.
    pub data_hash: String,
    /// How the last fit of any revision of the run was asked for.
    pub last_asked: AskedFit,
}

/// How a fit that came out was asked for by hand: the run's name, and what was asked for.
pub type AskedOf<'a> = (&'a str, &'a AskedFit);

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
        let doing = "listing runs to fit";
        let _moment = self.snapshot()?;
        let mut asked = self.asked_fits()?;
        let sql = "SELECT run.id, run.path, run.revision, run.drive, run.area_cm2, run.length_cm,
                          run.data_hash || coalesce((SELECT group_concat(':' || clock || '=' || offset_s, '')
                              FROM clock_offset WHERE run_id = run.id AND applied = 1), '')
                           || coalesce((SELECT group_concat(':' || key || '=' || value, '' ORDER BY key) FROM tag
                              WHERE run_id = run.id AND chosen = 1 AND +key IN ('leave_out', 'leave_out_marked')), '')
                          AS data_hash,
                          run.electrode_resistance_ohm_per_sq,
                          (SELECT CAST(value AS REAL) FROM tag WHERE run_id = run.id AND chosen = 1
                              AND +key = 'electrode_resistance_error_ohm_per_sq')
                          AS electrode_resistance_error_ohm_per_sq,
                          (SELECT value FROM tag WHERE run_id = run.id AND chosen = 1 AND +key = 'sample') AS sample
                   FROM run
                   WHERE run.superseded_at IS NULL AND run.state = 'ready' AND run.kind = 'actuation'
                     AND run.drive IS NOT NULL AND run.area_cm2 IS NOT NULL
                   ORDER BY run.path";
        let mut statement = self
            .connection
            .prepare_cached(sql)
            .map_err(|e| self.failed(doing, e))?;
        let mut rows = statement.query([]).map_err(|e| self.failed(doing, e))?;
        let mut tasks = Vec::new();
        while let Some(row) = rows.next().map_err(|e| self.failed(doing, e))? {
            self.check_seal(&Subject::Run(row.get("id").map_err(|e| self.failed(doing, e))?))?;
            let mut read = || -> Result<FitTask, StepError> {
                let path: String = row.get("path")?;
                Ok(FitTask {
                    run_id: row.get("id")?,
                    last_asked: asked.remove(&path).unwrap_or_default(),
                    path,
                    revision: row.get("revision")?,
                    drive: json_in(row, "drive", "a run's drive")?,
                    area_cm2: row.get("area_cm2")?,
                    length_cm: row.get("length_cm")?,
                    data_hash: row.get("data_hash")?,
                    electrode_resistance_ohm_per_sq: row.get("electrode_resistance_ohm_per_sq")?,
                    electrode_resistance_error_ohm_per_sq: row
                        .get::<_, Option<f64>>("electrode_resistance_error_ohm_per_sq")?
                        .filter(|error| error.is_finite() && *error > 0.0),
                    sample: row.get("sample")?,
                })
            };
            tasks.push(read().map_err(self.named(doing))?);
        }
        Ok(tasks)
    }

    /// Stores fits, or why there are none, each as the current result of its run, and how those were asked for that came out.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_fits(
        &mut self,
        now: &str,
        fits: &[NewResult<'_, Fit>],
        asked: &[AskedOf<'_>],
    ) -> Result<(), StoreError> {
        if fits.is_empty() {
            return Ok(());
        }
        let (known, open) = (self.asked_fits()?, AskedFit::default());
        self.write("storing fits", now, |transaction| {
            results::keep(transaction, now, ResultKind::Fit, fits)?;
            for &(run, asked) in asked {
                let asked = if asked.is_open() { &open } else { asked };
                if asked != known.get(run).unwrap_or(&open) {
                    say_how_asked(transaction, now, run, asked)?;
                }
            }
            Ok(())
        })
    }

    /// Records how a run was asked to be fitted, of which somebody was told already.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn ask_fit(&mut self, now: &str, run: &str, asked: &AskedFit) -> Result<(), StoreError> {
        self.write("storing how a fit was asked for", now, |transaction| {
            put_asked(transaction, run, asked)
        })
    }

    /// How runs were last asked to be fitted by hand, by their names.
    fn asked_fits(&self) -> Result<BTreeMap<String, AskedFit>, StoreError> {
        self.check_seal(&Subject::AskedFits)?;
        let sql = "SELECT run_path, asked FROM asked_fit";
        let asked = self.rows("reading how fits were asked for", sql, [], |row| {
            Ok((
                row.get("run_path")?,
                json_in(row, "asked", "how a fit was asked for")?,
            ))
        });
        Ok(asked?.into_iter().collect())
    }

    /// What pages draw of the current fit of a run; nothing where there is none.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn fit_curves(&self, run: &str) -> Result<FitCurves, StoreError> {
        Ok(self.drawn(ResultKind::Fit, run)?.unwrap_or_default())
    }

    /// What tells whether anything changed that curves of a run are drawn from; none where the database has no seals.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn seals_of_curves(&self, run_id: i64) -> Result<Option<String>, StoreError> {
        let subjects = [Subject::Readings(run_id), Subject::ClimateCurves(run_id)];
        let seals: Result<Option<Vec<String>>, StoreError> = subjects
            .iter()
            .map(|subject| self.seal_in_words(subject))
            .collect();
        let drawn = self
            .drawn_hash(ResultKind::Fit, &self.name_of(run_id)?)?
            .unwrap_or_default();
        Ok(seals?.map(|seals| format!("{} {drawn}", seals.join(" "))))
    }

    /// The seals of a run and of its readings, by which anyone knows whether they changed; none where the database has no
    /// seals.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn seals_of_readings(&self, run_id: i64) -> Result<Option<String>, StoreError> {
        let run = self.seal_in_words(&Subject::Run(run_id))?;
        let readings = self.seal_in_words(&Subject::Readings(run_id))?;
        Ok(run
            .zip(readings)
            .map(|(run, readings)| format!("{run} {readings}")))
    }

    /// Name of a run.
    fn name_of(&self, run_id: i64) -> Result<String, StoreError> {
        self.connection
            .prepare_cached("SELECT path FROM run WHERE id = ?1")
            .and_then(|mut statement| statement.query_row([run_id], |row| row.get(0)))
            .map_err(|e| self.failed("reading a run's name", e))
    }

    /// Fills in the fits of runs, and why there is none where it was tried.
    pub(super) fn fill_in_fits(&self, records: &mut [RunRecord]) -> Result<(), StoreError> {
        let fits = self.results::<Fit>(ResultKind::Fit)?.into_iter();
        let mut fits: BTreeMap<String, StoredResult<Fit>> =
            fits.map(|stored| (stored.origin.name.clone(), stored)).collect();
        for record in records {
            let stored = fits.remove(&record.path);
            fill_in_fit(record, stored);
        }
        Ok(())
    }
}

/// Fills in the fit of a run, or why there is none where it was tried.
pub(super) fn fill_in_fit(record: &mut RunRecord, stored: Option<StoredResult<Fit>>) {
    match stored {
        Some(StoredResult {
            found: Ok(fit),
            origin,
        }) => {
            record.fit = Some(fit);
            record.fit_code_version = Some(origin.version);
        }
        Some(StoredResult {
            found: Err(issue), ..
        }) => record.issues.push(issue),
        None => {}
    }
}

impl CurveSource for Store {
    fn curves(&self, run_id: i64) -> Result<Vec<RunCurve>, String> {
        let name = self.name_of(run_id).map_err(|e| e.to_string())?;
        let curves = self.fit_curves(&name).map_err(|e| e.to_string())?.curves;
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
        self.seals_of_curves(run_id).map_err(|e| e.to_string())
    }
}

/// Says how a run was asked to be fitted, which is another way than before.
fn say_how_asked(
    transaction: &Transaction<'_>,
    now: &str,
    run: &str,
    asked: &AskedFit,
) -> Result<(), StepError> {
    put_asked(transaction, run, asked)?;
    let (run, asked) = (run.to_owned(), asked.clone());
    transaction.says(now, Entry::Asked { run, asked });
    Ok(())
}

fn put_asked(transaction: &Transaction<'_>, run: &str, asked: &AskedFit) -> Result<(), StepError> {
    transaction.changes(Subject::AskedFits)?;
    if asked.is_open() {
        transaction
            .prepare_cached("DELETE FROM asked_fit WHERE run_path = ?1")?
            .execute([run])?;
    } else {
        transaction
            .prepare_cached("INSERT OR REPLACE INTO asked_fit VALUES (?1, ?2)")?
            .execute(params![run, to_json("how a fit was asked for", asked)?])?;
    }
    Ok(())
}
