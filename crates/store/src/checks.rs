//! A look at everything that a database holds.

use super::new_run::RunRow;
use super::rows::{RUN, hash_all};
use super::{Store, StoreError};

impl Store {
    /// Looks at everything: the structure of the database, references between rows, the hash of every row, and every run's
    /// readings against theirs. Gives what is wrong, in words.
    ///
    /// # Errors
    /// See [`StoreError`]; where the database cannot be read at all.
    pub fn check_all(&self) -> Result<Vec<String>, StoreError> {
        let _moment = self.snapshot()?;
        let mut wrong = self.structure_faults("PRAGMA integrity_check")?;
        wrong.extend(self.structure_faults("SELECT 'a row of ' || \"table\" || ' names a row of ' || parent || ' that is not there' FROM pragma_foreign_key_check")?);
        let mut found = self.check_rows()?;
        let ids = self.rows("listing runs", "SELECT id FROM run ORDER BY id", [], |row| {
            Ok(row.get::<_, i64>(0)?)
        })?;
        for id in ids {
            found.extend(self.check_run(id).err());
        }
        for series in self.log_series().unwrap_or_default() {
            found.extend(self.log_readings(&series).err());
        }
        found.extend(self.check_all_drawn()?);
        found.extend(self.course().err());
        wrong.extend(found.into_iter().map(in_words));
        wrong.dedup();
        Ok(wrong)
    }

    /// Holds a run against its hash, its readings and its climate against theirs.
    fn check_run(&self, run_id: i64) -> Result<(), StoreError> {
        let run = self.kept(
            "reading a run",
            RUN,
            ("", "WHERE id = ?1"),
            [run_id],
            RunRow::read,
        )?;
        run.iter().try_for_each(|run| self.check_readings(run))?;
        self.run_climate_curves(run_id)?;
        self.origin(run_id).map(drop)
    }

    /// Looks at the structure of the database, which takes as long as reading all of it once.
    ///
    /// # Errors
    /// [`StoreError::NotADatabase`] with what is wrong.
    pub fn check_structure(&self) -> Result<(), StoreError> {
        match self.structure_faults("PRAGMA quick_check(1)")?.into_iter().next() {
            None => Ok(()),
            Some(detail) => Err(StoreError::NotADatabase {
                path: self.path.clone(),
                detail,
            }),
        }
    }

    fn structure_faults(&self, sql: &str) -> Result<Vec<String>, StoreError> {
        let mut faults = self.rows("checking the database", sql, [], |row| {
            Ok(row.get::<_, String>(0)?)
        })?;
        faults.retain(|fault| fault != "ok");
        Ok(faults)
    }

    /// Hashes everything as it is: for tests of what a right hash hides.
    #[doc(hidden)]
    pub fn hash_anew(&self) -> Result<(), StoreError> {
        hash_all(&self.connection).map_err(self.named("hashing"))
    }
}

/// What is wrong, without the way to mend it.
fn in_words(error: StoreError) -> String {
    match error {
        StoreError::Damaged { what } => {
            format!("{what} is not as it was stored (its checksum does not match)")
        }
        other => other.to_string(),
    }
}
