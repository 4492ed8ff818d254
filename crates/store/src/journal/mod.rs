//! The journal of a campaign, `archive/journal.jsonl`: what no file holds, on the disk before the database has it.
//!
//! A change says what of it no file holds ([`Entry`]); the transaction writes that to the journal, and waits for the disk,
//! just before it commits. Only who holds the database's write lock writes, so the order is that of the database. A crash
//! between the two leaves a line of what nobody was told of yet; a crash while a line is written leaves half a line, which
//! has no line feed: the next one to write cuts it off. Where there is no journal it is written whole from the database.

mod entry;
mod from_database;
mod line;
mod tail;
#[cfg(test)]
mod tests;

use std::cell::RefCell;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rusqlite::Connection;

use super::{StepError, Store, StoreError};
use ieap_system::Temporary;
use ieap_system::fs::{self, File, OpenOptions, TryLockError};

pub use entry::{Entry, Line, NamedBytes, NamedRun, ToldAlarm};
pub use tail::without_torn_end;

/// Folder of the journal inside a campaign: that of the raw files.
const FOLDER: &str = "archive";
/// Its name there.
const FILE_NAME: &str = "journal.jsonl";
/// How names of files begin that are not written to their end yet; the archive removes what a crash left of them.
const PARTIAL: &str = ".part-";
/// How long a change waits for a rebuilding to end.
const PATIENCE: Duration = Duration::from_secs(30);

/// Where the journal of the campaign in `folder` is.
pub fn path_in(folder: &Path) -> PathBuf {
    folder.join(FOLDER).join(FILE_NAME)
}

/// The journal that the changes of an open database go to.
#[derive(Debug, Default)]
pub(super) struct Journal {
    /// The campaign; none where nothing is to be kept.
    campaign: Option<PathBuf>,
    /// What the transaction under way says.
    said: RefCell<Vec<(String, Entry)>>,
}

impl Journal {
    /// That of the campaign in `folder`.
    pub fn of(folder: &Path) -> Journal {
        Journal {
            campaign: Some(folder.to_owned()),
            said: RefCell::default(),
        }
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

    /// Brings what was said to the disk. `in_place` is asked when nobody else can write any more.
    pub fn write(
        &self,
        connection: &Connection,
        in_place: impl Fn() -> Result<(), StoreError>,
    ) -> Result<(), StepError> {
        let said = self.said.take();
        let Some(campaign) = self.campaign.as_ref().filter(|_| !said.is_empty()) else {
            return Ok(());
        };
        let path = path_in(campaign);
        let mut options = OpenOptions::own();
        let mut file = match options.read(true).write(true).open(&path) {
            Ok(file) => file,
            // The database holds all that was ever said, this included.
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return from_database::write(connection, campaign);
            }
            Err(source) => return Err(failed(&path, source).into()),
        };
        lock(&file, &path)?;
        in_place()?;
        let last = tail::mended(&mut file).map_err(|source| failed(&path, source))?;
        let mut text = String::new();
        for (n, (at, entry)) in (last.n + 1..).zip(said) {
            text += &written(&Line { n, at, entry })?;
        }
        let added = file.write_all(text.as_bytes()).and_then(|()| file.sync_all());
        added.map_err(|source| {
            // What is left of it has no line feed, or says what is now refused: better cut off.
            let _ = file.set_len(last.bytes);
            failed(&path, source).into()
        })
    }
}

impl Store {
    /// From here on, what is said goes to the journal of the campaign in `folder`; nowhere where there is none.
    pub fn keep_journal_in(&mut self, folder: Option<&Path>) {
        self.journal = folder.map_or_else(Journal::default, Journal::of);
    }

    /// Writes the journal from the database where the campaign has none: an earlier version of the program kept none, or
    /// it was lost. Tells whether it did.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn begin_journal(&mut self) -> Result<bool, StoreError> {
        let Some(campaign) = self.journal.campaign.clone() else {
            return Ok(false);
        };
        let path = path_in(&campaign);
        if fs::exists(&path).map_err(|source| failed(&path, source))? {
            return Ok(false);
        }
        self.begin_batch()?;
        let begun = from_database::write(&self.connection, &campaign);
        let ended = self.commit_batch();
        begun.map_err(self.named("writing the journal"))?;
        ended.map(|()| true)
    }

    /// What the journal of this campaign would say had it been written from the database.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn journal_entries(&self) -> Result<Vec<(String, Entry)>, StoreError> {
        from_database::entries(&self.connection).map_err(self.named("reading what no file holds"))
    }
}

/// Moves the journal of the campaign in `folder` aside, with the database that it was kept for.
///
/// # Errors
/// It cannot be renamed.
pub fn set_aside(folder: &Path, mark: &str) -> Result<(), StoreError> {
    let path = path_in(folder);
    let aside = path.with_file_name(format!("{FILE_NAME}.set-aside-{mark}"));
    match fs::rename(&path, aside) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(failed(&path, source)),
        _ => Ok(()),
    }
}

/// A journal that nobody else can write as long as this lives.
#[derive(Debug)]
pub struct HeldJournal {
    _file: Option<File>,
}

/// Holds the journal of the campaign in `folder`, where there is one.
///
/// # Errors
/// It cannot be opened, or somebody else holds it for long.
pub fn hold(folder: &Path) -> Result<HeldJournal, StoreError> {
    let path = path_in(folder);
    match OpenOptions::own().read(true).write(true).open(&path) {
        Ok(file) => {
            lock(&file, &path)?;
            Ok(HeldJournal { _file: Some(file) })
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(HeldJournal { _file: None }),
        Err(source) => Err(failed(&path, source)),
    }
}

/// What a journal holds.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Found {
    /// Lines that can be trusted, in order.
    pub lines: Vec<Line>,
    /// Lines that cannot: their place, from 1, and why.
    pub damaged: Vec<(usize, String)>,
    /// Numbers that should stand before the next line and do not: lines are missing there.
    pub gaps: Vec<u64>,
    /// Whether the last line is cut off: nobody was told of what it says.
    pub is_torn: bool,
}

/// Reads the journal of the campaign in `folder`; `None` where there is none.
///
/// # Errors
/// It cannot be read.
pub fn read(folder: &Path) -> Result<Option<Found>, StoreError> {
    let path = path_in(folder);
    match fs::read_own(&path) {
        Ok(bytes) => Ok(Some(found(&bytes))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(failed(&path, source)),
    }
}

/// What the bytes of a journal hold.
pub fn found(bytes: &[u8]) -> Found {
    let mut found = Found::default();
    let whole = tail::without_torn_end(bytes);
    found.is_torn = whole.len() < bytes.len();
    let mut expected = 1;
    for (index, text) in whole.split_inclusive(|&byte| byte == b'\n').enumerate() {
        match line::read(text.strip_suffix(b"\n").unwrap_or(text)) {
            Ok(line) => {
                if line.n != expected {
                    found.gaps.push(line.n.saturating_sub(1));
                }
                expected = line.n + 1;
                found.lines.push(line);
            }
            Err(reason) => {
                found.damaged.push((index + 1, reason));
                expected += 1;
            }
        }
    }
    found
}

fn written(line: &Line) -> Result<String, StoreError> {
    line::written(line).map_err(|e| StoreError::BadValue {
        what: "an entry of the journal",
        detail: e.to_string(),
    })
}

/// Puts a whole journal in place.
fn put(campaign: &Path, text: &str) -> Result<(), StoreError> {
    let path = path_in(campaign);
    let folder = campaign.join(FOLDER);
    let place = || -> io::Result<()> {
        fs::create_dir_all(&folder)?;
        let mut file = Temporary::new_in(&folder, PARTIAL, "", 0o644)?;
        file.write_all(text.as_bytes())?;
        file.sync_all()?;
        file.persist_to_free(&path)?;
        fs::sync_names(&folder)?;
        fs::sync_names(campaign)
    };
    place().map_err(|source| failed(&path, source))
}

fn lock(file: &File, path: &Path) -> Result<(), StoreError> {
    let begun = Instant::now();
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(()),
            Err(TryLockError::WouldBlock) if begun.elapsed() < PATIENCE => {
                std::thread::sleep(Duration::from_millis(50));
            }
            Err(TryLockError::WouldBlock) => {
                return Err(StoreError::Locked {
                    path: path.to_owned(),
                    doing: "writing the journal",
                });
            }
            Err(TryLockError::Error(source)) => return Err(failed(path, source)),
        }
    }
}

fn failed(path: &Path, source: io::Error) -> StoreError {
    let (path, doing) = (path.to_owned(), "keeping the journal");
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
            StoreError::DiskFull { path, doing }
        }
        _ => StoreError::File { path, doing, source },
    }
}
