//! What stood in the database earlier: runs with the fits, and modulus logs with the analyses, that they had then;
//! and where a current result came from.

use std::collections::BTreeMap;

use rusqlite::{ToSql, params};

use super::{StepError, Store, StoreError, Subject};
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
        self.rows(doing, sql, [moment], |row| Ok(row.get(0)?))
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
        let found = self.rows(
            "reading where a result came from",
            sql,
            values,
            read_result_origin,
        )?;
        found
            .iter()
            .try_for_each(|origin| self.check_seal(&subject(origin.id)))?;
        Ok(found.into_iter().next())
    }
}

pub(super) fn read_result_origin(row: &rusqlite::Row<'_>) -> Result<ResultOrigin, StepError> {
    Ok(ResultOrigin {
        id: row.get("id")?,
        input_hash: row.get("input_hash")?,
        code_version: row.get("code_version")?,
        made_at: row.get("made_at")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::new_run;
    use crate::{FitStamp, ModulusStamp};
    use ieap_domain::{AskedFit, Fit, ModulusAnalysis, RunKind, testing};

    /// Hours of one day, RFC 3339 UTC.
    fn at(hour: u32) -> String {
        format!("2026-01-01T{hour:02}:00:00Z")
    }

    fn save_fit(store: &mut Store, hour: u32, run_id: i64, evaluations: u64) {
        let stamp = FitStamp {
            run_id,
            input_hash: evaluations.to_string(),
            code_version: format!("version {evaluations}"),
            asked: AskedFit::default(),
        };
        let fit = Fit {
            evaluations,
            ..testing::fit(&[])
        };
        store.save_fits(&at(hour), &[(stamp, fit)]).unwrap();
    }

    /// A run read at 1 h and fitted at 2 and 4 h; new bytes of it at 6 h, fitted at 8 h.
    fn refitted() -> Store {
        let mut store = Store::in_memory().unwrap();
        for (read, fits) in [(1, &[2, 4][..]), (6, &[8])] {
            let run = new_run("runs/a.csv", RunKind::Actuation, &[f64::from(read), 2.0]);
            store.save_runs(&at(read), &[], &[run]).unwrap();
            let id = store.runs().unwrap()[0].id;
            for &hour in fits {
                save_fit(&mut store, hour, id, hour.into());
            }
        }
        store
    }

    /// Revision, evaluations of the fit and version of the program of every run then.
    fn then(store: &Store, earlier: &Earlier) -> Vec<(u32, Option<u64>, Option<String>)> {
        let runs = store.runs_earlier(earlier).unwrap().into_iter();
        runs.map(|run| {
            (
                run.revision,
                run.fit.map(|fit| fit.evaluations),
                run.fit_code_version,
            )
        })
        .collect()
    }

    #[test]
    fn at_a_moment_each_run_has_the_fit_that_was_current_then() {
        let store = refitted();
        let fitted = |revision, hour: u64| vec![(revision, Some(hour), Some(format!("version {hour}")))];
        for (hour, expected) in [
            (0, vec![]),
            (1, vec![(1, None, None)]),
            (2, fitted(1, 2)),
            (3, fitted(1, 2)),
            (4, fitted(1, 4)),
            (5, fitted(1, 4)),
            (6, vec![(2, None, None)]),
            (8, fitted(2, 8)),
            (9, fitted(2, 8)),
        ] {
            assert_eq!(then(&store, &Earlier::At(at(hour))), expected, "at {hour} h");
        }
        // The fit before the current one is that of the earlier bytes.
        assert_eq!(
            then(&store, &Earlier::BeforeRefit),
            [(2, Some(4), Some("version 4".to_owned()))]
        );
    }

    #[test]
    fn at_a_moment_each_modulus_log_has_the_analysis_that_was_current_then() {
        let mut store = Store::in_memory().unwrap();
        let log = new_run("dma/a.csv", RunKind::Dma, &[1.0, 2.0]);
        store.save_runs(&at(1), &[], &[log]).unwrap();
        let run_id = store.dma_logs().unwrap()[0].id;
        for hour in [2, 4] {
            let stamp = ModulusStamp {
                run_id,
                input_hash: hour.to_string(),
                code_version: String::new(),
            };
            let analysis = ModulusAnalysis {
                version: hour,
                modulus_source: String::new(),
                frequency_hz: None,
                temperature_c: None,
                readings: 2,
                steps: Vec::new(),
                estimates: Vec::new(),
                issues: Vec::new(),
                curves: Vec::new(),
            };
            store
                .save_modulus_analysis(&at(hour), &stamp, Ok(&analysis))
                .unwrap();
        }
        let then = |earlier: &Earlier| {
            let logs = store.modulus_logs_earlier(earlier).unwrap();
            logs[0].analysis.as_ref().map(|analysis| analysis.version)
        };
        let found = [1, 2, 3, 4, 5].map(|hour| then(&Earlier::At(at(hour))));
        assert_eq!(found, [None, Some(2), Some(2), Some(4), Some(4)]);
        assert_eq!(then(&Earlier::BeforeRefit), Some(2));
    }
}
