//! What holds after everything was said that a journal says, or a database would say: for journals and databases of which no
//! course tells whether they agree.

use std::collections::{BTreeMap, BTreeSet};

use crate::domain::{AskedFit, RunWord};
use crate::store::HandTag;
use crate::store::journal::{Entry, Line};

/// What holds after everything was said.
#[derive(Debug, Default)]
pub struct Told {
    /// Hashes of the files of every revision of every run and log, by name and number.
    read: BTreeMap<(String, i64), Vec<String>>,
    tags: BTreeMap<(String, String), HandTag>,
    words: BTreeMap<String, RunWord>,
    asked: BTreeMap<String, AskedFit>,
}

impl Told {
    /// After all of these.
    pub fn of<'a>(entries: impl Iterator<Item = &'a Entry>) -> Told {
        let mut told = Told::default();
        entries.for_each(|entry| told.hear(entry));
        told
    }

    fn hear(&mut self, entry: &Entry) {
        match entry {
            Entry::Read { files, runs, .. } => {
                let hashes: Vec<String> = files.iter().map(|file| file.hash.clone()).collect();
                let named = runs
                    .iter()
                    .map(|run| ((run.name.clone(), run.revision), hashes.clone()));
                self.read.extend(named);
            }
            Entry::Log { file, revision } => {
                let name = (file.path.clone(), *revision);
                self.read.insert(name, vec![file.hash.clone()]);
            }
            Entry::Renamed { old, file } => self.rename(old, &file.path),
            Entry::Tag(tag) => {
                let key = (tag.run_path.clone(), tag.key.clone());
                self.tags.insert(key, tag.clone());
            }
            Entry::Word(word) => {
                self.words.insert(word.run_path.clone(), word.clone());
            }
            Entry::Asked { run, asked } if asked.is_open() => drop(self.asked.remove(run)),
            Entry::Asked { run, asked } => {
                self.asked.insert(run.clone(), asked.clone());
            }
            // Which file lies where the folder shows; an alarm that is told twice is no loss; what may be lost says nothing
            // of a run.
            Entry::Alias { .. }
            | Entry::Gone { .. }
            | Entry::Told(_)
            | Entry::Command { .. }
            | Entry::Missed { .. }
            | Entry::Answered { .. } => {}
        }
    }

    fn rename(&mut self, old: &str, new: &str) {
        let renamed = |name: String| if name == old { new.to_owned() } else { name };
        let read = std::mem::take(&mut self.read).into_iter();
        self.read = read
            .map(|((name, n), files)| ((renamed(name), n), files))
            .collect();
        let tags = std::mem::take(&mut self.tags).into_iter();
        let moved = |((run, key), tag): ((String, String), HandTag)| {
            let run_path = renamed(run);
            ((run_path.clone(), key), HandTag { run_path, ..tag })
        };
        self.tags = tags.map(moved).collect();
        if let Some(word) = self.words.remove(old) {
            let run_path = new.to_owned();
            self.words.insert(new.to_owned(), RunWord { run_path, ..word });
        }
        if let Some(asked) = self.asked.remove(old) {
            self.asked.insert(new.to_owned(), asked);
        }
    }

    /// How many of the lines say what a database says; none where no first part of them does.
    pub fn agreeing(lines: &[Line], stored: &Told) -> Option<usize> {
        let mut told = Told::default();
        let mut agreeing = told.is(stored).then_some(0);
        for (before, line) in lines.iter().enumerate() {
            told.hear(&line.entry);
            if told.is(stored) {
                agreeing = Some(before + 1);
            }
        }
        agreeing
    }

    fn is(&self, stored: &Told) -> bool {
        // Their number first: this is asked after every line.
        self.read.len() == stored.read.len() && self.differences(stored).is_empty()
    }

    /// What differs in a journal from what is stored: revisions and wishes that it lacks, and any difference of tags and
    /// words on runs, as two texts: what is another one, and of what.
    pub fn differences(&self, stored: &Told) -> Vec<(String, String)> {
        let mut found = self.lacks_of(stored);
        let keys = stored.tags.keys().chain(self.tags.keys());
        for key in keys.collect::<BTreeSet<_>>() {
            if self.tags.get(key) != stored.tags.get(key) {
                found.push((format!("the tag {} set by hand", key.1), key.0.clone()));
            }
        }
        let runs = stored.words.keys().chain(self.words.keys());
        for run in runs.collect::<BTreeSet<_>>() {
            if self.words.get(run) != stored.words.get(run) {
                found.push(("the word (dropped, or put back)".to_owned(), run.clone()));
            }
        }
        found
    }

    /// Revisions and wishes of `other` that are not the same here.
    fn lacks_of(&self, other: &Told) -> Vec<(String, String)> {
        let read = other
            .read
            .iter()
            .filter(|(run, files)| self.read.get(*run) != Some(*files));
        let read = read.map(|((run, revision), _)| (format!("revision {revision}"), run.clone()));
        let asked = (other.asked.iter()).filter(|(run, asked)| self.asked.get(*run) != Some(*asked));
        let asked = asked.map(|(run, _)| ("how a fit was asked for".to_owned(), run.clone()));
        read.chain(asked).collect()
    }

    /// What is said here and not in `other`, in words: what would be lost were only the other kept.
    pub fn only_here(&self, other: &Told) -> Vec<String> {
        let mut found: Vec<String> = (other.lacks_of(self).into_iter())
            .map(|(what, of)| format!("{what} of {of}"))
            .collect();
        for (key, tag) in &self.tags {
            if other.tags.get(key) != Some(tag) {
                found.push(Entry::Tag(tag.clone()).in_words());
            }
        }
        for (run, word) in &self.words {
            if other.words.get(run) != Some(word) {
                found.push(Entry::Word(word.clone()).in_words());
            }
        }
        found
    }
}
