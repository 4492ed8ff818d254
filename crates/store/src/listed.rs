//! Lists of current runs by what is said of them, without the runs themselves.

use std::collections::BTreeSet;

use rusqlite::Params;

use super::runs::read_issue;
use super::{StepError, Store, StoreError, Subject};
use ieap_domain::Issue;

impl Store {
    /// Names of current runs and modulus logs that lack tags.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn untagged_runs(&self) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT id, path FROM run WHERE superseded_at IS NULL AND state = 'untagged' ORDER BY path";
        self.listed(sql, [], |row| Ok(row.get("path")?))
    }

    /// Names of current runs whose voltage does not go in steps.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn runs_without_steps(&self) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT id, path FROM run WHERE superseded_at IS NULL AND no_steps = 1 ORDER BY path";
        self.listed(sql, [], |row| Ok(row.get("path")?))
    }

    /// Issues with that code of current runs and modulus logs, with the name of the run.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn issues_of_code(&self, code: &str) -> Result<Vec<(String, Issue)>, StoreError> {
        let sql =
            "SELECT severity, code, place, message, mend, path, run.id AS id FROM run_issue JOIN run ON run.id = run_id
                   WHERE superseded_at IS NULL AND code = ?1 ORDER BY path, ordinal";
        self.listed(sql, [code], |row| Ok((row.get("path")?, read_issue(row)?)))
    }

    /// What a query finds of current runs; its column `id` says of which, and they are held against their seals.
    fn listed<T>(
        &self,
        sql: &str,
        parameters: impl Params,
        read: impl Fn(&rusqlite::Row<'_>) -> Result<T, StepError>,
    ) -> Result<Vec<T>, StoreError> {
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Runs)?;
        let found = self.rows("listing runs", sql, parameters, |row| {
            Ok((row.get::<_, i64>("id")?, read(row)?))
        })?;
        let mut checked = BTreeSet::new();
        for (run_id, _) in &found {
            if checked.insert(*run_id) {
                self.check_seal(&Subject::Run(*run_id))?;
            }
        }
        Ok(found.into_iter().map(|(_, listed)| listed).collect())
    }
}
