//! The file of a journal: where it is, what it holds, and who may write it.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::entry::Line;
use super::{line, tail};
use crate::{StoreError, locks};
use ieap_system::Temporary;
use ieap_system::fs::{self, File, OpenOptions, TryLockError};

/// Folder of the journal inside a campaign: that of the raw files.
pub(super) const FOLDER: &str = "archive";
/// Its name there.
pub(super) const FILE_NAME: &str = "journal.jsonl";
/// The file that is locked by whoever writes the journal. It holds nothing.
const LOCK_NAME: &str = "journal.lock";
/// How names of files begin that are not written to their end yet; the archive removes what a crash left of them.
pub(super) const PARTIAL: &str = ".part-";
/// How long a change waits for a rebuilding to end.
const PATIENCE: Duration = Duration::from_secs(30);

/// Where the journal of the campaign in `folder` is.
pub fn path_in(folder: &Path) -> PathBuf {
    folder.join(FOLDER).join(FILE_NAME)
}

/// Where a journal is that was moved aside under that mark.
pub(crate) fn aside_in(folder: &Path, mark: &str) -> PathBuf {
    path_in(folder).with_file_name(format!("{FILE_NAME}.set-aside-{mark}"))
}

/// Moves the journal of the campaign in `folder` aside, with the database that it was kept for.
///
/// # Errors
/// It cannot be renamed.
pub fn set_aside(folder: &Path, mark: &str) -> Result<(), StoreError> {
    let path = path_in(folder);
    match fs::rename(&path, aside_in(folder, mark)) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(failed(&path, source)),
        _ => Ok(()),
    }
}

/// The journal of a campaign, which nobody else can write as long as this lives. What is locked is a file of its own that is
/// never replaced: whoever waits for it opens the journal that is there then.
#[derive(Debug)]
pub struct HeldJournal {
    lock: File,
}

impl HeldJournal {
    /// Waits until nobody else holds the journal of the campaign in `folder`.
    pub(super) fn wait(folder: &Path) -> Result<HeldJournal, StoreError> {
        let path = folder.join(FOLDER).join(LOCK_NAME);
        let open = || {
            OpenOptions::own()
                .read(true)
                .write(true)
                .create(true)
                .truncate(false)
                .open(&path)
        };
        let opened = fs::create_dir_all(folder.join(FOLDER)).and_then(|()| open());
        let lock = opened.map_err(|source| failed(&path, source))?;
        wait(&lock, &path)?;
        Ok(HeldJournal { lock })
    }

    /// The same where nothing can be written: whoever never wrote into the campaign holds nothing.
    pub(super) fn wait_to_read(folder: &Path) -> Result<Option<HeldJournal>, StoreError> {
        let path = folder.join(FOLDER).join(LOCK_NAME);
        match File::open_own(&path) {
            Ok(lock) => {
                wait(&lock, &path)?;
                Ok(Some(HeldJournal { lock }))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(failed(&path, source)),
        }
    }

    /// The same hold once more.
    pub(super) fn shared(&self, folder: &Path) -> Result<HeldJournal, StoreError> {
        let lock = self.lock.try_clone();
        let lock = lock.map_err(|source| failed(&folder.join(FOLDER).join(LOCK_NAME), source))?;
        Ok(HeldJournal { lock })
    }
}

/// Holds the journal of the campaign in `folder`.
///
/// # Errors
/// It cannot be locked, or somebody else holds it for long.
pub fn hold(folder: &Path) -> Result<HeldJournal, StoreError> {
    HeldJournal::wait(folder)
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
    /// Number of the last line, a damaged one counted; 0 where there is none.
    pub last_number: u64,
}

impl Found {
    /// Whether every line that should be there is, and can be trusted.
    pub fn is_whole(&self) -> bool {
        self.damaged.is_empty() && self.gaps.is_empty()
    }
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
                expected = line.n.saturating_add(1);
                found.lines.push(line);
            }
            Err(reason) => {
                found.damaged.push((index + 1, reason));
                expected = expected.saturating_add(1);
            }
        }
    }
    found.last_number = expected - 1;
    found
}

/// The journal, open to be written; none where there is none.
pub(super) fn opened(path: &Path) -> Result<Option<File>, StoreError> {
    match OpenOptions::own().read(true).write(true).open(path) {
        Ok(file) => Ok(Some(file)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(failed(path, source)),
    }
}

/// Puts a whole journal in place where there is none.
pub(super) fn put(campaign: &Path, text: &str) -> Result<(), StoreError> {
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

fn wait(file: &File, path: &Path) -> Result<(), StoreError> {
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
            Err(TryLockError::Error(source)) => {
                return Err(locks::refused(path, "locking the journal", source));
            }
        }
    }
}

pub(super) fn failed(path: &Path, source: io::Error) -> StoreError {
    let (path, doing) = (path.to_owned(), "keeping the journal");
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
            StoreError::DiskFull { path, doing }
        }
        _ => StoreError::File { path, doing, source },
    }
}

/// A journal open to be written, and the hold on it.
#[derive(Debug)]
pub(super) struct Locked {
    pub(super) file: File,
    pub(super) held: HeldJournal,
}

/// The journal of a campaign, which nobody else can write then; an empty one where there is none.
pub(super) fn locked(campaign: &Path) -> Result<Locked, StoreError> {
    opened_in(campaign, HeldJournal::wait(campaign)?)
}

/// The same for who holds it.
pub(super) fn opened_in(campaign: &Path, held: HeldJournal) -> Result<Locked, StoreError> {
    let path = path_in(campaign);
    let file = match opened(&path)? {
        Some(file) => file,
        None => {
            put(campaign, "")?;
            let gone = std::io::Error::from(std::io::ErrorKind::NotFound);
            opened(&path)?.ok_or_else(|| failed(&path, gone))?
        }
    };
    Ok(Locked { file, held })
}
