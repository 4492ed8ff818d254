//! What stood in the database earlier: runs with the fits, and modulus logs with the analyses, that they had then;
//! and where a current result came from.

use std::collections::BTreeMap;

use rusqlite::{OptionalExtension, ToSql, params};

use super::{Store, StoreError, Subject};
use ieap_domain::{ModulusLog, RunKind, RunRecord};

/// Which earlier state is meant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Earlier {
    /// Every run with the fit that its current one replaced; a run that was fitted once keeps that fit.
    BeforeRefit,
    /// What was current at a moment, RFC 3339 UTC to the second. Tags are those of now: they have no history.
    At(String),
}

/// What a fit, or an analysis of a modulus log, was made from and by.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResultOrigin {
    /// Row id of the fit or analysis.
    pub id: i64,
    /// Hash of everything that it depends on.
    pub input_hash: String,
    /// Version of the program that made it.
    pub code_version: String,
    /// When, RFC 3339 UTC.
    pub made_at: String,
}

/// The last fit of the run's name before its current one.
const FIT_BEFORE: &str = "run_id IN (SELECT id FROM run WHERE path = ?1)
    AND id < (SELECT id FROM fit WHERE run_id = ?2 AND superseded_at IS NULL)";
const ANALYSIS_BEFORE: &str = "run_id IN (SELECT id FROM run WHERE path = ?1)
    AND id < (SELECT id FROM modulus_analysis WHERE run_id = ?2 AND superseded_at IS NULL)";
/// The result that was current at a moment.
const THEN: &str = "run_id = ?1 AND made_at <= ?2 AND (superseded_at IS NULL OR superseded_at > ?2)";

const SUPERSEDED: &str = "SELECT id FROM run WHERE superseded_at IS NOT NULL ORDER BY path, revision";

impl Store {
    /// Every superseded revision of an actuation run, by path and revision.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn superseded_runs(&self) -> Result<Vec<RunRecord>, StoreError> {
        let aliases = self.aliases()?;
        self.records(SUPERSEDED, RunKind::Actuation, |record| {
            self.complete(record, &aliases)
        })
    }

    /// The same with their files alone: of a run that is written anew all day there are thousands.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn earlier_revisions(&self) -> Result<Vec<RunRecord>, StoreError> {
        self.records(SUPERSEDED, RunKind::Actuation, |record| {
            record.files = self.run_files(record.id, &BTreeMap::new())?;
            Ok(())
        })
    }

    /// Actuation runs as they were, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn runs_earlier(&self, earlier: &Earlier) -> Result<Vec<RunRecord>, StoreError> {
        let mut runs = self.runs()?;
        match earlier {
            Earlier::BeforeRefit => {
                for run in &mut runs {
                    if let Some((fit, version)) = self.fit_where(FIT_BEFORE, &[&run.path, &run.id])? {
                        run.fit = Some(fit);
                        run.fit_code_version = Some(version);
                    }
                }
            }
            Earlier::At(moment) => {
                runs.extend(self.superseded_runs()?);
                let current = self.current_at(moment)?;
                runs.retain(|run| current.contains(&run.id));
                for run in &mut runs {
                    let found = self.fit_where(THEN, &[&run.id, moment])?;
                    (run.fit, run.fit_code_version) = found.map_or((None, None), |(f, v)| (Some(f), Some(v)));
                }
                runs.sort_by(|a, b| a.path.cmp(&b.path));
            }
        }
        Ok(runs)
    }

    /// Modulus logs as they were, by path. A log whose file changed since is given by its current revision.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn modulus_logs_earlier(&self, earlier: &Earlier) -> Result<Vec<ModulusLog>, StoreError> {
        let mut logs = self.modulus_logs()?;
        for log in &mut logs {
            let run = &log.run;
            match earlier {
                Earlier::BeforeRefit => {
                    let before = self.modulus_analysis_where(ANALYSIS_BEFORE, &[&run.path, &run.id])?;
                    log.analysis = before.or(log.analysis.take());
                }
                Earlier::At(moment) => {
                    log.analysis = self.modulus_analysis_where(THEN, &[&run.id, moment])?
                }
            }
        }
        Ok(logs)
    }

    /// Row ids of the revisions that were current at a moment.
    fn current_at(&self, moment: &str) -> Result<Vec<i64>, StoreError> {
        let doing = "reading earlier runs";
        let sql =
            "SELECT id FROM run WHERE ingested_at <= ?1 AND (superseded_at IS NULL OR superseded_at > ?1)";
        let mut statement = self
            .connection
            .prepare_cached(sql)
            .map_err(|e| self.failed(doing, e))?;
        let rows = statement
            .query_map([moment], |row| row.get(0))
            .map_err(|e| self.failed(doing, e))?;
        rows.collect::<rusqlite::Result<_>>()
            .map_err(|e| self.failed(doing, e))
    }

    /// Where the current fit of a run came from.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn fit_origin(&self, run_id: i64) -> Result<Option<ResultOrigin>, StoreError> {
        let sql = "SELECT id, input_hash, code_version, made_at FROM fit
                   WHERE run_id = ?1 AND superseded_at IS NULL";
        self.result_origin(sql, params![run_id], Subject::Fit)
    }

    /// Where the current analysis of a modulus log came from.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn modulus_origin(&self, run_id: i64) -> Result<Option<ResultOrigin>, StoreError> {
        let sql = "SELECT id, input_hash, code_version, made_at FROM modulus_analysis
                   WHERE run_id = ?1 AND superseded_at IS NULL";
        self.result_origin(sql, params![run_id], Subject::Analysis)
    }

    fn result_origin(
        &self,
        sql: &str,
        values: &[&dyn ToSql],
        subject: fn(i64) -> Subject,
    ) -> Result<Option<ResultOrigin>, StoreError> {
        let read = |row: &rusqlite::Row<'_>| {
            Ok(ResultOrigin {
                id: row.get(0)?,
                input_hash: row.get(1)?,
                code_version: row.get(2)?,
                made_at: row.get(3)?,
            })
        };
        let found = self
            .connection
            .prepare_cached(sql)
            .and_then(|mut statement| statement.query_row(values, read).optional())
            .map_err(|e| self.failed("reading where a result came from", e))?;
        found
            .iter()
            .try_for_each(|origin| self.check_seal(&subject(origin.id)))?;
        Ok(found)
    }
}
