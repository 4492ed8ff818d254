//! What stood in the database earlier: runs with the fits, and modulus logs with the analyses, that they had then.

use super::new_run::RunRow;
use super::results::{ResultKind, When};
use super::rows::RUN;
use super::{Store, StoreError};
use ieap_domain::{Fit, ModulusAnalysis, ModulusLog, RunKind, RunRecord};

/// Which earlier state is meant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Earlier {
    /// Every run with the fit that its current one replaced; a run that was fitted once keeps that fit.
    BeforeRefit,
    /// What was current at a moment, RFC 3339 UTC to the second. Tags are those of now: they have no history.
    At(String),
}

impl Store {
    /// Every superseded revision of an actuation run, by path and revision.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn superseded_runs(&self) -> Result<Vec<RunRecord>, StoreError> {
        let _moment = self.snapshot()?;
        let rest = "WHERE superseded_at IS NOT NULL AND kind = ?1 ORDER BY path, revision";
        let kind = RunKind::Actuation.key();
        let rows = self.kept("reading earlier runs", RUN, ("", rest), [kind], RunRow::read)?;
        self.records(&rows, &self.aliases()?)
    }

    /// Actuation runs as they were, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn runs_earlier(&self, earlier: &Earlier) -> Result<Vec<RunRecord>, StoreError> {
        let mut runs = self.runs()?;
        if let Earlier::At(moment) = earlier {
            runs.extend(self.superseded_runs()?);
            let current = self.current_at(moment)?;
            runs.retain(|run| current.contains(&run.id));
            runs.sort_by(|a, b| a.path.cmp(&b.path));
        }
        for run in &mut runs {
            let found = self.result_then::<Fit>(ResultKind::Fit, &run.path, earlier.when())?;
            let found = found.and_then(|stored| Some((stored.found.ok()?, stored.origin.made_by)));
            if found.is_some() || earlier.is_whole() {
                (run.fit, run.fit_made_by) = found.unzip();
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
            let found =
                self.result_then::<ModulusAnalysis>(ResultKind::Modulus, &log.run.path, earlier.when())?;
            let found = found.and_then(|stored| stored.found.ok());
            if found.is_some() || earlier.is_whole() {
                log.analysis = found;
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
}

impl Earlier {
    fn when(&self) -> When<'_> {
        match self {
            Earlier::BeforeRefit => When::Before,
            Earlier::At(moment) => When::At(moment),
        }
    }

    /// Whether what has no earlier result had none then; else it keeps the one that it has.
    fn is_whole(&self) -> bool {
        matches!(self, Earlier::At(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::new_run;
    use crate::{NewResult, Subject};
    use ieap_domain::{MadeBy, RunKind, testing};

    /// Hours of one day, RFC 3339 UTC.
    fn at(hour: u32) -> String {
        format!("2026-01-01T{hour:02}:00:00Z")
    }

    /// The run that there is, by row id.
    fn only_run(store: &Store) -> i64 {
        *store.readings_hashes().unwrap().first_key_value().unwrap().0
    }

    fn save_fit(store: &mut Store, hour: u32, evaluations: u64) {
        let fit = Fit {
            evaluations,
            ..testing::fit(&[])
        };
        let run_id = only_run(store);
        let result = NewResult {
            of: Subject::Run(run_id),
            made_from: &[run_id],
            key: &evaluations.to_string(),
            made_by: &MadeBy::new(format!("version {evaluations}"), ""),
            found: Ok(&fit),
        };
        assert_eq!(store.save_fits(&at(hour), &[result], &[]).unwrap(), [true]);
    }

    /// A run read at 1 h and fitted at 2 and 4 h; new bytes of it at 6 h, fitted at 8 h.
    fn refitted() -> Store {
        let mut store = Store::in_memory().unwrap();
        for (read, fits) in [(1, &[2, 4][..]), (6, &[8])] {
            let run = new_run("runs/a.csv", RunKind::Actuation, &[f64::from(read), 2.0]);
            store.save_runs(&at(read), &[], &[run]).unwrap();
            for &hour in fits {
                save_fit(&mut store, hour, hour.into());
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
                run.fit_made_by.map(|by| by.version.into_owned()),
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
        for hour in [2, 4] {
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
            let run_id = only_run(&store);
            let result = NewResult {
                of: Subject::Run(run_id),
                made_from: &[],
                key: &hour.to_string(),
                made_by: &MadeBy::default(),
                found: Ok(&analysis),
            };
            store
                .keep_results(&at(hour), ResultKind::Modulus, &[result])
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
