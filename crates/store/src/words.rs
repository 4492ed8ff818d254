//! What people said, as the lines of the journal in the database have it: tags by hand, words on runs, wishes how to fit, and
//! which alarms were told.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rusqlite::Row;

use super::journal::{Entry, ToldAlarm, read_line};
use super::rows::JOURNAL_LINE;
use super::{HandTag, Store, StoreError};
use ieap_domain::{Alarm, AskedFit, RunWord};

/// What holds after every line was said, by the names that runs have now.
#[derive(Debug, Default)]
pub(super) struct Words {
    /// The newest tag by hand of each run and key, taken-back ones left out.
    pub tags: BTreeMap<String, BTreeMap<String, HandTag>>,
    /// The newest word on each run.
    pub runs: BTreeMap<String, RunWord>,
    /// The newest wish how to fit each run.
    pub asked: BTreeMap<String, AskedFit>,
    /// Alarms that were told, in the order of telling.
    pub told: Vec<ToldAlarm>,
    /// What may be lost and nobody answered.
    pub missed: Vec<String>,
    /// The same with what was answered.
    pub ever_missed: Vec<String>,
}

/// Words with the state of the database that they are of: what other connections changed, and what this one did.
pub(super) type Remembered = Option<((i64, u64), Arc<Words>)>;

/// Kinds of lines that are words.
const KINDS: [&str; 6] = ["tag", "word", "asked", "told", "missed", "answered"];

impl Words {
    /// `name` is that which the run has now.
    fn hear(&mut self, name: Option<String>, entry: Entry) {
        let name = name.unwrap_or_default();
        match entry {
            Entry::Tag(tag) => {
                let (run_path, key) = (name, tag.key.clone());
                let of_run = self.tags.entry(run_path.clone()).or_default();
                if tag.value.is_some() {
                    of_run.insert(key, HandTag { run_path, ..tag });
                } else {
                    of_run.remove(&key);
                }
            }
            Entry::Word(word) => {
                let run_path = name.clone();
                self.runs.insert(name, RunWord { run_path, ..word });
            }
            Entry::Asked { asked, .. } if asked.is_open() => drop(self.asked.remove(&name)),
            Entry::Asked { asked, .. } => drop(self.asked.insert(name, asked)),
            Entry::Told(alarm) => self.told.push(alarm),
            Entry::Missed { lost } => {
                self.ever_missed.push(lost.clone());
                self.missed.push(lost);
            }
            Entry::Answered { .. } => self.missed.clear(),
            _ => {}
        }
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
        lines
            .into_iter()
            .for_each(|(name, line)| words.hear(name, line.entry));
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

    /// The newest hand tag of each key of a run, taken-back ones left out, in order of the keys.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn hand_tags(&self, run_path: &str) -> Result<Vec<HandTag>, StoreError> {
        let words = self.words()?;
        let tags = words.tags.get(run_path);
        Ok(tags.map_or_else(Vec::new, |tags| tags.values().cloned().collect()))
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

    /// The newest word on each run, by the run's name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn run_words(&self) -> Result<BTreeMap<String, RunWord>, StoreError> {
        Ok(self.words()?.runs.clone())
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

    #[test]
    fn the_newest_word_on_a_run_holds() {
        let mut store = Store::in_memory().unwrap();
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
            "UPDATE journal_line SET line = replace(line, 'true', 'false') WHERE n = 1",
            "UPDATE journal_line SET name = 'b' WHERE n = 1",
            "UPDATE journal_line SET what = 'tag' WHERE n = 1",
            "DELETE FROM journal_line WHERE n = 1",
            "DELETE FROM list_sum WHERE list = 'journal_line word'",
        ] {
            let folder = tempfile::tempdir().unwrap();
            let mut store = Store::open(folder.path()).unwrap();
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
