//! One run, without a look at the others: what asking for it costs does not grow with the campaign.

use std::collections::BTreeMap;

use rusqlite::OptionalExtension;

use super::fits::fill_in_fit;
use super::{ResultKind, Store, StoreError};
use ieap_domain::{RunKind, RunRecord};

impl Store {
    /// The current actuation run of that name, looked up by itself; other names of its files are left out.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn run_named(&self, path: &str) -> Result<Option<RunRecord>, StoreError> {
        let _moment = self.snapshot()?;
        let id: Option<i64> = self
            .connection
            .prepare_cached("SELECT id FROM run WHERE path = ?1 AND superseded_at IS NULL")
            .and_then(|mut statement| statement.query_row([path], |row| row.get(0)).optional())
            .map_err(|e| self.failed("looking for a run", e))?;
        let Some(id) = id else { return Ok(None) };
        let own = format!("SELECT {id}");
        let mut found = self.records(&own, RunKind::Actuation, |record| {
            self.complete(record, &BTreeMap::new())?;
            fill_in_fit(record, self.result(ResultKind::Fit, path)?);
            Ok(())
        })?;
        Ok(found.pop())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::new_run;

    #[test]
    fn a_run_by_itself_is_the_run_of_the_list() {
        let mut store = Store::in_memory().unwrap();
        let runs = ["runs/a.csv", "runs/b.csv"].map(|path| new_run(path, RunKind::Actuation, &[1e-3, 5e-4]));
        store.save_runs("2026-01-01T00:00:00Z", &[], &runs).unwrap();
        let listed = store.runs().unwrap();
        assert_eq!(store.run_named("runs/a.csv").unwrap().as_ref(), listed.first());
        assert_eq!(store.run_named("a.csv").unwrap(), None);
    }
}
