//! The journal: its lines, and whether it says what the database says.

use std::collections::BTreeMap;
use std::path::Path;

use super::{Part, counted};
use crate::domain::{AskedFit, Issue, RunWord};
use crate::pipeline::rebuild::what_is_wrong;
use crate::pipeline::{Context, PipelineError};
use crate::store::journal::{self, Entry, Found};
use crate::store::{HandTag, Store};

/// Name of the part.
const NAME: &str = "journal";

/// Looks at its lines alone.
///
/// # Errors
/// It cannot be read.
pub fn alone(folder: &Path) -> Result<Part, PipelineError> {
    let found = journal::read(folder)?;
    Ok(of_lines(found.as_ref()))
}

/// Looks at its lines and holds them against the database.
///
/// # Errors
/// It or the database cannot be read.
pub fn part(context: &Context) -> Result<Part, PipelineError> {
    let mut differences = differences(context)?;
    if !differences.is_empty() {
        // Somebody may have said something between the two readings: what differs twice differs.
        let again = self::differences(context)?;
        differences.retain(|issue| again.contains(issue));
    }
    let found = journal::read(&context.folder)?;
    if found.is_none() && context.store.journal_entries()?.is_empty() {
        return Ok(Part {
            part: NAME,
            looked_at: "nothing was said yet".to_owned(),
            findings: Vec::new(),
        });
    }
    let mut part = of_lines(found.as_ref());
    if found.is_some() {
        part.findings.extend(differences);
    }
    Ok(part)
}

fn of_lines(found: Option<&Found>) -> Part {
    let mut findings = what_is_wrong(found);
    if found.is_some_and(|found| found.is_torn) {
        let torn = "the last line is cut off: a program was ended while it wrote it, and nobody was told of what it says";
        findings.push(
            Issue::note("journal-torn", torn).mend("nothing needs to be done: the next line takes its place"),
        );
    }
    Part {
        part: NAME,
        looked_at: counted(found.map_or(0, |found| found.lines.len()), "line"),
        findings,
    }
}

fn differences(context: &Context) -> Result<Vec<Issue>, PipelineError> {
    let found = || Ok(journal::read(&context.folder)?.unwrap_or_default());
    against(found, &context.store)
}

/// What a journal lacks of what a database says, and the words of it that the database does not know.
///
/// # Errors
/// One of them cannot be read.
pub fn against(
    found: impl FnOnce() -> Result<Found, PipelineError>,
    store: &Store,
) -> Result<Vec<Issue>, PipelineError> {
    let stored = store.journal_entries()?;
    let stored = Told::of(stored.iter().map(|(_, entry)| entry));
    // After the database: it is said there first.
    let lines = found()?.lines;
    Ok(Told::of(lines.iter().map(|line| &line.entry)).against(&stored))
}

/// What holds after everything was said.
#[derive(Debug, Default)]
struct Told {
    /// Hashes of the files of every revision of every run and log, by name and number.
    read: BTreeMap<(String, i64), Vec<String>>,
    tags: BTreeMap<(String, String), HandTag>,
    words: BTreeMap<String, RunWord>,
    asked: BTreeMap<String, AskedFit>,
}

impl Told {
    fn of<'a>(entries: impl Iterator<Item = &'a Entry>) -> Told {
        let mut told = Told::default();
        entries.for_each(|entry| told.hear(entry));
        told.asked.retain(|_, asked| !asked.is_open());
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
            Entry::Asked { run, asked } => {
                self.asked.insert(run.clone(), asked.clone());
            }
            // Which file lies where the folder shows; an alarm that is told twice is no loss.
            Entry::Alias { .. } | Entry::Gone { .. } | Entry::Told(_) | Entry::Command { .. } => {}
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

    /// What the journal lacks of what is stored, and the words that were never stored.
    fn against(&self, stored: &Told) -> Vec<Issue> {
        let mut found = Vec::new();
        let mut lacks = |what: &str, name: &str| {
            let message = format!("{what} of {name} in the database is not as in the journal");
            found.push(Issue::error("journal-differs", message).mend(
                "where the database is right, move archive/journal.jsonl away, and the next `ieap run` writes it from \
                 there; where the journal is right, `ieap rebuild`",
            ));
        };
        for (run, files) in &stored.read {
            if self.read.get(run) != Some(files) {
                lacks(&format!("revision {}", run.1), &run.0);
            }
        }
        let keys = stored.tags.keys().chain(self.tags.keys());
        for key in keys.collect::<std::collections::BTreeSet<_>>() {
            if self.tags.get(key) != stored.tags.get(key) {
                lacks(&format!("the tag {} set by hand", key.1), &key.0);
            }
        }
        let runs = stored.words.keys().chain(self.words.keys());
        for run in runs.collect::<std::collections::BTreeSet<_>>() {
            if self.words.get(run) != stored.words.get(run) {
                lacks("the word (dropped, or put back)", run);
            }
        }
        for (run, asked) in &stored.asked {
            if self.asked.get(run) != Some(asked) {
                lacks("how a fit was asked for", run);
            }
        }
        found
    }
}
