//! Rows and lists of rows as they are read: each row is held against its hash, each list against its sum.

use std::collections::BTreeMap;

use rusqlite::Row;

use super::rows::{ALL, JOURNAL_END, RowHash, Table, added, check, damaged_list, stated, sum_of};
use super::{StepError, Store, StoreError};

impl Store {
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
