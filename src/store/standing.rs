//! What decides whether runs take part in results: words of people, readings that stand in two runs, what diagnoses found.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::{Row, params};

use super::{Store, StoreError};
use crate::domain::{RunWord, SameReadings};

impl Store {
    /// Records what a person said of runs.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn add_run_words(&mut self, now: &str, words: &[RunWord]) -> Result<(), StoreError> {
        self.write("storing what was said of runs", now, |transaction| {
            let sql = "INSERT INTO run_word (run_path, drops, why, said_by, said_at, data_hash)
                       VALUES (?1, ?2, ?3, ?4, ?5, ?6)";
            for word in words {
                transaction.prepare_cached(sql)?.execute(params![
                    word.run_path,
                    word.drops,
                    word.why,
                    word.said_by,
                    word.said_at,
                    word.data_hash
                ])?;
            }
            Ok(())
        })
    }

    /// The newest word on each run, by the run's name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn run_words(&self) -> Result<BTreeMap<String, RunWord>, StoreError> {
        let sql = "SELECT run_path, drops, why, said_by, said_at, data_hash FROM run_word
                   WHERE id IN (SELECT max(id) FROM run_word GROUP BY run_path)";
        let words = self.all_rows("reading what was said of runs", sql, |row| {
            Ok(RunWord {
                run_path: row.get(0)?,
                drops: row.get(1)?,
                why: row.get(2)?,
                said_by: row.get(3)?,
                said_at: row.get(4)?,
                data_hash: row.get(5)?,
            })
        })?;
        Ok(words
            .into_iter()
            .map(|word| (word.run_path.clone(), word))
            .collect())
    }

    /// Current runs whose readings the current diagnosis of their group found to be wrong: row id and reason. A diagnosis
    /// of which another run was read anew still holds for this one.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn condemned_by_diagnosis(&self) -> Result<BTreeMap<i64, String>, StoreError> {
        let sql = "SELECT run.id, diagnosis_condemned.reason FROM diagnosis_condemned
                   JOIN diagnosis ON diagnosis.id = diagnosis_condemned.diagnosis_id
                   JOIN run ON run.id = diagnosis_condemned.run_id
                   WHERE diagnosis.superseded_at IS NULL AND run.superseded_at IS NULL";
        let found = self.all_rows("reading what diagnoses condemned", sql, |row| {
            Ok((row.get(0)?, row.get(1)?))
        })?;
        Ok(found.into_iter().collect())
    }

    /// Current actuation runs by row id, each with its marks; empty where it has none of that version.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn marks(&self, version: u32) -> Result<BTreeMap<i64, Option<Vec<u64>>>, StoreError> {
        let sql = format!(
            "SELECT run.id, run_marks.marks FROM run
             LEFT JOIN run_marks ON run_marks.run_id = run.id AND run_marks.version = {version}
             WHERE run.superseded_at IS NULL AND run.kind = 'actuation'"
        );
        let found = self.all_rows("reading marks of readings", &sql, |row| {
            let bytes: Option<Vec<u8>> = row.get(1)?;
            let number = |bytes: &[u8]| bytes.try_into().map_or(0, u64::from_le_bytes);
            Ok((
                row.get(0)?,
                bytes.map(|bytes| bytes.chunks_exact(8).map(number).collect()),
            ))
        })?;
        Ok(found.into_iter().collect())
    }

    /// Stores the marks of runs that had none, and in which runs their readings stand too.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_marks(
        &mut self,
        now: &str,
        version: u32,
        marks: &[(i64, Vec<u64>)],
        same: &[SameReadings],
    ) -> Result<(), StoreError> {
        self.write("storing marks of readings", now, |transaction| {
            for (run_id, marks) in marks {
                let bytes: Vec<u8> = marks.iter().flat_map(|mark| mark.to_le_bytes()).collect();
                transaction
                    .prepare_cached("INSERT OR REPLACE INTO run_marks VALUES (?1, ?2, ?3)")?
                    .execute(params![run_id, version, bytes])?;
            }
            for pair in same {
                transaction
                    .prepare_cached("INSERT OR REPLACE INTO same_readings VALUES (?1, ?2, ?3)")?
                    .execute(params![pair.run_id, pair.in_run_id, pair.whole])?;
            }
            Ok(())
        })
    }

    /// Current runs whose readings stand in another current run.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn same_readings(&self) -> Result<Vec<SameReadings>, StoreError> {
        let sql = "SELECT run_id, in_run_id, whole FROM same_readings
                   JOIN run AS one ON one.id = run_id JOIN run AS other ON other.id = in_run_id
                   WHERE one.superseded_at IS NULL AND other.superseded_at IS NULL
                   ORDER BY one.path, other.path";
        self.all_rows("reading which runs hold the same readings", sql, |row| {
            Ok(SameReadings {
                run_id: row.get(0)?,
                in_run_id: row.get(1)?,
                whole: row.get(2)?,
            })
        })
    }

    /// Other names under which the readings of current runs lie, by the run's row id, each list by name: files with the same
    /// bytes, and runs with the same readings. A file that is a part of its run only is not among them.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn other_names(&self) -> Result<BTreeMap<i64, Vec<String>>, StoreError> {
        let sql = "SELECT run.id, source_file.path FROM run JOIN run_file ON run_file.run_id = run.id
                   JOIN source_file ON source_file.hash = run_file.hash AND source_file.state = 'alias'
                   WHERE run.superseded_at IS NULL AND source_file.missing_since IS NULL
                     AND (SELECT count(*) FROM run_file AS part WHERE part.run_id = run.id) = 1
                   UNION
                   SELECT same_readings.run_id, other.path FROM same_readings
                   JOIN run AS one ON one.id = same_readings.run_id
                   JOIN run AS other ON other.id = same_readings.in_run_id
                   WHERE whole = 1 AND one.superseded_at IS NULL AND other.superseded_at IS NULL
                   ORDER BY 1, 2";
        let mut names: BTreeMap<i64, Vec<String>> = BTreeMap::new();
        let found = self.all_rows("reading other names of runs", sql, |row| {
            Ok((row.get(0)?, row.get::<_, String>(1)?))
        })?;
        for (run_id, path) in found {
            names.entry(run_id).or_default().push(path);
        }
        Ok(names)
    }

    /// Names of current runs and modulus logs of which every file is gone.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn deleted_runs(&self) -> Result<BTreeSet<String>, StoreError> {
        let sql = "SELECT path FROM run WHERE superseded_at IS NULL AND NOT EXISTS (
                       SELECT 1 FROM run_file JOIN source_file ON source_file.path = run_file.path
                       WHERE run_file.run_id = run.id AND source_file.missing_since IS NULL)";
        let found = self.all_rows("looking for runs whose files are gone", sql, |row| row.get(0))?;
        Ok(found.into_iter().collect())
    }

    fn all_rows<T>(
        &self,
        doing: &'static str,
        sql: &str,
        read: impl FnMut(&Row<'_>) -> rusqlite::Result<T>,
    ) -> Result<Vec<T>, StoreError> {
        let mut statement = self
            .connection
            .prepare_cached(sql)
            .map_err(|e| self.failed(doing, e))?;
        let rows = statement.query_map([], read).map_err(|e| self.failed(doing, e))?;
        rows.collect::<rusqlite::Result<_>>()
            .map_err(|e| self.failed(doing, e))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_word_on_a_run_holds() {
        let mut store = Store::in_memory().unwrap();
        let word = |run: &str, drops: bool, why: Option<&str>| RunWord {
            run_path: run.into(),
            drops,
            why: why.map(str::to_owned),
            said_by: "tester".into(),
            said_at: "2026-01-01T00:00:00Z".into(),
            data_hash: "0".into(),
        };
        let first = [
            word("a", true, Some("clip slipped")),
            word("b", true, Some("wet")),
        ];
        store.add_run_words("now", &first).unwrap();
        store.add_run_words("now", &[word("a", false, None)]).unwrap();
        let words = store.run_words().unwrap();
        assert_eq!(words["a"], word("a", false, None));
        assert_eq!(words["b"], first[1]);
        assert!(store.same_readings().unwrap().is_empty() && store.deleted_runs().unwrap().is_empty());
    }
}
