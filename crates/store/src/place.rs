//! The file of a campaign's database: its name, what may lie there, and whether it is still the one that was opened.

use std::cell::Cell;
use std::path::{Path, PathBuf};

use rusqlite::Connection;

use super::StoreError;
use ieap_system::fs;

/// Name of the database inside a campaign.
pub const FILE_NAME: &str = "campaign.db";

/// Refuses a link, a pipe or a device in the place of a database or of what SQLite keeps beside it. It is not opened for that:
/// closing a file frees what locks this program has on it.
pub(super) fn refuse_other_than_files(database: &Path) -> Result<(), StoreError> {
    for companion in ["", "-wal", "-shm", "-journal"] {
        let path = PathBuf::from(format!("{}{companion}", database.display()));
        fs::check_own(&path).map_err(|source| StoreError::File {
            path,
            doing: "opening the database",
            source,
        })?;
    }
    Ok(())
}

/// Whether a database holds nothing at all.
pub(super) fn has_no_tables(connection: &Connection) -> rusqlite::Result<bool> {
    connection.query_row("SELECT count(*) = 0 FROM sqlite_schema", [], |row| row.get(0))
}

/// Device and inode of a file.
type FileId = (u64, u64);

/// The files that an open database consists of; none where the system has no such numbers, or in memory.
#[derive(Debug, Default)]
pub(super) struct Place {
    file: Option<FileId>,
    /// The write-ahead log, from when it is first seen.
    log: Cell<Option<FileId>>,
}

impl Place {
    /// Of the database that was just opened.
    pub fn of(path: &Path) -> Result<Place, StoreError> {
        Ok(Place {
            file: file_id(path)?,
            log: Cell::new(None),
        })
    }

    /// Refuses where the database at `path`, or its write-ahead log, is another one than was opened.
    pub fn check(&self, path: &Path) -> Result<(), StoreError> {
        let Some(file) = self.file else {
            return Ok(());
        };
        let log_path = PathBuf::from(format!("{}-wal", path.display()));
        let (now, log) = (file_id(path)?, file_id(&log_path)?);
        let changed = match (self.log.get(), log) {
            _ if now != Some(file) => Some(path),
            (Some(known), found) if found != Some(known) => Some(log_path.as_path()),
            (_, found) => {
                self.log.set(found);
                None
            }
        };
        match changed {
            None => Ok(()),
            Some(path) => Err(StoreError::Replaced {
                path: path.to_owned(),
            }),
        }
    }
}

/// None where there is no such file.
#[cfg(unix)]
fn file_id(path: &Path) -> Result<Option<FileId>, StoreError> {
    use std::os::unix::fs::MetadataExt;
    match fs::metadata(path) {
        Ok(found) => Ok(Some((found.dev(), found.ino()))),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        // What the system cannot tell now is no sign that the file is another one.
        Err(source) => Err(StoreError::File {
            path: path.to_owned(),
            doing: "looking whether it is in its place",
            source,
        }),
    }
}

#[cfg(not(unix))]
fn file_id(_path: &Path) -> Result<Option<FileId>, StoreError> {
    Ok(None)
}
