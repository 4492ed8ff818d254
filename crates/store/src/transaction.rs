//! Changes of the database: each is whole or not there, and a batch of them waits for the disk once.

use std::ops::Deref;

use rusqlite::{Connection, ToSql, TransactionBehavior};

use super::journal::{Entry, Intended, Journal};
use super::rows::{self, CHANGE_COUNT, Table};
use super::{Snapshot, StepError, Store, StoreError};

/// The transaction that a change is made in.
pub(super) struct Transaction<'c> {
    connection: &'c Connection,
    pub(super) journal: &'c Journal,
}

impl Deref for Transaction<'_> {
    type Target = Connection;

    fn deref(&self) -> &Connection {
        self.connection
    }
}

impl Transaction<'_> {
    /// Changes rows of a table: they are held against their hashes before, and hashed anew after. `condition` has one
    /// parameter, and finds the rows before or after or both.
    pub fn change<T>(
        &self,
        table: Table,
        condition: (&str, &dyn ToSql),
        work: impl FnOnce() -> Result<T, StepError>,
    ) -> Result<T, StepError> {
        rows::change(self.connection, table, condition, work)
    }

    /// To be said of what no file holds, with the time at which it was said (RFC 3339 UTC): it is on the disk before this
    /// is committed.
    pub fn says(&self, at: &str, entry: Entry) -> Result<(), StepError> {
        self.journal.says(self.connection, at, entry)
    }
}

impl Store {
    /// From here until the guard is dropped this connection reads one state of the database, whatever others write
    /// meanwhile. Nothing can be written through it for as long.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn snapshot(&self) -> Result<Snapshot<'_>, StoreError> {
        Snapshot::of(&self.connection).map_err(|e| self.failed("beginning to read", e))
    }

    /// Runs `work` in one transaction that takes the write lock at once, and counts the change made at `now`
    /// (RFC 3339 UTC). On an error everything of it is rolled back. Within a batch it is a step of the batch.
    pub(super) fn write<T>(
        &mut self,
        doing: &'static str,
        now: &str,
        work: impl FnOnce(&Transaction<'_>) -> Result<T, StepError>,
    ) -> Result<T, StoreError> {
        self.check_in_place()?;
        let in_batch = self.in_batch();
        if !in_batch {
            // Left by a batch that the database gave up: another connection may have written since.
            self.forget_changes();
        }
        let said_before = self.journal.len();
        let (journal, place, path) = (&self.journal, &self.place, &self.path);
        let whole = |connection: &Connection| {
            let outcome = work(&Transaction { connection, journal })?;
            count_change(connection, now)?;
            let mut intended = None;
            if !in_batch {
                intended = journal.write(connection, || place.check(path))?;
            }
            Ok((outcome, intended))
        };
        let outcome = if in_batch {
            step(&mut self.connection, whole).map(|(outcome, _)| outcome)
        } else {
            alone(&mut self.connection, journal, whole)
        };
        if outcome.is_err() {
            self.journal.keep_first(said_before);
            self.journal.changed();
        }
        outcome.map_err(self.named(doing))
    }

    /// Begins a batch: changes from here on are on the disk, and visible to others, when [`Store::commit_batch`]
    /// returns. The database is locked for other writers until then.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn begin_batch(&mut self) -> Result<(), StoreError> {
        self.check_in_place()?;
        if !self.in_batch() {
            self.forget_changes();
        }
        let begun = self.connection.execute_batch("BEGIN IMMEDIATE");
        begun.map_err(|e| self.failed("beginning a batch", e))?;
        self.whole_lists.batch_begins();
        Ok(())
    }

    /// Ends a batch. Where that fails nothing of the batch is stored.
    ///
    /// # Errors
    /// See [`StoreError`]; also where the database gave the batch up because of an earlier error.
    pub fn commit_batch(&mut self) -> Result<(), StoreError> {
        let ended = if self.in_batch() {
            self.journal
                .write(&self.connection, || self.place.check(&self.path))
        } else {
            Ok(None)
        };
        let committed = ended.and_then(|intended| {
            let committed = self.connection.execute_batch("COMMIT").map_err(StepError::from);
            if self.in_batch() {
                // The disk refused: the batch would stay open, and the next one could not begin.
                let _ = self.connection.execute_batch("ROLLBACK");
            }
            or_taken_back(&self.journal, intended, committed)
        });
        self.forget_changes();
        if committed.is_err() {
            self.journal.changed();
        }
        if self.in_batch() {
            let _ = self.connection.execute_batch("ROLLBACK");
        }
        self.whole_lists.batch_ended();
        committed.map_err(self.named("ending a batch"))
    }

    fn forget_changes(&self) {
        self.journal.keep_first(0);
    }

    fn in_batch(&self) -> bool {
        !self.connection.is_autocommit()
    }
}

fn count_change(connection: &Connection, now: &str) -> Result<(), StepError> {
    rows::change(connection, CHANGE_COUNT, ("only_row = ?1", &1), || {
        let sql = "UPDATE change_count SET changes = changes + 1, changed_at = ?1";
        connection.prepare_cached(sql)?.execute([now])?;
        Ok(())
    })
}

fn alone<T>(
    connection: &mut Connection,
    journal: &Journal,
    work: impl FnOnce(&Connection) -> Result<(T, Option<Intended>), StepError>,
) -> Result<T, StepError> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let (outcome, intended) = work(&transaction)?;
    let committed = transaction.commit().map_err(StepError::from);
    or_taken_back(journal, intended, committed).map(|()| outcome)
}

/// The end of a transaction; where it was refused, what it intended is taken back from the journal.
fn or_taken_back(
    journal: &Journal,
    intended: Option<Intended>,
    committed: Result<(), StepError>,
) -> Result<(), StepError> {
    if let (Err(_), Some(intended)) = (&committed, intended) {
        journal.take_back(intended)?;
    }
    committed
}

/// A step of a batch; one that fails takes nothing back but itself.
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
    use ieap_domain::FileState;

    fn row(path: &str) -> FileRow {
        FileRow {
            path: path.to_owned(),
            size_bytes: 1,
            modified_ns: 1,
            inode: 0,
            changed_ns: 0,
            hash: None,
            state: FileState::Pending,
            reader: String::new(),
            issue: None,
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
    fn a_snapshot_does_not_see_what_others_write() {
        let folder = tempfile::tempdir().unwrap();
        let mut store = Store::open(folder.path()).unwrap();
        let other = Store::open(folder.path()).unwrap();
        let snapshot = other.snapshot().unwrap();
        assert_eq!(paths(&other).len(), 0);
        store.record_files("now", &[row("a")]).unwrap();
        assert_eq!(paths(&other).len(), 0);
        drop(snapshot);
        assert_eq!(paths(&other), ["a"]);
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
