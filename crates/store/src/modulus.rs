//! Analyses of modulus logs: what is to be analysed and what was found. Old ones stay.

use rusqlite::{OptionalExtension, ToSql, params};

use super::columns::{count_in, from_json, to_json};
use super::fits::{finite, insert_curve, insert_failure, read_curve, read_estimate};
use super::{StepError, Store, StoreError, Subject, Transaction};
use ieap_domain::{Issue, ModulusAnalysis, ModulusLog, ModulusStep, Parameter, RunCurve};

/// What an analysis was made from and by.
#[derive(Debug, Clone, PartialEq)]
pub struct ModulusStamp {
    /// Row id of the log.
    pub run_id: i64,
    /// Hash of data hash, column tags and the version of the analysis.
    pub input_hash: String,
    /// Version of the program.
    pub code_version: String,
}

impl Store {
    /// Every current modulus log with its current analysis, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn modulus_logs(&self) -> Result<Vec<ModulusLog>, StoreError> {
        let logs = self.dma_logs()?.into_iter();
        logs.map(|run| {
            let analysis = self.modulus_analysis(run.id)?;
            Ok(ModulusLog { run, analysis })
        })
        .collect()
    }

    /// Input hash of the current analysis of a log, or of the attempt that failed.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn modulus_input_hash(&self, run_id: i64) -> Result<Option<String>, StoreError> {
        let sql = "SELECT input_hash FROM modulus_analysis WHERE run_id = ?1 AND superseded_at IS NULL
                   UNION ALL SELECT input_hash FROM fit_failure WHERE run_id = ?1";
        self.connection
            .prepare_cached(sql)
            .and_then(|mut statement| statement.query_row([run_id], |row| row.get(0)).optional())
            .map_err(|e| self.failed("looking for an analysis", e))
    }

    /// Stores an analysis as the current one of its log, or the reason why there is none.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_modulus_analysis(
        &mut self,
        now: &str,
        stamp: &ModulusStamp,
        analysis: Result<&ModulusAnalysis, &Issue>,
    ) -> Result<(), StoreError> {
        self.write("storing an analysis", now, |transaction| {
            retire_analysis(transaction, now, stamp.run_id)?;
            match analysis {
                Ok(analysis) => insert(transaction, now, stamp, analysis),
                Err(issue) => insert_failure(transaction, now, stamp.run_id, &stamp.input_hash, issue),
            }
        })
    }

    fn modulus_analysis(&self, run_id: i64) -> Result<Option<ModulusAnalysis>, StoreError> {
        self.modulus_analysis_where("run_id = ?1 AND superseded_at IS NULL", &[&run_id])
    }

    /// The last analysis that a condition on table `modulus_analysis` lets through.
    pub(super) fn modulus_analysis_where(
        &self,
        condition: &str,
        values: &[&dyn ToSql],
    ) -> Result<Option<ModulusAnalysis>, StoreError> {
        let sql = format!(
            "SELECT id, analysis_version, modulus_source, frequency_hz, temperature_low_c,
                    temperature_high_c, readings, issues
             FROM modulus_analysis WHERE {condition} ORDER BY id DESC LIMIT 1"
        );
        let found = self.rows("reading an analysis", &sql, values, |row| {
            let low_c: Option<f64> = row.get("temperature_low_c")?;
            let high_c: Option<f64> = row.get("temperature_high_c")?;
            let analysis = ModulusAnalysis {
                version: row.get("analysis_version")?,
                modulus_source: row.get("modulus_source")?,
                frequency_hz: row.get("frequency_hz")?,
                temperature_c: low_c.zip(high_c),
                readings: count_in(row, "readings")?,
                steps: Vec::new(),
                estimates: Vec::new(),
                issues: Vec::new(),
                curves: Vec::new(),
            };
            Ok((row.get("id")?, analysis, row.get::<_, String>("issues")?))
        })?;
        let Some((id, mut analysis, issues)) = found.into_iter().next() else {
            return Ok(None);
        };
        self.check_seal(&Subject::Analysis(id))?;
        analysis.issues = from_json("an analysis's issues", &issues)?;
        analysis.steps = self.modulus_steps(id)?;
        for (step, parameter) in self.modulus_estimates(id)? {
            match step.and_then(|step| analysis.steps.get_mut(step)) {
                Some(step) => step.estimates.push(parameter),
                None => analysis.estimates.push(parameter),
            }
        }
        analysis.curves = self.modulus_curves(id)?;
        Ok(Some(analysis))
    }

    fn modulus_steps(&self, id: i64) -> Result<Vec<ModulusStep>, StoreError> {
        let sql =
            "SELECT start_s, settled_s, end_s FROM modulus_step WHERE analysis_id = ?1 ORDER BY ordinal";
        self.rows_of(id, sql, |row| {
            Ok(ModulusStep {
                start_s: row.get("start_s")?,
                settled_s: row.get("settled_s")?,
                end_s: row.get("end_s")?,
                estimates: Vec::new(),
            })
        })
    }

    fn modulus_estimates(&self, id: i64) -> Result<Vec<(Option<usize>, Parameter)>, StoreError> {
        let sql = "SELECT key, value, standard_error, low_95, high_95, at_bound, reason, step
                   FROM modulus_estimate WHERE analysis_id = ?1 ORDER BY ordinal";
        self.rows_of(id, sql, |row| {
            let step: Option<i64> = row.get("step")?;
            let step = step.and_then(|step| usize::try_from(step).ok());
            Ok((step, read_estimate(row)?))
        })
    }

    fn modulus_curves(&self, id: i64) -> Result<Vec<RunCurve>, StoreError> {
        let sql = "SELECT quantity, readings, time_blob, measured_blob, fitted_blob, residual_blob
                   FROM modulus_curve WHERE analysis_id = ?1 ORDER BY ordinal";
        self.rows_of(id, sql, read_curve)
    }
}

/// Marks the current analysis of a log, and a failure to make one, as no longer current.
pub(super) fn retire_analysis(
    transaction: &Transaction<'_>,
    now: &str,
    run_id: i64,
) -> Result<(), StepError> {
    transaction.changes(Subject::Run(run_id))?;
    let current = "SELECT id FROM modulus_analysis WHERE run_id = ?1 AND superseded_at IS NULL";
    for id in transaction.ids(current, run_id)? {
        transaction.changes(Subject::Analysis(id))?;
    }
    let sql = "UPDATE modulus_analysis SET superseded_at = ?2 WHERE run_id = ?1 AND superseded_at IS NULL";
    transaction.prepare_cached(sql)?.execute(params![run_id, now])?;
    transaction
        .prepare_cached("DELETE FROM fit_failure WHERE run_id = ?1")?
        .execute([run_id])?;
    Ok(())
}

fn insert(
    transaction: &Transaction<'_>,
    now: &str,
    stamp: &ModulusStamp,
    analysis: &ModulusAnalysis,
) -> Result<(), StepError> {
    let sql =
        "INSERT INTO modulus_analysis (run_id, input_hash, analysis_version, code_version, modulus_source,
                 frequency_hz, temperature_low_c, temperature_high_c, readings, issues, made_at)
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)";
    transaction.prepare_cached(sql)?.execute(params![
        stamp.run_id,
        stamp.input_hash,
        analysis.version,
        stamp.code_version,
        analysis.modulus_source,
        finite(analysis.frequency_hz),
        analysis.temperature_c.map(|(low, _)| low),
        analysis.temperature_c.map(|(_, high)| high),
        analysis.readings as i64,
        to_json("an analysis's issues", &analysis.issues)?,
        now,
    ])?;
    let id = transaction.last_insert_rowid();
    transaction.made(Subject::Analysis(id));
    for (ordinal, step) in analysis.steps.iter().enumerate() {
        transaction
            .prepare_cached("INSERT INTO modulus_step VALUES (?1, ?2, ?3, ?4, ?5)")?
            .execute(params![
                id,
                ordinal as i64,
                step.start_s,
                step.settled_s,
                step.end_s
            ])?;
    }
    let of_steps = analysis.steps.iter().enumerate();
    let of_steps = of_steps.flat_map(|(step, found)| found.estimates.iter().map(move |p| (Some(step), p)));
    let of_log = analysis.estimates.iter().map(|parameter| (None, parameter));
    for (ordinal, (step, parameter)) in of_steps.chain(of_log).enumerate() {
        insert_estimate(transaction, id, ordinal, step, parameter)?;
    }
    for (ordinal, curve) in analysis.curves.iter().enumerate() {
        insert_curve(transaction, "modulus_curve", id, ordinal, curve)?;
    }
    Ok(())
}

fn insert_estimate(
    transaction: &Transaction<'_>,
    id: i64,
    ordinal: usize,
    step: Option<usize>,
    parameter: &Parameter,
) -> Result<(), StepError> {
    let estimate = &parameter.estimate;
    transaction
        .prepare_cached("INSERT INTO modulus_estimate VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)")?
        .execute(params![
            id,
            ordinal as i64,
            step.map(|step| step as i64),
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
