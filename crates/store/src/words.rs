//! What people said, as the lines of the journal in the database have it: tags by hand, words on runs, wishes how to fit, and
//! which alarms were told.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rusqlite::Row;

use super::journal::{Entry, Line, ToldAlarm, read_line};
use super::rows::JOURNAL_LINE;
use super::{HandTag, Store, StoreError};
use ieap_domain::{Alarm, AskedFit, RunWord};

/// All that was said and holds, but for what later lines of the same kind took back.
#[derive(Debug, Default)]
pub(super) struct Words {
    /// What was said of each measurement, in the order of saying; by what it is known by.
    of: BTreeMap<String, Vec<Line>>,
    /// Alarms that were told, in the order of telling.
    pub told: Vec<ToldAlarm>,
    /// What may be lost and nobody answered.
    pub missed: Vec<String>,
    /// The same with what was answered.
    pub ever_missed: Vec<String>,
}

/// What holds of one run.
#[derive(Debug, Default)]
pub(super) struct SaidOf {
    /// The newest tag by hand of each key, taken-back ones left out.
    pub tags: BTreeMap<String, HandTag>,
    /// The newest word.
    pub word: Option<RunWord>,
    /// The newest wish how to fit it.
    pub asked: AskedFit,
}

/// Words with the state of the database that they are of: what other connections changed, and what this one did.
pub(super) type Remembered = Option<((i64, u64), Arc<Words>)>;

/// Kinds of lines that are words.
const KINDS: [&str; 6] = ["tag", "word", "asked", "told", "missed", "answered"];

impl Words {
    /// `of` is the measurement that a word is about.
    fn hear(&mut self, of: Option<String>, line: Line) {
        if line.entry.is_of_run() {
            self.of.entry(of.unwrap_or_default()).or_default().push(line);
            return;
        }
        match line.entry {
            Entry::Told(alarm) => self.told.push(alarm),
            Entry::Missed { lost } => {
                self.ever_missed.push(lost.clone());
                self.missed.push(lost);
            }
            Entry::Answered { .. } => self.missed.clear(),
            _ => {}
        }
    }

    /// Whether nothing was said of any run.
    fn are_of_no_run(&self) -> bool {
        self.of.is_empty()
    }

    /// What holds of a run, of which all that stands in `said_of` holds ([`RunRow::said_of`]).
    pub(super) fn said_of(&self, said_of: &[String]) -> SaidOf {
        let mut lines: Vec<&Line> = said_of
            .iter()
            .filter_map(|of| self.of.get(of))
            .flatten()
            .collect();
        lines.sort_by_key(|line| line.n);
        let mut holds = SaidOf::default();
        for line in lines {
            match &line.entry {
                Entry::Tag(tag) if tag.value.is_some() => {
                    drop(holds.tags.insert(tag.key.clone(), tag.clone()));
                }
                Entry::Tag(tag) => drop(holds.tags.remove(&tag.key)),
                Entry::Word(word) => holds.word = Some(word.clone()),
                Entry::Asked { asked, .. } => holds.asked = asked.clone(),
                _ => {}
            }
        }
        holds
    }
}

impl Store {
    /// What holds of all that was said; read anew where anything was said since.
    pub(super) fn words(&self) -> Result<Arc<Words>, StoreError> {
        let doing = "reading what people said";
        let _moment = self.snapshot()?;
        let state = (self.changes_by_others()?, self.journal.changes());
        if let Some((of, words)) = &*self.remembered.borrow()
            && *of == state
        {
            return Ok(words.clone());
        }
        let mut lines = Vec::new();
        for what in KINDS {
            let list = format!("journal_line {what}");
            let read = |row: &Row<'_>| Ok((row.get::<_, Option<String>>("name")?, read_line(row)?));
            lines.extend(self.listed_by(doing, JOURNAL_LINE, &list, ("WHERE what = ?1", what), read)?);
        }
        lines.sort_by_key(|(_, line)| line.n);
        let mut words = Words::default();
        lines.into_iter().for_each(|(of, line)| words.hear(of, line));
        let words = Arc::new(words);
        *self.remembered.borrow_mut() = Some((state, words.clone()));
        Ok(words)
    }

    /// Adds tags set by hand. They outlive revisions of the run and refits.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn add_hand_tags(&mut self, now: &str, tags: &[HandTag]) -> Result<(), StoreError> {
        self.write("setting tags", now, |transaction| {
            let mut each = tags.iter();
            each.try_for_each(|tag| transaction.says(&tag.set_at, Entry::Tag(tag.clone())))
        })
    }

    /// The newest hand tag of each key that was said of any of these ([`TagSources::said_of`](super::TagSources::said_of)),
    /// taken-back ones left out, in order of the keys.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn hand_tags_of(&self, said_of: &[String]) -> Result<Vec<HandTag>, StoreError> {
        Ok(self.words()?.said_of(said_of).tags.into_values().collect())
    }

    /// The same of the current run of a name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn hand_tags(&self, run_path: &str) -> Result<Vec<HandTag>, StoreError> {
        let _moment = self.snapshot()?;
        self.hand_tags_of(&self.said_of(run_path)?)
    }

    /// Records what a person said of runs.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn add_run_words(&mut self, now: &str, words: &[RunWord]) -> Result<(), StoreError> {
        self.write("storing what was said of runs", now, |transaction| {
            let mut each = words.iter();
            each.try_for_each(|word| transaction.says(&word.said_at, Entry::Word(word.clone())))
        })
    }

    /// The newest word on each current run, by the run's name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn run_words(&self) -> Result<BTreeMap<String, RunWord>, StoreError> {
        let _moment = self.snapshot()?;
        let words = self.words()?;
        if words.are_of_no_run() {
            return Ok(BTreeMap::new());
        }
        let said_of = self.said_of_all()?.into_iter();
        let newest = |(path, of): (String, Vec<String>)| {
            let word = words.said_of(&of).word?;
            let run_path = path.clone();
            Some((path, RunWord { run_path, ..word }))
        };
        Ok(said_of.filter_map(newest).collect())
    }

    /// What was said of measurements that no current run is or follows: the newest name of each, and what was said, in words.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn words_of_no_run(&self) -> Result<Vec<(String, Vec<String>)>, StoreError> {
        let _moment = self.snapshot()?;
        let words = self.words()?;
        if words.are_of_no_run() {
            return Ok(Vec::new());
        }
        let held: BTreeSet<String> = self.said_of_all()?.into_values().flatten().collect();
        let mut found = BTreeMap::new();
        for (of, lines) in words.of.iter().filter(|(of, _)| !held.contains(*of)) {
            let said = words.said_of(std::slice::from_ref(of));
            let mut told: Vec<String> = said
                .tags
                .values()
                .map(|tag| Entry::Tag(tag.clone()).in_words())
                .collect();
            let dropped = said.word.filter(|word| word.drops || word.why.is_some());
            told.extend(dropped.map(|word| Entry::Word(word).in_words()));
            if let Some(name) = lines
                .last()
                .and_then(|line| line.entry.name())
                .filter(|_| !told.is_empty())
            {
                found.entry(name.to_owned()).or_insert_with(Vec::new).extend(told);
            }
        }
        Ok(found.into_iter().collect())
    }

    /// Ids of the alarms that were told.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn told_alarms(&self) -> Result<BTreeSet<String>, StoreError> {
        let words = self.words()?;
        Ok(words.told.iter().map(|alarm| alarm.id.clone()).collect())
    }

    /// Id, run and message of the alarms that were told, by when.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn told_of_runs(&self) -> Result<Vec<[String; 3]>, StoreError> {
        let words = self.words()?;
        let told = words.told.iter();
        let row = |alarm: &ToldAlarm| [alarm.id.clone(), alarm.run.clone(), alarm.message.clone()];
        Ok(told.map(row).collect())
    }

    /// Records an alarm as told. Whoever tells it does so after this: a crash in between loses a message and never
    /// sends one twice.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_alarm(&mut self, now: &str, alarm: &Alarm) -> Result<(), StoreError> {
        // A jump is told under the id that the chart gives it, because the chart tells it until it is known to be a jump.
        let chart = if alarm.chart == "jump" {
            "ewma"
        } else {
            &alarm.chart
        };
        let told = ToldAlarm {
            id: alarm.id.clone(),
            sample: alarm.sample.clone(),
            parameter: alarm.parameter.clone(),
            chart: chart.to_owned(),
            run: alarm.run.clone(),
            message: alarm.message.clone(),
        };
        self.say(now, vec![(now.to_owned(), Entry::Told(told))])
    }

    /// Records how the command of an alarm ended.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_alarm_command(&mut self, now: &str, id: &str, status: &str) -> Result<(), StoreError> {
        let (id, status) = (id.to_owned(), status.to_owned());
        self.say(now, vec![(now.to_owned(), Entry::Command { id, status })])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::new_run;
    use crate::{Continues, FileRow, Moves, NewRun};
    use ieap_domain::{FileState, RunKind};

    fn word(run: &str, drops: bool, why: Option<&str>) -> RunWord {
        RunWord {
            run_path: run.into(),
            drops,
            why: why.map(str::to_owned),
            said_by: "tester".into(),
            said_at: "2026-01-01T00:00:00Z".into(),
            data_hash: "0".into(),
        }
    }

    fn tag(key: &str, value: Option<&str>) -> HandTag {
        HandTag {
            run_path: "runs/a.csv".into(),
            key: key.into(),
            value: value.map(str::to_owned),
            set_by: "tester".into(),
            set_at: "2026-01-01T00:00:00Z".into(),
        }
    }

    fn with_runs(mut store: Store, names: &[&str]) -> Store {
        for (k, name) in names.iter().enumerate() {
            let run = new_run(name, RunKind::Actuation, &[k as f64, 2.0]);
            store.save_runs("now", &[], &[run]).unwrap();
        }
        store
    }

    #[test]
    fn the_newest_word_on_a_run_holds() {
        let mut store = with_runs(Store::in_memory().unwrap(), &["a", "b"]);
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
    fn words_stay_with_the_bytes_whatever_their_name_and_hold_of_nothing_where_another_lies_there() {
        let mut store = with_runs(Store::in_memory().unwrap(), &["a", "b"]);
        store
            .add_run_words("now", &[word("a", true, Some("clip slipped"))])
            .unwrap();
        let row = |path: &str| FileRow::unseen(path.to_owned(), FileState::Run, String::new());
        let pair = |old: &str, new: &str| (old.to_owned(), new.to_owned());
        let moves = Moves {
            files: [("a".to_owned(), row("b")), ("b".to_owned(), row("a"))].into(),
            runs: vec![pair("a", "b"), pair("b", "a")],
        };
        store.move_files("now", &moves).unwrap();
        let dropped = |store: &Store| store.run_words().unwrap().into_keys().collect::<Vec<_>>();
        assert_eq!(dropped(&store), ["b"]);
        let sql = "SELECT count(*) FROM run_file JOIN run ON run.id = run_id WHERE run_file.path <> run.path";
        let elsewhere: i64 = store.connection.query_row(sql, [], |row| row.get(0)).unwrap();
        assert_eq!(elsewhere, 0, "files of runs whose names were exchanged");
        // Measured on: the same.
        let mut revised = new_run("b", RunKind::Actuation, &[0.0, 2.0, 3.0]);
        store.save_runs("now", &[], &[revised.clone()]).unwrap();
        assert_eq!(dropped(&store), ["b"]);
        // Another one under the name.
        (revised.measurement, revised.continues) = ("another".to_owned(), Continues::Another);
        store.save_runs("now", &[], &[revised]).unwrap();
        assert_eq!(dropped(&store), Vec::<String>::new());
        assert_eq!(store.words_of_no_run().unwrap().len(), 1);
        // The first bytes come back, under a third name.
        let first = new_run("c", RunKind::Actuation, &[0.0, 2.0]);
        let first = NewRun {
            continues: Continues::Another,
            ..first
        };
        store.save_runs("now", &[], &[first]).unwrap();
        assert_eq!(dropped(&store), ["c"]);
        assert_eq!(store.words_of_no_run().unwrap(), []);
        assert_eq!(store.check_all().unwrap(), Vec::<String>::new());
    }

    #[test]
    fn the_newest_hand_tag_of_a_key_counts_and_can_be_taken_back() {
        let mut store = Store::in_memory().unwrap();
        let now = "2026-01-01T00:00:00Z";
        let first = [tag("sample", Some("A")), tag("note", Some("x"))];
        store.add_hand_tags(now, &first).unwrap();
        store
            .add_hand_tags(now, &[tag("sample", Some("B")), tag("note", None)])
            .unwrap();
        assert_eq!(store.hand_tags("runs/a.csv").unwrap(), [tag("sample", Some("B"))]);
    }

    #[test]
    fn what_another_connection_says_is_heard() {
        let folder = tempfile::tempdir().unwrap();
        let mut store = Store::open(folder.path()).unwrap();
        let other = Store::open_read_only(folder.path()).unwrap().unwrap();
        assert_eq!(other.hand_tags("runs/a.csv").unwrap(), []);
        store.add_hand_tags("now", &[tag("note", Some("wet"))]).unwrap();
        assert_eq!(other.hand_tags("runs/a.csv").unwrap(), [tag("note", Some("wet"))]);
    }

    #[test]
    fn a_word_that_changed_behind_the_back_of_the_store_is_noticed() {
        for tampering in [
            "UPDATE journal_line SET line = replace(line, 'true', 'false') WHERE n = 3",
            "UPDATE journal_line SET name = 'b' WHERE n = 3",
            "UPDATE journal_line SET what = 'tag' WHERE n = 3",
            "DELETE FROM journal_line WHERE n = 3",
            "DELETE FROM list_sum WHERE list = 'journal_line word'",
        ] {
            let folder = tempfile::tempdir().unwrap();
            let mut store = with_runs(Store::open(folder.path()).unwrap(), &["a", "c"]);
            let words = [word("a", true, Some("wet")), word("c", true, None)];
            store.add_run_words("now", &words).unwrap();
            assert_eq!(store.check_all().unwrap(), Vec::<String>::new());
            store.connection.execute_batch(tampering).unwrap();
            drop(store);
            let store = Store::open(folder.path()).unwrap();
            let damaged = |error| matches!(error, StoreError::Damaged { .. });
            assert!(store.run_words().is_err_and(damaged), "{tampering}");
            assert!(!store.check_all().unwrap().is_empty(), "{tampering}");
        }
    }
}
