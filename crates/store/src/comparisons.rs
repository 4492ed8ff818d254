//! Comparisons of models on runs: the newest one of each run that was asked for.

use rusqlite::params;

use super::columns::{json_in, to_json};
use super::history::read_result_origin;
use super::{ResultOrigin, Store, StoreError, Subject};
use ieap_domain::RunComparison;

/// A comparison with what it was made from.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredComparison {
    /// Row id of the run.
    pub run_id: i64,
    /// Hash of everything that it depends on.
    pub input_hash: String,
    /// What was found.
    pub found: RunComparison,
}

impl Store {
    /// Comparisons of current runs, by the runs' names.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn comparisons(&self) -> Result<Vec<StoredComparison>, StoreError> {
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Comparisons)?;
        let sql = "SELECT run_id, run_comparison.input_hash, document FROM run_comparison
                   JOIN run ON run.id = run_id WHERE run.superseded_at IS NULL ORDER BY run.path";
        self.rows("reading comparisons of models", sql, [], |row| {
            Ok(StoredComparison {
                run_id: row.get("run_id")?,
                input_hash: row.get("input_hash")?,
                found: json_in(row, "document", "a comparison of models")?,
            })
        })
    }

    /// What the comparison of a run was made from and by; none where it has none. It has no row id of its own: the run's
    /// stands in.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn comparison_origin(&self, run_id: i64) -> Result<Option<ResultOrigin>, StoreError> {
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Comparisons)?;
        let sql =
            "SELECT run_id AS id, input_hash, code_version, made_at FROM run_comparison WHERE run_id = ?1";
        let found = self.rows(
            "reading a comparison of models",
            sql,
            [run_id],
            read_result_origin,
        );
        Ok(found?.into_iter().next())
    }

    /// Stores comparisons, each in place of the one before.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_comparisons(
        &mut self,
        now: &str,
        code_version: &str,
        comparisons: &[StoredComparison],
    ) -> Result<(), StoreError> {
        if comparisons.is_empty() {
            return Ok(());
        }
        self.write("storing comparisons of models", now, |transaction| {
            transaction.changes(Subject::Comparisons)?;
            for one in comparisons {
                let document = to_json("a comparison of models", &one.found)?;
                let sql = "INSERT OR REPLACE INTO run_comparison VALUES (?1, ?2, ?3, ?4, ?5)";
                let values = params![one.run_id, one.input_hash, code_version, document, now];
                transaction.prepare_cached(sql)?.execute(values)?;
            }
            Ok(())
        })
    }
}
