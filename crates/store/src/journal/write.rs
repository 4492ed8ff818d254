//! Writes what a transaction says: to the journal, then into the database, both before it commits.

use std::cell::{Cell, RefCell};
use std::io::Write;
use std::path::{Path, PathBuf};

use rusqlite::Connection;

use super::bring_up::brought_up;
use super::entry::{Entry, Line};
use super::file::{HeldJournal, Locked, failed, locked, opened_in, path_in};
use super::{course, tail};
use crate::{StepError, StoreError};
use ieap_system::fs::File;

/// The journal that the changes of an open database go to.
#[derive(Debug, Default)]
pub(crate) struct Journal {
    /// The campaign; none where nothing is to be kept.
    campaign: Option<PathBuf>,
    /// What the transaction under way says.
    said: RefCell<Vec<(String, Entry)>>,
    /// What was said since it is kept for later.
    later: RefCell<Option<Vec<(String, Entry)>>>,
    /// The hold on the journal of the campaign, where this program has it.
    held: Option<HeldJournal>,
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
            campaign: Some(folder.to_owned()),
            ..Journal::default()
        }
    }

    /// From here on it is that of the campaign in `folder`; nothing is kept where there is none.
    pub fn keep_in(&mut self, folder: Option<&Path>) {
        *self = folder.map_or_else(Journal::default, Journal::of);
    }

    /// From here on what is said is kept, to be said at a time of its own.
    pub fn keep_for_later(&mut self) {
        *self = Journal::default();
        self.later = RefCell::new(Some(Vec::new()));
    }

    /// What was kept for later; from here on nothing is kept.
    pub fn kept_for_later(&mut self) -> Vec<(String, Entry)> {
        std::mem::take(self).later.take().unwrap_or_default()
    }

    /// From here on it is that of the campaign in `folder`, which this program holds.
    pub fn keep_in_held(&mut self, folder: &Path, held: &HeldJournal) -> Result<(), StoreError> {
        *self = Journal::of(folder);
        self.held = Some(held.shared(folder)?);
        Ok(())
    }

    /// The campaign whose journal it is.
    pub fn campaign(&self) -> Option<&Path> {
        self.campaign.as_deref()
    }

    /// To be written before the transaction under way commits.
    pub fn says(&self, at: &str, entry: Entry) {
        self.said.borrow_mut().push((at.to_owned(), entry));
    }

    /// How much is to be written.
    pub fn len(&self) -> usize {
        self.said.borrow().len()
    }

    /// Forgets what was said after the first `kept`: it was taken back.
    pub fn keep_first(&self, kept: usize) {
        self.said.borrow_mut().truncate(kept);
    }

    /// Brings what was said to the disk, and into the database. `in_place` is asked when nobody else can write any more.
    pub fn write(
        &self,
        connection: &Connection,
        in_place: impl Fn() -> Result<(), StoreError>,
    ) -> Result<Option<Intended>, StepError> {
        let said = self.said.take();
        if said.is_empty() {
            return Ok(None);
        }
        let Some(campaign) = &self.campaign else {
            if let Some(later) = self.later.borrow_mut().as_mut() {
                later.extend(said);
            }
            return Ok(None);
        };
        let path = path_in(campaign);
        let mut journal = self.locked(campaign)?;
        in_place()?;
        self.pay(connection, &mut journal.file)
            .map_err(|source| failed(&path, source))?;
        let mut last = tail::mended(&mut journal.file).map_err(|source| failed(&path, source))?;
        let mut before = course::last(connection)?;
        if (last.n, &last.sum) != (before.0, &before.1) {
            let (compared, again) = brought_up(connection, campaign, journal)?;
            journal = again;
            if !compared.is_database_whole() {
                return Err(StoreError::Lags {
                    path: campaign.join(crate::FILE_NAME),
                    lacks: compared.lacks(),
                    why: "end this program, then run `ieap run`".to_owned(),
                }
                .into());
            }
            last = tail::mended(&mut journal.file).map_err(|source| failed(&path, source))?;
            before = course::last(connection)?;
        }
        let lines = following(last.n.max(before.0), before.1, said)?;
        course::store(connection, &lines)?;
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
    fn pay(&self, connection: &Connection, file: &mut File) -> std::io::Result<()> {
        let Some(bytes) = self.owed.take().filter(|_| self.campaign.is_some()) else {
            return Ok(());
        };
        let last = tail::last(file, bytes.min(file.metadata()?.len()))?;
        let stored = course::last(connection).ok();
        if stored == Some((last.n, last.sum)) && last.bytes == bytes {
            file.set_len(bytes).inspect_err(|_| self.owed.set(Some(bytes)))
        } else {
            Ok(())
        }
    }

    /// The journal, which nobody else can write then; an empty one where there is none.
    fn locked(&self, campaign: &Path) -> Result<Locked, StoreError> {
        match &self.held {
            Some(held) => opened_in(campaign, held.shared(campaign)?),
            None => locked(campaign),
        }
    }
}

/// Entries as the lines that follow the one of that number and checksum.
fn following(
    mut n: u64,
    mut after: Option<String>,
    said: Vec<(String, Entry)>,
) -> Result<Vec<Line>, StoreError> {
    let mut lines = Vec::with_capacity(said.len());
    for said in said {
        n += 1;
        let line = Line::following(after.as_deref(), n, said).map_err(|e| StoreError::BadValue {
            what: "an entry of the journal",
            detail: e.to_string(),
        })?;
        after = Some(line.sum().to_owned());
        lines.push(line);
    }
    Ok(lines)
}
