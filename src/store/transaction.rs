//! Changes of the database: each is whole or not there, and a batch of them waits for the disk once.

use std::ops::Deref;

use rusqlite::{Connection, TransactionBehavior};

use super::{StepError, Store, StoreError};

/// The transaction that a change is made in.
pub(super) struct Transaction<'c>(&'c Connection);

impl Deref for Transaction<'_> {
    type Target = Connection;

    fn deref(&self) -> &Connection {
        self.0
    }
}

impl Store {
    /// Runs `work` in one transaction that takes the write lock at once, and counts the change made at `now`
    /// (RFC 3339 UTC). On an error everything of it is rolled back. Within a batch it is a step of the batch.
    pub(super) fn write<T>(
        &mut self,
        doing: &'static str,
        now: &str,
        work: impl FnOnce(&Transaction<'_>) -> Result<T, StepError>,
    ) -> Result<T, StoreError> {
        let whole = |connection: &Connection| {
            let outcome = work(&Transaction(connection))?;
            let sql = "UPDATE change_count SET changes = changes + 1, changed_at = ?1";
            connection.prepare_cached(sql)?.execute([now])?;
            Ok(outcome)
        };
        let outcome = match self.in_batch() {
            true => step(&mut self.connection, whole),
            false => alone(&mut self.connection, whole),
        };
        outcome.map_err(self.named(doing))
    }

    /// Begins a batch: changes from here on are on the disk, and visible to others, when [`Store::commit_batch`]
    /// returns. The database is locked for other writers until then.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn begin_batch(&mut self) -> Result<(), StoreError> {
        let begun = self.connection.execute_batch("BEGIN IMMEDIATE");
        begun.map_err(|e| self.failed("beginning a batch", e))
    }

    /// Ends a batch. Where that fails nothing of the batch is stored.
    ///
    /// # Errors
    /// See [`StoreError`]; also where the database gave the batch up because of an earlier error.
    pub fn commit_batch(&mut self) -> Result<(), StoreError> {
        let committed = self.connection.execute_batch("COMMIT");
        if self.in_batch() {
            // The disk refused: the batch would stay open, and the next one could not begin.
            let _ = self.connection.execute_batch("ROLLBACK");
        }
        committed.map_err(|e| self.failed("ending a batch", e))
    }

    fn in_batch(&self) -> bool {
        !self.connection.is_autocommit()
    }
}

fn alone<T>(
    connection: &mut Connection,
    work: impl FnOnce(&Connection) -> Result<T, StepError>,
) -> Result<T, StepError> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let outcome = work(&transaction)?;
    transaction.commit()?;
    Ok(outcome)
}

/// A step of a batch; one that fails takes nothing back but itself.
        self.check_in_place()?;
        let (in_batch, seals) = (self.in_batch(), &self.seals);
fn step<T>(
    connection: &mut Connection,
    work: impl FnOnce(&Connection) -> Result<T, StepError>,
) -> Result<T, StepError> {
    let savepoint = connection.savepoint()?;
    let outcome = work(&savepoint)?;
    savepoint.commit()?;
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::super::FileRow;
    use super::*;
    use crate::domain::FileState;

    fn row(path: &str) -> FileRow {
        FileRow {
            path: path.to_owned(),
            size_bytes: 1,
            modified_ns: 1,
            inode: 0,
            hash: None,
            state: FileState::Pending,
            reader: String::new(),
            issue: None,
        self.check_in_place()?;
            missing_since: None,
        }
    }

    fn paths(store: &Store) -> Vec<String> {
        store.files().unwrap().into_iter().map(|file| file.path).collect()
    }

    #[test]
    fn a_batch_is_seen_by_others_when_it_ends_and_by_itself_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let mut store = Store::open(folder.path()).unwrap();
        store.begin_batch().unwrap();
        store.record_files("2026-01-01T00:00:00Z", &[row("a")]).unwrap();
        store.record_files("2026-01-01T00:00:01Z", &[row("b")]).unwrap();
        let other = Store::open_read_only(folder.path()).unwrap().unwrap();
        assert_eq!((paths(&store).len(), paths(&other).len()), (2, 0));
        store.commit_batch().unwrap();
        assert_eq!(paths(&other), ["a", "b"]);
        assert_eq!(other.changes().unwrap().0, 2);
        store.record_files("2026-01-01T00:00:02Z", &[row("c")]).unwrap();
        assert_eq!(paths(&other).len(), 3);
    }

    #[test]
    fn a_step_that_fails_leaves_the_rest_of_its_batch() {
        let mut store = Store::in_memory().unwrap();
        store.begin_batch().unwrap();
        store.record_files("now", &[row("a")]).unwrap();
        let failed: Result<(), StoreError> = store.write("trying", "now", |transaction| {
            transaction.execute("DELETE FROM source_file", [])?;
            transaction.execute("INSERT INTO no_such_table VALUES (1)", [])?;
            Ok(())
        });
        assert!(failed.is_err());
        store.record_files("now", &[row("b")]).unwrap();
        store.commit_batch().unwrap();
        assert_eq!(paths(&store), ["a", "b"]);
    }

    #[test]
    fn a_batch_that_the_database_gave_up_is_told_and_the_next_one_begins() {
        let mut store = Store::in_memory().unwrap();
        store.begin_batch().unwrap();
        store.record_files("now", &[row("a")]).unwrap();
        // What SQLite does by itself where the disk is full.
        store.connection.execute_batch("ROLLBACK").unwrap();
        assert!(store.commit_batch().is_err());
        assert_eq!(paths(&store), Vec::<String>::new());
        store.begin_batch().unwrap();
        store.commit_batch().unwrap();
    }
}
