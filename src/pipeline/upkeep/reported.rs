//! What holds after everything was said that a journal says, or a database would say: for journals and databases of which no
//! course tells whether they agree.

use std::collections::{BTreeMap, BTreeSet};

use crate::domain::{AskedFit, RunWord};
use crate::store::HandTag;
use crate::store::journal::Entry;

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
}
