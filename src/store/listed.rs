//! Lists of current runs by what is said of them, without the runs themselves.

use rusqlite::Params;

use super::runs::read_issue;
use super::{StepError, Store, StoreError};
use crate::domain::Issue;

impl Store {
    /// Names of current runs and modulus logs that lack tags.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn untagged_runs(&self) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT path FROM run WHERE superseded_at IS NULL AND state = 'untagged' ORDER BY path";
        self.listed(sql, [], |row| Ok(row.get(0)?))
    }

    /// Names of current runs whose voltage does not go in steps.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn runs_without_steps(&self) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT path FROM run WHERE superseded_at IS NULL AND no_steps = 1 ORDER BY path";
        self.listed(sql, [], |row| Ok(row.get(0)?))
    }

    /// Issues with that code of current runs and modulus logs, with the name of the run.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn issues_of_code(&self, code: &str) -> Result<Vec<(String, Issue)>, StoreError> {
        let sql =
            "SELECT severity, code, place, message, mend, path FROM run_issue JOIN run ON run.id = run_id
                   WHERE superseded_at IS NULL AND code = ?1 ORDER BY path, ordinal";
        self.listed(sql, [code], |row| Ok((row.get(5)?, read_issue(row)?)))
    }

    fn listed<T>(
        &self,
        sql: &str,
        parameters: impl Params,
        read: impl Fn(&rusqlite::Row<'_>) -> Result<T, StepError>,
    ) -> Result<Vec<T>, StoreError> {
        let doing = "listing runs";
        let failed = |error| self.failed(doing, error);
        let mut statement = self.connection.prepare_cached(sql).map_err(failed)?;
        let mut rows = statement.query(parameters).map_err(failed)?;
        let mut found = Vec::new();
        while let Some(row) = rows.next().map_err(failed)? {
            found.push(read(row).map_err(self.named(doing))?);
        }
        Ok(found)
    }
}
