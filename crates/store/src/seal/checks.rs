//! Holds what is stored against its seals.

use rusqlite::Row;

use super::Subject;
use super::seals::{add_row, damaged, finished, seal_all, stored};
use crate::{StepError, Store, StoreError};

impl Store {
    /// Holds rows against their seal before they are read.
    pub(crate) fn check_seal(&self, subject: &Subject) -> Result<(), StoreError> {
        let checked = self.seals.check(&self.connection, subject);
        checked.map_err(self.named("checking what is stored"))
    }

    /// Seals everything as it is: for tests of what a right seal hides.
    #[doc(hidden)]
    pub fn seal_anew(&self) -> Result<(), StoreError> {
        seal_all(&self.connection).map_err(|e| self.failed("sealing", e))
    }

    /// What a seal says, hexadecimal; `-` where nothing is stored of the subject, and none where this one is open.
    pub(crate) fn seal_in_words(&self, subject: &Subject) -> Result<Option<String>, StoreError> {
        if self.seals.open.borrow().contains(subject) {
            return Ok(None);
        }
        let seal = stored(&self.connection, subject).map_err(|e| self.failed("reading a seal", e))?;
        let in_words = |seal: Vec<u8>| seal.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Some(seal.map_or_else(|| "-".to_owned(), in_words)))
    }

    /// Whether a row is as it was sealed; its last column is the seal.
    pub(crate) fn check_sealed_row(&self, subject: &Subject, row: &Row<'_>) -> Result<(), StepError> {
        let last = row.as_ref().column_count() - 1;
        if self.seals.open.borrow().contains(subject) {
            return Ok(());
        }
        let mut hasher = blake3::Hasher::new();
        add_row(&mut hasher, row, last)?;
        if row.get::<_, Option<Vec<u8>>>(last)? == Some(finished(&hasher).to_vec()) {
            Ok(())
        } else {
            Err(damaged(subject).into())
        }
    }

    /// Looks at everything: the structure of the database, references between rows, every seal, and every run's readings
    /// against their hash. Gives what is wrong, in words.
    ///
    /// # Errors
    /// See [`StoreError`]; where the database cannot be read at all.
    pub fn check_all(&self) -> Result<Vec<String>, StoreError> {
        let mut wrong = self.structure_faults("PRAGMA integrity_check")?;
        wrong.extend(self.structure_faults("SELECT 'a row of ' || \"table\" || ' names a row of ' || parent || ' that is not there' FROM pragma_foreign_key_check")?);
        let subjects =
            Subject::all(&self.connection).map_err(|e| self.failed("listing what is stored", e))?;
        for subject in subjects {
            wrong.extend(self.check_seal(&subject).err().map(in_words));
            if let Subject::Readings(run_id) = subject {
                wrong.extend(self.channels_as_read(run_id).err().map(in_words));
            }
        }
        wrong.extend(self.check_results()?.into_iter().map(in_words));
        wrong.extend(self.course().err().map(in_words));
        wrong.dedup();
        Ok(wrong)
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
