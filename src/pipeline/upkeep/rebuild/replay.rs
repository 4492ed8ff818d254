//! Says everything again that a journal holds, to a new database.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::archived::ArchivedFiles;
use super::plan;
use crate::domain::{FileState, Issue, RunKind};
use crate::ingest::climate_log;
use crate::numerics::interrupt;
use crate::pipeline::campaign::context::now;
use crate::pipeline::intake::climate::{Shelf, new_log};
use crate::pipeline::intake::ingest::{Outcome, PreparedFile, Readers, files_of_runs, runs_of, together};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::journal::{Entry, Line, MovedFile, NamedBytes, NamedRun};
use crate::store::{FileRow, Moves, Store};

/// Lines between two commits: bounds memory, and lets threads read side by side.
const BATCH: usize = 32;

/// What saying it again came to.
#[derive(Debug, Default)]
pub struct Replayed {
    /// Runs and logs that do not come back.
    pub lost: Vec<Lost>,
    /// Tags, words on runs, and wishes how to fit.
    pub words: usize,
}

/// A run or log that does not come back.
#[derive(Debug)]
pub struct Lost {
    /// Its name.
    pub name: String,
    /// Hashes of the bytes that it was read from.
    pub hashes: Vec<String>,
    /// Why.
    pub issue: Issue,
}

/// Says what the lines say to the database of `context`, with the times at which it was said first.
///
/// # Errors
/// The database or the archive refuses.
pub fn replay(
    context: &mut Context,
    lines: &[Line],
    observer: &dyn Observer,
) -> Result<Replayed, PipelineError> {
    let mut replayed = Replayed::default();
    let hold: BTreeSet<u64> = plan::that_hold(lines).into_iter().map(|line| line.n).collect();
    observer.begin("reading raw files again", lines.len() as u64);
    for batch in lines.chunks(BATCH) {
        interrupt::check();
        let archived = ArchivedFiles::of(context);
        let holding: Vec<&Line> = batch.iter().filter(|line| hold.contains(&line.n)).collect();
        let read: Vec<Vec<Result<PreparedFile, Issue>>> = holding
            .par_iter()
            .map(|line| read_again(&archived, line))
            .collect();
        together(context, |context| {
            let mut of_batch = holding.into_iter().zip(read).peekable();
            batch.iter().try_for_each(|line| {
                // With what it says, or a program that is ended here would say it twice.
                context.store.hear(&now(), std::slice::from_ref(line))?;
                match of_batch.next_if(|(holding, _)| holding.n == line.n) {
                    Some((_, read)) => replayed.say(context, line, read),
                    None => Ok(()),
                }
            })
        })?;
        batch.iter().for_each(|_| observer.advance());
    }
    observer.end();
    Ok(replayed)
}

/// The files that a line speaks of, read again.
fn read_again(archived: &ArchivedFiles<'_>, line: &Line) -> Vec<Result<PreparedFile, Issue>> {
    match &line.entry {
        Entry::Read {
            kind, reader, files, ..
        } => files
            .iter()
            .map(|file| archived.read(file, *kind, reader))
            .collect(),
        // The kind is asked of run tables only.
        Entry::Log { file, .. } => vec![archived.read(file, RunKind::Actuation, "")],
        _ => Vec::new(),
    }
}

impl Replayed {
    fn say(
        &mut self,
        context: &mut Context,
        line: &Line,
        read: Vec<Result<PreparedFile, Issue>>,
    ) -> Result<(), PipelineError> {
        let at = line.at.as_str();
        let store = &mut context.store;
        match &line.entry {
            Entry::Read {
                kind, runs, files, ..
            } => return self.read(context, at, *kind, (runs, files), read),
            Entry::Log { file, .. } => return self.log(context, at, file, read),
            Entry::Alias { file } => store.record_files(at, &[row(file, FileState::Alias)])?,
            Entry::Moved { files, runs } => moved(store, at, files, runs)?,
            Entry::Renamed { old, file } => {
                let files = [MovedFile {
                    old: old.clone(),
                    now: file.clone(),
                }];
                moved(store, at, &files, &[(old.clone(), file.path.clone())])?;
            }
            Entry::Gone { path, tags } => {
                // The run's own file, though another one lay in its place.
                let held = files_of_runs(store, std::slice::from_ref(path))?;
                store.record_files(at, &held)?;
                store.mark_missing(at, std::slice::from_ref(path))?;
                store.keep_tags(at, path, tags)?;
            }
            // The line itself is all that is stored of a word.
            Entry::Tag(_) | Entry::Word(_) | Entry::Asked { .. } => self.words += 1,
            Entry::Told(_) | Entry::Command { .. } | Entry::Missed { .. } | Entry::Answered { .. } => {}
        }
        Ok(())
    }

    fn read(
        &mut self,
        context: &mut Context,
        at: &str,
        kind: RunKind,
        (runs, named): (&[NamedRun], &[NamedBytes]),
        read: Vec<Result<PreparedFile, Issue>>,
    ) -> Result<(), PipelineError> {
        let files = match read.into_iter().collect::<Result<Vec<_>, _>>() {
            Ok(files) => files,
            Err(issue) => {
                let lost = |run: &NamedRun| Lost {
                    name: run.name.clone(),
                    hashes: named.iter().map(|file| file.hash.clone()).collect(),
                    issue: issue.clone(),
                };
                self.lost.extend(runs.iter().map(lost));
                return Ok(());
            }
        };
        let names: Vec<String> = runs.iter().map(|run| run.name.clone()).collect();
        let (readers, shelf) = tools(context)?;
        let base = names.first().map_or("", String::as_str);
        let (rows, made) = runs_of(context, (&readers, &shelf), (base, kind), &files, runs)?;
        for name in names.iter().skip(made.len()) {
            let issue = Issue::error(
                "table-not-found",
                "the readers of today do not find its table in the file",
            )
            .mend("report it with the file");
            self.lost.push(Lost {
                name: name.clone(),
                hashes: Vec::new(),
                issue,
            });
        }
        Ok(context.store.save_runs(at, &rows, &made)?)
    }

    fn log(
        &mut self,
        context: &mut Context,
        at: &str,
        file: &NamedBytes,
        read: Vec<Result<PreparedFile, Issue>>,
    ) -> Result<(), PipelineError> {
        for read in read {
            let made = read.and_then(|prepared| {
                let Outcome::Read(reading) = &prepared.outcome else {
                    return Ok(None);
                };
                let log = climate_log::log(reading, &file.path)?;
                let readers = Readers::of(&context.profiles, &context.campaign, &[]);
                Ok(new_log(&readers, &prepared, reading, log))
            });
            match made {
                Ok(Some((row, log))) => context.store.save_log(at, &row, &log)?,
                Ok(None) => {}
                Err(issue) => self.lost.push(Lost {
                    name: file.path.clone(),
                    hashes: vec![file.hash.clone()],
                    issue,
                }),
            }
        }
        Ok(())
    }
}

/// Names runs, logs and their files as a look found them.
fn moved(
    store: &mut Store,
    at: &str,
    files: &[MovedFile],
    runs: &[(String, String)],
) -> Result<(), PipelineError> {
    let mut moves = Moves {
        runs: runs.to_vec(),
        ..Moves::default()
    };
    for file in files {
        let state = if store.has_log(&file.old)? {
            FileState::Log
        } else {
            FileState::Run
        };
        moves.files.insert(file.old.clone(), row(&file.now, state));
    }
    Ok(store.move_files(at, &moves)?)
}

/// What runs are made with: the readers, and the climate logs that came before.
fn tools(context: &Context) -> Result<(Readers, Shelf), PipelineError> {
    let readers = Readers::of(&context.profiles, &context.campaign, &[]);
    Ok((readers, Shelf::open(&context.store)?))
}

/// A file of which only its bytes are known; the next scan looks at it.
fn row(file: &NamedBytes, state: FileState) -> FileRow {
    FileRow {
        hash: Some(file.hash.clone()),
        ..FileRow::unseen(file.path.clone(), state, String::new())
    }
}
