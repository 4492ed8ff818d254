//! Writes what a transaction says: into the database as it is said, and to the journal before it commits.

use std::cell::{Cell, RefCell};
use std::io::Write;
use std::path::{Path, PathBuf};

use rusqlite::Connection;

use super::bring_up::brought_up;
use super::entry::{End, Entry, Line};
use super::file::{HeldJournal, Locked, failed, locked, opened_in, path_in};
use super::{course, tail};
use crate::{StepError, StoreError};
use ieap_system::fs::File;

/// Where the lines go that an open database says.
#[derive(Debug, Default)]
enum Kept {
    /// Into the database alone: it is in memory, or a copy to try something with.
    #[default]
    InDatabase,
    /// Nowhere: what is said is heard from lines that are there already.
    Heard,
    /// They are said at a time of their own.
    Later(RefCell<Vec<(String, Entry)>>),
    /// Into the journal of a campaign too.
    InCampaign {
        folder: PathBuf,
        /// The hold on the journal, where this program has it.
        held: Option<HeldJournal>,
    },
}

/// What a transaction under way said: it is in the database, and not in the journal yet.
#[derive(Debug, Default)]
struct Said {
    /// The end of the course before.
    before: End,
    lines: Vec<Line>,
}

/// The journal that the changes of an open database go to.
#[derive(Debug, Default)]
pub(crate) struct Journal {
    kept: Kept,
    said: RefCell<Said>,
    /// How often the words in the database changed by this connection.
    changes: Cell<u64>,
    /// Up to where the journal holds, where a line was refused and could not be taken back.
    owed: Cell<Option<u64>>,
}

/// A line that is in the journal while its transaction is not committed. As long as this lives nobody else looks.
#[derive(Debug)]
pub(crate) struct Intended {
    journal: Locked,
    path: PathBuf,
    /// Up to where the journal was written before.
    bytes: u64,
}

impl Journal {
    /// That of the campaign in `folder`.
    pub fn of(folder: &Path) -> Journal {
        Journal {
            kept: Kept::InCampaign {
                folder: folder.to_owned(),
                held: None,
            },
            ..Journal::default()
        }
    }

    /// From here on it is that of the campaign in `folder`; lines stay in the database where there is none.
    pub fn keep_in(&mut self, folder: Option<&Path>) {
        self.kept = folder.map_or_else(Journal::default, Journal::of).kept;
    }

    /// From here on nothing is kept of what is said: it is heard.
    pub fn keep_heard(&mut self) {
        self.kept = Kept::Heard;
    }

    /// From here on what is said is kept, to be said at a time of its own.
    pub fn keep_for_later(&mut self) {
        self.kept = Kept::Later(RefCell::default());
    }

    /// What was kept for later; from here on what is said is heard.
    pub fn kept_for_later(&mut self) -> Vec<(String, Entry)> {
        match std::mem::replace(&mut self.kept, Kept::Heard) {
            Kept::Later(said) => said.into_inner(),
            _ => Vec::new(),
        }
    }

    /// From here on it is that of the campaign in `folder`, which this program holds.
    pub fn keep_in_held(&mut self, folder: &Path, held: &HeldJournal) -> Result<(), StoreError> {
        self.kept = Kept::InCampaign {
            folder: folder.to_owned(),
            held: Some(held.shared(folder)?),
        };
        Ok(())
    }

    /// The campaign whose journal it is.
    pub fn campaign(&self) -> Option<&Path> {
        match &self.kept {
            Kept::InCampaign { folder, .. } => Some(folder),
            _ => None,
        }
    }

    /// How often the words in the database changed by this connection.
    pub fn changes(&self) -> u64 {
        self.changes.get()
    }

    /// The words in the database changed.
    pub fn changed(&self) {
        self.changes.set(self.changes.get() + 1);
    }

    /// Writes what is said into the database; it goes to the journal before the transaction under way commits.
    pub fn says(&self, connection: &Connection, at: &str, entry: Entry) -> Result<(), StepError> {
        match &self.kept {
            Kept::Heard => return Ok(()),
            Kept::Later(said) => {
                said.borrow_mut().push((at.to_owned(), entry));
                return Ok(());
            }
            Kept::InDatabase | Kept::InCampaign { .. } => {}
        }
        let mut said = self.said.borrow_mut();
        if said.lines.is_empty() {
            said.before = course::last(connection)?;
        }
        let end = said.lines.last().map_or_else(|| said.before.clone(), End::after);
        let of = course::run_of(connection, &entry)?;
        let line = Line::following(end.sum.as_deref(), end.n + 1, (at.to_owned(), entry, of));
        let line = line.map_err(|e| StoreError::BadValue {
            what: "an entry of the journal",
            detail: e.to_string(),
        })?;
        course::store(connection, std::slice::from_ref(&line))?;
        said.lines.push(line);
        self.changed();
        Ok(())
    }

    /// How many lines are to go to the journal.
    pub fn len(&self) -> usize {
        self.said.borrow().lines.len()
    }

    /// Forgets what was said after the first `kept`: it was taken back.
    pub fn keep_first(&self, kept: usize) {
        self.said.borrow_mut().lines.truncate(kept);
    }

    /// Brings what was said to the disk. `in_place` is asked when nobody else can write any more.
    pub fn write(
        &self,
        connection: &Connection,
        in_place: impl Fn() -> Result<(), StoreError>,
    ) -> Result<Option<Intended>, StepError> {
        let Said { before, lines } = self.said.take();
        let Kept::InCampaign { folder, held } = &self.kept else {
            return Ok(None);
        };
        if lines.is_empty() {
            return Ok(None);
        }
        let path = path_in(folder);
        let mut journal = match held {
            Some(held) => opened_in(folder, held.shared(folder)?)?,
            None => locked(folder)?,
        };
        in_place()?;
        self.pay(&before, &mut journal.file)
            .map_err(|source| failed(&path, source))?;
        let mut last = tail::mended(&mut journal.file).map_err(|source| failed(&path, source))?;
        if last.end() != before {
            let (compared, again) = brought_up(connection, folder, journal, before.n)?;
            journal = again;
            last = tail::mended(&mut journal.file).map_err(|source| failed(&path, source))?;
            if !compared.is_database_whole() || last.end() != before {
                return Err(StoreError::Lags {
                    path: folder.join(crate::FILE_NAME),
                    lacks: compared.lacks(),
                    why: "end this program, then run `ieap run`".to_owned(),
                }
                .into());
            }
        }
        let text: String = lines.iter().map(|line| format!("{}\n", line.text)).collect();
        let file = &mut journal.file;
        let added = file.write_all(text.as_bytes()).and_then(|()| file.sync_all());
        let bytes = last.bytes;
        let intended = Intended { journal, path, bytes };
        match added {
            Ok(()) => Ok(Some(intended)),
            Err(source) => {
                // What is left of it has no line feed, or says what is now refused: better cut off.
                let error = failed(&intended.path, source);
                let _ = self.take_back(intended);
                Err(error.into())
            }
        }
    }

    /// Takes back what a transaction intended that was refused after it was written.
    pub fn take_back(&self, intended: Intended) -> Result<(), StoreError> {
        let Intended { journal, path, bytes } = intended;
        let cut = journal.file.set_len(bytes).and_then(|()| journal.file.sync_all());
        cut.map_err(|source| {
            self.owed.set(Some(bytes));
            let doing = "taking back from the journal what the database refused (the next opening stores it)";
            StoreError::File { path, doing, source }
        })
    }

    /// Cuts off what was refused and could not be cut off then, where nobody has taken it up since.
    fn pay(&self, before: &End, file: &mut File) -> std::io::Result<()> {
        let Some(bytes) = self.owed.take() else {
            return Ok(());
        };
        let last = tail::last(file, bytes.min(file.metadata()?.len()))?;
        if last.end() == *before && last.bytes == bytes {
            file.set_len(bytes).inspect_err(|_| self.owed.set(Some(bytes)))
        } else {
            Ok(())
        }
    }
}
