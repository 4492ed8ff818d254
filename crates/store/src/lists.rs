//! Rows and lists of rows as they are read: each row is held against its hash, each list against its sum.

use std::collections::BTreeMap;
use std::sync::Arc;

use rusqlite::Row;

use super::rows::{ALL, JOURNAL_END, RowHash, Table, added, check, damaged_list, stated, sum_of};
use super::{StepError, Store, StoreError};

impl Store {
    /// What `read` makes of lists of the database, or made of them before where nothing was changed since.
    pub(super) fn whole<T: Send + Sync + 'static>(
        &self,
        name: &'static str,
        read: impl FnOnce(&Store) -> Result<T, StoreError>,
    ) -> Result<Arc<T>, StoreError> {
        let _moment = self.snapshot()?;
        let now = (self.changes_by_others()?, self.connection.total_changes());
        if !self.whole_lists.are_kept(now) {
            return Ok(Arc::new(read(self)?));
        }
        if let Some(known) = self.whole_lists.known(name) {
            return Ok(known);
        }
        let found = Arc::new(read(self)?);
        self.whole_lists.keep(name, found.clone());
        Ok(found)
    }

    /// A number that is another one where another connection changed the database.
    pub(super) fn changes_by_others(&self) -> Result<i64, StoreError> {
        self.connection
            .prepare_cached("PRAGMA data_version")
            .and_then(|mut statement| statement.query_row([], |row| row.get(0)))
            .map_err(|e| self.failed("asking for changes", e))
    }

    /// Rows of a table, each held against its hash.
    pub(super) fn kept<T>(
        &self,
        doing: &'static str,
        table: Table,
        (more, rest): (&str, &str),
        parameters: impl rusqlite::Params,
        read: impl Fn(&Row<'_>) -> Result<T, StepError>,
    ) -> Result<Vec<T>, StoreError> {
        let sql = table.select(more, rest);
        self.rows(doing, &sql, parameters, |row| {
            check(table, row)?;
            read(row)
        })
    }

    /// Every row of a list, read from the table itself and not by an index; that none is missing is held against the sum.
    pub(super) fn listed<T>(
        &self,
        doing: &'static str,
        table: Table,
        list: &str,
        read: impl Fn(&Row<'_>) -> Result<T, StepError>,
    ) -> Result<Vec<T>, StoreError> {
        let rest = format!("NOT INDEXED WHERE {} = ?1", table.list);
        self.listed_by(doing, table, list, (&rest, list), read)
    }

    /// The same, found by a condition of one parameter.
    pub(super) fn listed_by<T>(
        &self,
        doing: &'static str,
        table: Table,
        list: &str,
        (rest, key): (&str, &str),
        read: impl Fn(&Row<'_>) -> Result<T, StepError>,
    ) -> Result<Vec<T>, StoreError> {
        let _moment = self.snapshot()?;
        let found = self.kept(doing, table, ("", rest), [key], |row| {
            Ok((read(row)?, stated(row)?))
        })?;
        self.check_sum(list, found.iter().map(|(_, hash)| *hash))?;
        Ok(found.into_iter().map(|(read, _)| read).collect())
    }

    /// Holds a list against its sum, whose rows are held against their hashes where they are read.
    pub(super) fn check_list(&self, table: Table, list: &str) -> Result<(), StoreError> {
        let _moment = self.snapshot()?;
        let sql = format!(
            "SELECT row_hash FROM {} NOT INDEXED WHERE {} = ?1",
            table.name, table.list
        );
        let hashes = self.rows("checking a list", &sql, [list], stated)?;
        self.check_sum(list, hashes.into_iter())
    }

    /// What tells whether anything changed in some lists: their sums, against which they are held where they are read.
    pub(super) fn state_of_lists(&self, lists: &[&str]) -> Result<String, StoreError> {
        let _moment = self.snapshot()?;
        let sums = lists.iter().map(|list| sum_of(&self.connection, list));
        let sums = sums.collect::<rusqlite::Result<Vec<_>>>();
        let sums = sums.map_err(|e| self.failed("reading what lists are", e))?;
        Ok(format!("{sums:?}"))
    }

    fn check_sum(&self, list: &str, hashes: impl Iterator<Item = RowHash>) -> Result<(), StoreError> {
        let stated = sum_of(&self.connection, list).map_err(|e| self.failed("checking a list", e))?;
        if hashes.fold(RowHash::default(), added) == stated {
            Ok(())
        } else {
            Err(damaged_list(list))
        }
    }

    /// What is wrong with rows and lists, in words.
    pub(super) fn check_rows(&self) -> Result<Vec<StoreError>, StoreError> {
        let doing = "checking what is stored";
        let (mut wrong, mut sums) = (Vec::new(), BTreeMap::<String, RowHash>::new());
        for table in ALL {
            let found = self.rows(doing, &table.select("", "NOT INDEXED"), [], |row| {
                let list: Option<String> = row.get("list_of_row").unwrap_or_default();
                let checked = check(table, row).map_err(self.named(doing));
                Ok((list, stated(row)?, checked.err()))
            })?;
            for (list, hash, error) in found {
                if let Some(sum) = list.map(|list| sums.entry(list).or_default()) {
                    *sum = added(*sum, hash);
                }
                wrong.extend(error);
            }
        }
        let read = |row: &Row<'_>| Ok((row.get::<_, String>("list")?, row.get::<_, Vec<u8>>("sum")?));
        let stated = self.rows(doing, "SELECT list, sum FROM list_sum ORDER BY list", [], read)?;
        for (list, sum) in stated.into_iter().filter(|(list, _)| list != JOURNAL_END) {
            if sums.remove(&list).unwrap_or_default()[..] != sum[..] {
                wrong.push(damaged_list(&list));
            }
        }
        wrong.extend(sums.into_keys().map(|list| damaged_list(&list)));
        Ok(wrong)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::new_run;
    use super::*;
    use ieap_domain::RunKind;

    const NOW: &str = "2026-01-01T00:00:00Z";

    fn save(store: &mut Store, path: &str) {
        let run = new_run(path, RunKind::Actuation, &[1e-3, 5e-4]);
        store.save_runs(NOW, &[], &[run]).unwrap();
    }

    fn names(store: &Store) -> Vec<String> {
        store.runs().unwrap().into_iter().map(|run| run.path).collect()
    }

    #[test]
    fn a_list_is_read_once_for_as_long_as_nobody_changes_anything() {
        let folder = tempfile::tempdir().unwrap();
        let mut store = Store::open(folder.path()).unwrap();
        let other = Store::open_read_only(folder.path()).unwrap().unwrap();
        save(&mut store, "a");
        let rows = |store: &Store| store.current_rows(RunKind::Actuation).unwrap();
        for reader in [&store, &other] {
            assert!(Arc::ptr_eq(&rows(reader), &rows(reader)));
        }
        let (own, others) = (rows(&store), rows(&other));
        save(&mut store, "b");
        for (reader, before) in [(&store, own), (&other, others)] {
            assert!(!Arc::ptr_eq(&rows(reader), &before));
            assert_eq!(names(reader), ["a", "b"]);
        }
    }

    #[test]
    fn what_is_read_in_a_batch_that_is_taken_back_is_not_kept() {
        let mut store = Store::in_memory().unwrap();
        save(&mut store, "a");
        store.begin_batch().unwrap();
        save(&mut store, "b");
        assert_eq!(names(&store), ["a", "b"]);
        // What SQLite does by itself where the disk is full.
        store.connection.execute_batch("ROLLBACK").unwrap();
        assert_eq!(names(&store), ["a"]);
        assert!(store.commit_batch().is_err());
        assert_eq!(names(&store), ["a"]);
    }

    #[test]
    fn what_failed_is_asked_again() {
        let mut store = Store::in_memory().unwrap();
        save(&mut store, "a");
        store
            .connection
            .execute_batch("UPDATE run SET reading = replace(reading, 's', 't')")
            .unwrap();
        for _ in 0..2 {
            assert!(matches!(store.runs(), Err(StoreError::Damaged { .. })));
        }
    }
}
