//! What decides whether runs take part in results: words of people, readings that stand in two runs, what diagnoses found.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::params;

use super::journal::Entry;
use super::{StepError, Store, StoreError, Subject};
use ieap_domain::{RunWord, SameReadings};

/// Every word on a run, the oldest first.
pub(super) const RUN_WORDS: &str =
    "SELECT run_path, drops, why, said_by, said_at, data_hash FROM run_word ORDER BY id";

/// A word from a row of [`RUN_WORDS`].
pub(super) fn read_word(row: &rusqlite::Row<'_>) -> Result<RunWord, StepError> {
    Ok(RunWord {
        run_path: row.get("run_path")?,
        drops: row.get("drops")?,
        why: row.get("why")?,
        said_by: row.get("said_by")?,
        said_at: row.get("said_at")?,
        data_hash: row.get("data_hash")?,
    })
}

impl Store {
    /// Records what a person said of runs.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn add_run_words(&mut self, now: &str, words: &[RunWord]) -> Result<(), StoreError> {
        self.write("storing what was said of runs", now, |transaction| {
            transaction.changes(Subject::RunWords)?;
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
                transaction.says(&word.said_at, Entry::Word(word.clone()));
            }
            Ok(())
        })
    }

    /// The newest word on each run, by the run's name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn run_words(&self) -> Result<BTreeMap<String, RunWord>, StoreError> {
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::RunWords)?;
        let words = self.rows("reading what was said of runs", RUN_WORDS, [], read_word)?;
        // Later words come later and stay.
        Ok(words
            .into_iter()
            .map(|word| (word.run_path.clone(), word))
            .collect())
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
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Runs)?;
        self.check_seal(&Subject::Marks)?;
        let found = self.rows("reading marks of readings", &sql, [], |row| {
            let bytes: Option<Vec<u8>> = row.get("marks")?;
            let number = |bytes: &[u8]| bytes.try_into().map_or(0, u64::from_le_bytes);
            Ok((
                row.get("id")?,
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
            transaction.changes(Subject::Marks)?;
            transaction.changes(Subject::SameReadings)?;
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
        let doing = "reading which runs hold the same readings";
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::SameReadings)?;
        let sql = "SELECT run_id, in_run_id, whole FROM same_readings ORDER BY run_id, in_run_id";
        let mut found = self.rows(doing, sql, [], |row| {
            Ok(SameReadings {
                run_id: row.get("run_id")?,
                in_run_id: row.get("in_run_id")?,
                whole: row.get("whole")?,
            })
        })?;
        if found.is_empty() {
            return Ok(found);
        }
        let runs = self.current_places(doing)?;
        let places = |pair: &SameReadings| Some((*runs.get(&pair.run_id)?, *runs.get(&pair.in_run_id)?));
        found.retain(|pair| places(pair).is_some());
        found.sort_by_key(places);
        Ok(found)
    }

    /// Other names under which the readings of current runs lie, by the run's row id, each list by name: files with the same
    /// bytes, and runs with the same readings. A file that is a part of its run only is not among them.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn other_names(&self) -> Result<BTreeMap<i64, Vec<String>>, StoreError> {
        let doing = "reading other names of runs";
        let _moment = self.snapshot()?;
        let aliases = self.aliases()?;
        let sql = "SELECT run.id, run_file.hash FROM run JOIN run_file ON run_file.run_id = run.id
                   WHERE run.superseded_at IS NULL
                     AND (SELECT count(*) FROM run_file AS part WHERE part.run_id = run.id) = 1";
        let mut names: BTreeMap<i64, BTreeSet<String>> = BTreeMap::new();
        if !aliases.is_empty() {
            let alone: Vec<(i64, String)> =
                self.rows(doing, sql, [], |row| Ok((row.get("id")?, row.get("hash")?)))?;
            for (run_id, hash) in alone {
                let Some(paths) = aliases.get(&hash) else { continue };
                self.check_seal(&Subject::Run(run_id))?;
                names.entry(run_id).or_default().extend(paths.iter().cloned());
            }
        }
        for pair in self.same_readings()?.into_iter().filter(|pair| pair.whole) {
            self.check_seal(&Subject::Run(pair.in_run_id))?;
            let sql = "SELECT path FROM run WHERE id = ?1";
            let other: Vec<String> = self.rows(doing, sql, [pair.in_run_id], |row| Ok(row.get(0)?))?;
            names.entry(pair.run_id).or_default().extend(other);
        }
        let listed = |(run_id, paths): (i64, BTreeSet<String>)| (run_id, paths.into_iter().collect());
        Ok(names.into_iter().map(listed).collect())
    }

    /// The place of each current run, by row id, in the order of their names.
    fn current_places(&self, doing: &'static str) -> Result<BTreeMap<i64, usize>, StoreError> {
        self.check_seal(&Subject::Runs)?;
        let sql = "SELECT id FROM run WHERE superseded_at IS NULL ORDER BY path";
        let ids: Vec<i64> = self.rows(doing, sql, [], |row| Ok(row.get(0)?))?;
        Ok(ids.into_iter().zip(0..).collect())
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
        assert!(store.same_readings().unwrap().is_empty());
    }

    #[test]
    fn a_word_that_changed_behind_the_back_of_the_store_is_noticed() {
        for tampering in [
            "UPDATE run_word SET drops = 0",
            "DELETE FROM run_word",
            "DELETE FROM seal WHERE subject = 'run words'",
        ] {
            let mut store = Store::in_memory().unwrap();
            let word = RunWord {
                run_path: "a".into(),
                drops: true,
                why: Some("wet".into()),
                said_by: "tester".into(),
                said_at: "2026-01-01T00:00:00Z".into(),
                data_hash: "0".into(),
            };
            store.add_run_words("now", std::slice::from_ref(&word)).unwrap();
            assert_eq!(store.check_all().unwrap(), Vec::<String>::new());
            store.connection.execute_batch(tampering).unwrap();
            let damaged = |error| matches!(error, StoreError::Damaged { .. });
            assert!(store.run_words().is_err_and(damaged), "{tampering}");
            assert!(
                store.add_run_words("now", &[word]).is_err_and(damaged),
                "{tampering}"
            );
        }
    }
}
