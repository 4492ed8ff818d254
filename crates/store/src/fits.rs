//! Fits: what is to be fitted, what came out, what could not be done. Old fits stay.

use rusqlite::{OptionalExtension, ToSql, params};

use super::along::insert_along;
use super::blob::pack_f64;
use super::columns::{count_in, from_json, json_in, key_in, series_in, to_json};
use super::journal::Entry;
use super::{StepError, Store, StoreError, Subject, Transaction};
use ieap_domain::{
    AskedFit, ClimateCurve, CurveSource, Drive, Estimate, Fit, Issue, Parameter, Quantity, RunCurve,
};

/// A run that can be fitted, with what its last fit depended on.
#[derive(Debug, Clone, PartialEq)]
pub struct FitTask {
    /// Row id of the run.
    pub run_id: i64,
    /// The run's name.
    pub path: String,
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
    /// Input hash of the current fit, or of the last failure.
    pub done_input_hash: Option<String>,
    /// How the last fit of any revision of the run was asked for.
    pub last_asked: AskedFit,
}

/// What a fit was made from and by.
#[derive(Debug, Clone, PartialEq)]
pub struct FitStamp {
    /// Row id of the run.
    pub run_id: i64,
    /// Hash of data hash, drive, area, length, model and its version.
    pub input_hash: String,
    /// Version of the program.
    pub code_version: String,
    /// How it was asked for by hand.
    pub asked: AskedFit,
}

impl Store {
    /// Current runs in state `ready` whose drive and area are known, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn fit_tasks(&self) -> Result<Vec<FitTask>, StoreError> {
        let doing = "listing runs to fit";
        let _moment = self.snapshot()?;
        let sql = "SELECT run.id, run.path, run.drive, run.area_cm2, run.length_cm,
                          run.data_hash || coalesce((SELECT group_concat(':' || clock || '=' || offset_s, '')
                              FROM clock_offset WHERE run_id = run.id AND applied = 1), '')
                           || coalesce((SELECT group_concat(':' || key || '=' || value, '' ORDER BY key) FROM tag
                              WHERE run_id = run.id AND chosen = 1 AND +key IN ('leave_out', 'leave_out_marked')), '')
                          AS data_hash,
                          coalesce(fit.input_hash, fit_failure.input_hash) AS done_input_hash,
                          run.electrode_resistance_ohm_per_sq, last.asked, last.id AS last_fit,
                          (SELECT CAST(value AS REAL) FROM tag WHERE run_id = run.id AND chosen = 1
                              AND +key = 'electrode_resistance_error_ohm_per_sq')
                          AS electrode_resistance_error_ohm_per_sq,
                          (SELECT value FROM tag WHERE run_id = run.id AND chosen = 1 AND +key = 'sample') AS sample
                   FROM run LEFT JOIN fit ON fit.run_id = run.id AND fit.superseded_at IS NULL
                            LEFT JOIN fit_failure ON fit_failure.run_id = run.id
                            LEFT JOIN (SELECT own.path, max(earlier.id) AS fit_id
                                       FROM fit AS earlier NOT INDEXED
                                       JOIN run AS own NOT INDEXED ON own.id = earlier.run_id
                                       GROUP BY own.path) AS newest ON newest.path = run.path
                            LEFT JOIN fit AS last ON last.id = newest.fit_id
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
            let last_fit: Option<i64> = row.get("last_fit").map_err(|e| self.failed(doing, e))?;
            last_fit.map_or(Ok(()), |id| self.check_seal(&Subject::Fit(id)))?;
            let read = || -> Result<FitTask, StepError> {
                Ok(FitTask {
                    run_id: row.get("id")?,
                    path: row.get("path")?,
                    drive: json_in(row, "drive", "a run's drive")?,
                    area_cm2: row.get("area_cm2")?,
                    length_cm: row.get("length_cm")?,
                    data_hash: row.get("data_hash")?,
                    done_input_hash: row.get("done_input_hash")?,
                    electrode_resistance_ohm_per_sq: row.get("electrode_resistance_ohm_per_sq")?,
                    electrode_resistance_error_ohm_per_sq: row
                        .get::<_, Option<f64>>("electrode_resistance_error_ohm_per_sq")?
                        .filter(|error| error.is_finite() && *error > 0.0),
                    sample: row.get("sample")?,
                    last_asked: match row.get::<_, Option<String>>("asked")? {
                        Some(asked) => from_json("how a fit was asked for", &asked)?,
                        None => AskedFit::default(),
                    },
                })
            };
            tasks.push(read().map_err(self.named(doing))?);
        }
        Ok(tasks)
    }

    /// Stores fits, each as the current one of its run.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_fits(&mut self, now: &str, fits: &[(FitStamp, Fit)]) -> Result<(), StoreError> {
        if fits.is_empty() {
            return Ok(());
        }
        self.write("storing fits", now, |transaction| {
            fits.iter()
                .try_for_each(|(stamp, fit)| insert_fit(transaction, now, stamp, fit))
        })
    }

    /// Records that a run could not be fitted, and why. An earlier fit is kept but no longer current.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_fit_failure(&mut self, now: &str, stamp: &FitStamp, issue: &Issue) -> Result<(), StoreError> {
        self.write("storing a fit's failure", now, |transaction| {
            retire_fit(transaction, now, stamp.run_id)?;
            insert_failure(transaction, now, stamp.run_id, &stamp.input_hash, issue)
        })
    }

    /// Curves of the run's current fit; empty where there is none.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn fit_curves(&self, run_id: i64) -> Result<Vec<RunCurve>, StoreError> {
        let Some(fit_id) = self.current_fit(run_id)? else {
            return Ok(Vec::new());
        };
        self.check_seal(&Subject::FitCurves(fit_id))?;
        let sql = "SELECT quantity, readings, time_blob, measured_blob, fitted_blob, residual_blob
                   FROM fit_curve WHERE fit_id = ?1 ORDER BY ordinal";
        self.rows("reading a fit's curves", sql, [fit_id], read_curve)
    }

    /// The seals of all that curves of a run are read from; none where the database has no seals.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn seals_of_curves(&self, run_id: i64) -> Result<Option<String>, StoreError> {
        let mut subjects = vec![Subject::Readings(run_id), Subject::ClimateCurves(run_id)];
        subjects.extend(self.current_fit_as_listed(run_id)?.map(Subject::FitCurves));
        let seals: Result<Option<Vec<String>>, StoreError> = subjects
            .iter()
            .map(|subject| self.seal_in_words(subject))
            .collect();
        Ok(seals?.map(|seals| seals.join(" ")))
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

    /// Row id of the current fit of a run.
    pub(super) fn current_fit(&self, run_id: i64) -> Result<Option<i64>, StoreError> {
        self.check_seal(&Subject::Run(run_id))?;
        self.current_fit_as_listed(run_id)
    }

    /// The same of a run that was held against its seal before.
    fn current_fit_as_listed(&self, run_id: i64) -> Result<Option<i64>, StoreError> {
        self.connection
            .prepare_cached("SELECT id FROM fit WHERE run_id = ?1 AND superseded_at IS NULL")
            .and_then(|mut statement| statement.query_row([run_id], |row| row.get(0)).optional())
            .map_err(|e| self.failed("looking for a fit", e))
    }

    /// The current fit of a run (without curves) with the version of the program that made it.
    pub(super) fn fit(&self, run_id: i64) -> Result<Option<(Fit, String)>, StoreError> {
        self.fit_where("run_id = ?1 AND superseded_at IS NULL", &[&run_id])
    }

    /// The last fit (without curves) that a condition on table `fit` lets through.
    pub(super) fn fit_where(
        &self,
        condition: &str,
        values: &[&dyn ToSql],
    ) -> Result<Option<(Fit, String)>, StoreError> {
        let sql = format!(
            "SELECT id, model, model_version, code_version, method, converged, why_stopped, n_samples,
                    r_squared_current, r_squared_curvature, noise, issues, evaluations
             FROM fit WHERE {condition} ORDER BY id DESC LIMIT 1"
        );
        let found = self.rows("reading a fit", &sql, values, |row| {
            let fit = Fit {
                model: row.get("model")?,
                model_version: row.get("model_version")?,
                method: row.get("method")?,
                converged: row.get("converged")?,
                why_stopped: row.get("why_stopped")?,
                n_samples: count_in(row, "n_samples")?,
                parameters: Vec::new(),
                r_squared_current: row.get("r_squared_current")?,
                r_squared_curvature: row.get("r_squared_curvature")?,
                noise: Vec::new(),
                curves: Vec::new(),
                along: Vec::new(),
                issues: Vec::new(),
                evaluations: row.get::<_, i64>("evaluations")?.unsigned_abs(),
            };
            // What is JSON is read after the row is held against its seal: damage is to be called damage.
            let texts: (String, String) = (row.get("noise")?, row.get("issues")?);
            Ok((row.get("id")?, fit, row.get("code_version")?, texts))
        })?;
        let Some((fit_id, mut fit, code_version, (noise, issues))) = found.into_iter().next() else {
            return Ok(None);
        };
        self.check_seal(&Subject::Fit(fit_id))?;
        fit.noise = from_json("a fit's noise", &noise)?;
        fit.issues = from_json("a fit's issues", &issues)?;
        fit.parameters = self.parameters(fit_id)?;
        Ok(Some((fit, code_version)))
    }

    fn parameters(&self, fit_id: i64) -> Result<Vec<Parameter>, StoreError> {
        let sql = "SELECT key, value, standard_error, low_95, high_95, at_bound, reason
                   FROM fit_parameter WHERE fit_id = ?1 ORDER BY ordinal";
        self.rows("reading a fit's parameters", sql, [fit_id], read_estimate)
    }

    /// Why the run could not be fitted, where that is so.
    pub(super) fn fit_failure(&self, run_id: i64) -> Result<Option<Issue>, StoreError> {
        let text: Option<String> = self
            .connection
            .prepare_cached("SELECT issue FROM fit_failure WHERE run_id = ?1")
            .and_then(|mut statement| statement.query_row([run_id], |row| row.get(0)).optional())
            .map_err(|e| self.failed("reading a fit's failure", e))?;
        text.map(|text| from_json("a fit's issue", &text)).transpose()
    }
}

impl CurveSource for Store {
    fn curves(&self, run_id: i64) -> Result<Vec<RunCurve>, String> {
        let curves = self.fit_curves(run_id).map_err(|e| e.to_string())?;
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

/// Records why a run, or a modulus log, came to nothing.
pub(super) fn insert_failure(
    transaction: &Transaction<'_>,
    now: &str,
    run_id: i64,
    input_hash: &str,
    issue: &Issue,
) -> Result<(), StepError> {
    let issue = to_json("a fit's issue", issue)?;
    transaction.changes(Subject::Run(run_id))?;
    transaction
        .prepare_cached("INSERT OR REPLACE INTO fit_failure VALUES (?1, ?2, ?3, ?4)")?
        .execute(params![run_id, input_hash, issue, now])?;
    Ok(())
}

/// Marks the current fit and failure of a run as no longer current.
pub(super) fn retire_fit(transaction: &Transaction<'_>, now: &str, run_id: i64) -> Result<(), StepError> {
    transaction.changes(Subject::Run(run_id))?;
    let current = "SELECT id FROM fit WHERE run_id = ?1 AND superseded_at IS NULL";
    for fit_id in transaction.ids(current, run_id)? {
        transaction.changes(Subject::Fit(fit_id))?;
    }
    transaction
        .prepare_cached("UPDATE fit SET superseded_at = ?2 WHERE run_id = ?1 AND superseded_at IS NULL")?
        .execute(params![run_id, now])?;
    transaction
        .prepare_cached("DELETE FROM fit_failure WHERE run_id = ?1")?
        .execute([run_id])?;
    Ok(())
}

fn insert_fit(
    transaction: &Transaction<'_>,
    now: &str,
    stamp: &FitStamp,
    fit: &Fit,
) -> Result<(), StepError> {
    retire_fit(transaction, now, stamp.run_id)?;
    say_how_asked(transaction, now, stamp)?;
    let sql = "INSERT INTO fit (run_id, input_hash, model, model_version, code_version, method, converged,
                 why_stopped, n_samples, r_squared_current, r_squared_curvature, noise, issues, evaluations, made_at,
                 asked)
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16)";
    let asked = if stamp.asked.is_open() {
        None
    } else {
        Some(to_json("how a fit was asked for", &stamp.asked)?)
    };
    transaction.prepare_cached(sql)?.execute(params![
        stamp.run_id,
        stamp.input_hash,
        fit.model,
        fit.model_version,
        stamp.code_version,
        fit.method,
        fit.converged,
        fit.why_stopped,
        fit.n_samples as i64,
        fit.r_squared_current,
        fit.r_squared_curvature,
        to_json("a fit's noise", &fit.noise)?,
        to_json("a fit's issues", &fit.issues)?,
        fit.evaluations.cast_signed(),
        now,
        asked,
    ])?;
    let fit_id = transaction.last_insert_rowid();
    transaction.made(Subject::Fit(fit_id));
    transaction.made(Subject::FitCurves(fit_id));
    for (ordinal, parameter) in fit.parameters.iter().enumerate() {
        insert_parameter(transaction, fit_id, ordinal, parameter)?;
    }
    for (ordinal, curve) in fit.curves.iter().enumerate() {
        insert_curve(transaction, "fit_curve", fit_id, ordinal, curve)?;
    }
    for (ordinal, curve) in fit.along.iter().enumerate() {
        insert_along(transaction, fit_id, ordinal, curve)?;
    }
    Ok(())
}

/// Says how the fit was asked for, where that is another way than the last fit of any revision of the run was.
fn say_how_asked(transaction: &Transaction<'_>, now: &str, stamp: &FitStamp) -> Result<(), StepError> {
    let sql = "SELECT own.path, (SELECT asked FROM fit WHERE id = (
                   SELECT max(fit.id) FROM fit JOIN run ON run.id = fit.run_id WHERE run.path = own.path)) AS last
               FROM run AS own WHERE own.id = ?1";
    let (run, last): (String, Option<String>) = transaction
        .prepare_cached(sql)?
        .query_row([stamp.run_id], |row| Ok((row.get("path")?, row.get("last")?)))?;
    let last: AskedFit = match last {
        Some(asked) => from_json("how a fit was asked for", &asked)?,
        None => AskedFit::default(),
    };
    let asked = if stamp.asked.is_open() {
        AskedFit::default()
    } else {
        stamp.asked.clone()
    };
    if asked != last {
        transaction.says(now, Entry::Asked { run, asked });
    }
    Ok(())
}

fn insert_parameter(
    transaction: &Transaction<'_>,
    fit_id: i64,
    ordinal: usize,
    parameter: &Parameter,
) -> Result<(), StepError> {
    let estimate = &parameter.estimate;
    transaction
        .prepare_cached("INSERT INTO fit_parameter VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)")?
        .execute(params![
            fit_id,
            ordinal as i64,
            parameter.key,
            finite(estimate.value),
            finite(estimate.standard_error),
            finite(estimate.low_95),
            finite(estimate.high_95),
            estimate.at_bound,
            estimate.reason,
        ])?;
    Ok(())
}

/// A parameter of a fit or of an analysis.
pub(super) fn read_estimate(row: &rusqlite::Row<'_>) -> Result<Parameter, StepError> {
    let estimate = Estimate {
        value: row.get("value")?,
        standard_error: row.get("standard_error")?,
        low_95: row.get("low_95")?,
        high_95: row.get("high_95")?,
        at_bound: row.get("at_bound")?,
        reason: row.get("reason")?,
    };
    Ok(Parameter {
        key: row.get("key")?,
        estimate,
    })
}

/// SQLite stores NaN as NULL without a word and infinities as numbers: neither may pass for a measured value.
pub(super) fn finite(number: Option<f64>) -> Option<f64> {
    number.filter(|number| number.is_finite())
}

/// Inserts a curve of a fit into `fit_curve`, or of an analysis into `modulus_curve`.
pub(super) fn insert_curve(
    transaction: &Transaction<'_>,
    table: &str,
    of: i64,
    ordinal: usize,
    curve: &RunCurve,
) -> Result<(), StepError> {
    transaction
        .prepare_cached(&format!(
            "INSERT INTO {table} VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)"
        ))?
        .execute(params![
            of,
            ordinal as i64,
            curve.quantity.key(),
            curve.readings as i64,
            pack_f64(&curve.time_s)?,
            pack_f64(&curve.measured)?,
            pack_f64(&curve.fitted)?,
            pack_f64(&curve.residual_sigma)?,
        ])?;
    Ok(())
}

pub(super) fn read_curve(row: &rusqlite::Row<'_>) -> Result<RunCurve, StepError> {
    Ok(RunCurve {
        quantity: key_in(row, "quantity", "a curve's quantity", Quantity::from_key)?,
        readings: count_in(row, "readings")?,
        time_s: series_in(row, "time_blob")?,
        measured: series_in(row, "measured_blob")?,
        fitted: series_in(row, "fitted_blob")?,
        residual_sigma: series_in(row, "residual_blob")?,
    })
}
