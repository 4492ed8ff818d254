//! Why the database could not do its work.

use std::path::PathBuf;

use rusqlite::ErrorCode;
use thiserror::Error;

use super::locks;

/// A failure of the database, in words a user can act on.
#[derive(Debug, Error)]
pub enum StoreError {
    /// Another connection held the lock for too long.
    #[error(
        "{path}: the database is locked by another program ({doing}). Close programs that have it open, then run again."
    )]
    Locked {
        /// The database file.
        path: PathBuf,
        /// What was being done.
        doing: &'static str,
    },
    /// The file system gives no locks.
    #[error(
        "{path}: the file system gives no locks ({detail}), and without them two programs could write at once. On a network share have the locks switched on (of NFS the lock service, and no mount option `nolock`), or copy the campaign to a disk of this computer; nothing was changed."
    )]
    NoLocks {
        /// The file that was to be locked.
        path: PathBuf,
        /// What the system says.
        detail: String,
    },
    /// The file or its folder cannot be written.
    #[error(
        "{path}: the database cannot be written ({doing}). Check the permissions of the file and of its folder, then run again; nothing was lost."
    )]
    ReadOnly {
        /// The database file.
        path: PathBuf,
        /// What was being done.
        doing: &'static str,
    },
    /// No space is left.
    #[error(
        "{path}: the disk is full ({doing}). Free some space, then run again; what was stored before is safe."
    )]
    DiskFull {
        /// The database file.
        path: PathBuf,
        /// What was being done.
        doing: &'static str,
    },
    /// The file is no database, or is damaged.
    #[error(
        "{path}: this is not a readable SQLite database ({detail}). `ieap rebuild` moves it aside and makes a new one from archive and journal, or put a backup of it back. Without archive and journal, `ieap run --new-database` makes one from the files in the campaign alone."
    )]
    NotADatabase {
        /// The database file.
        path: PathBuf,
        /// What SQLite says.
        detail: String,
    },
    /// An older program made the database.
    #[error(
        "{path}: the database has schema {found}, this program needs schema {needed}. `ieap run` makes a new one from archive and journal, and keeps the old one beside it; end any other ieap that works on the campaign before."
    )]
    Older {
        /// The database file.
        path: PathBuf,
        /// Schema version found.
        found: i64,
        /// Schema version needed.
        needed: i64,
    },
    /// What the database's tables, indexes or triggers are is not what ieap makes.
    #[error(
        "{path}: another program changed the schema of the database: {detail}. What is stored may have been changed with it, and nothing is read. Put a backup of it back, or `ieap rebuild` moves it aside and makes a new one from archive and journal."
    )]
    ChangedSchema {
        /// The database file.
        path: PathBuf,
        /// What is not as it was made.
        detail: String,
    },
    /// The database says that it is empty, and holds tables.
    #[error(
        "{path}: the database holds tables and no version of their schema (user_version is 0): another program wrote to it. Put a backup of it back. If there is none, `ieap run --new-database` moves it aside and makes a new one from the files in the campaign; what only the database held, such as tags set by hand, is lost then."
    )]
    NoVersion {
        /// The database file.
        path: PathBuf,
    },
    /// A newer program made the database.
    #[error(
        "{path}: the database has schema {found}, this program knows schemas up to {known}. Use the newer program that wrote it."
    )]
    Newer {
        /// The database file.
        path: PathBuf,
        /// Schema version found.
        found: i64,
        /// Newest schema version known.
        known: i64,
    },
    /// The database file or its folder cannot be opened.
    #[error(
        "{path}: the database cannot be opened ({detail}). Check that the folder exists and that you may write to it."
    )]
    CannotOpen {
        /// The database file.
        path: PathBuf,
        /// What SQLite says.
        detail: String,
    },
    /// The linked SQLite has the WAL-reset corruption bug.
    #[error(
        "the linked SQLite {found} can corrupt a database in WAL mode; 3.51.3 or newer is needed. Build with the bundled SQLite."
    )]
    SqliteTooOld {
        /// Version found.
        found: &'static str,
    },
    /// The file that is open is no longer the database of the campaign.
    #[error(
        "{path}: the file was deleted or replaced while this program had it open. What was stored until then is in the file that is gone. Put that file or a backup back, with no other ieap running, then start again."
    )]
    Replaced {
        /// The database file, or its write-ahead log.
        path: PathBuf,
    },
    /// The database lies on a network share.
    #[error(
        "{path}: the campaign lies on a network file system ({kind}), where SQLite's write-ahead log is not safe. Copy the campaign to a local disk, or pass --i-know to go on at your own risk."
    )]
    NetworkShare {
        /// The database file.
        path: PathBuf,
        /// File system found.
        kind: String,
    },
    /// Another `ieap` works on this campaign.
    #[error("{path}: another ieap works on this campaign ({holder}). Wait until it is done, or stop it.")]
    SecondInstance {
        /// The lock file.
        path: PathBuf,
        /// What the lock file says of its holder.
        holder: String,
    },
    /// Something else lies where the lock file belongs.
    #[error(
        "{path}: this is not the lock file of a campaign ({found}), and it was left alone. Move it away, then run again."
    )]
    NotALock {
        /// The lock file.
        path: PathBuf,
        /// What it is.
        found: &'static str,
    },
    /// The lock file or a backup could not be written.
    #[error("{path}: {doing} failed: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What was being done.
        doing: &'static str,
        /// What the system says.
        source: std::io::Error,
    },
    /// A stored value does not read back.
    #[error(
        "the database holds a value that does not read back: {what} ({detail}). `ieap rebuild` makes it anew from archive and journal, or put a backup of campaign.db back. Without archive and journal, `ieap run --new-database` starts anew from the files in the campaign."
    )]
    BadValue {
        /// Which value.
        what: &'static str,
        /// What was found.
        detail: String,
    },
    /// Stored rows are not those that were stored.
    #[error(
        "campaign.db is damaged: {what} is not as it was stored (its checksum does not match). `ieap rebuild` makes it anew from archive and journal, or put a backup of campaign.db back. Without archive and journal, `ieap run --new-database` starts anew from the files in the campaign."
    )]
    Damaged {
        /// Which rows.
        what: String,
    },
    /// The journal has what the database lacks, and it cannot be said again now.
    #[error(
        "{path}: the database lacks what archive/journal.jsonl says: {lacks}. Nothing is read from it or written to it as it is; {why}."
    )]
    Lags {
        /// The database file.
        path: PathBuf,
        /// What, in words.
        lacks: String,
        /// What is in the way, or how to mend it.
        why: String,
    },
    /// The database and the journal say different things.
    #[error(
        "{path}: the database and archive/journal.jsonl say different things, and nothing was changed: {detail}. Decide which of the two is right and move the other away (campaign.db with campaign.db-wal, or the journal), then run `ieap rebuild`; what only the other says is to be said again."
    )]
    Parted {
        /// The database file.
        path: PathBuf,
        /// Where they part, and what each says.
        detail: String,
    },
    /// A database that was made is not what was written into it.
    #[error(
        "{path}: the new database does not read back as it was made ({detail}). The old one is as it was; make room on the disk, or use another one, then run `ieap rebuild` again."
    )]
    NotAsMade {
        /// The database file.
        path: PathBuf,
        /// What was found.
        detail: String,
    },
    /// Any other failure of SQLite.
    #[error("{path}: {doing} failed: {detail}")]
    Sql {
        /// The database file.
        path: PathBuf,
        /// What was being done.
        doing: &'static str,
        /// What SQLite says.
        detail: String,
    },
}

impl StoreError {
    /// Whether trying again cannot help: the database is gone, damaged, or of another program.
    pub fn is_for_good(&self) -> bool {
        use StoreError as E;
        matches!(
            self,
            E::NotADatabase { .. }
                | E::NoVersion { .. }
                | E::ChangedSchema { .. }
                | E::NotALock { .. }
                | E::Older { .. }
                | E::Newer { .. }
                | E::Replaced { .. }
                | E::Damaged { .. }
                | E::BadValue { .. }
                | E::Lags { .. }
                | E::Parted { .. }
        )
    }

    /// Names what was being done with the database at `path` when SQLite failed.
    pub(super) fn from_sql(
        path: &std::path::Path,
        doing: &'static str,
        source: rusqlite::Error,
    ) -> StoreError {
        let path = path.to_owned();
        let detail = || plain(&source);
        match source.sqlite_error_code() {
            // SQLite takes a lock that the file system does not have for one that somebody holds.
            Some(code) if may_be_without_locks(code) && locks::lacking_beside(&path).is_some() => {
                let detail = locks::lacking_beside(&path).unwrap_or_default();
                StoreError::NoLocks { path, detail }
            }
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => StoreError::Locked { path, doing },
            Some(ErrorCode::ReadOnly | ErrorCode::PermissionDenied) => StoreError::ReadOnly { path, doing },
            Some(ErrorCode::DiskFull) => StoreError::DiskFull { path, doing },
            // Where SQLite's shared memory cannot grow, it says no more than that the disk failed.
            Some(ErrorCode::SystemIoFailure) if is_full(&path) => StoreError::DiskFull { path, doing },
            Some(ErrorCode::NotADatabase | ErrorCode::DatabaseCorrupt) => StoreError::NotADatabase {
                path,
                detail: detail(),
            },
            Some(ErrorCode::CannotOpen) => StoreError::CannotOpen {
                path,
                detail: detail(),
            },
            _ => StoreError::Sql {
                path,
                doing,
                detail: detail(),
            },
        }
    }
}

fn may_be_without_locks(code: ErrorCode) -> bool {
    use ErrorCode as E;
    matches!(
        code,
        E::DatabaseBusy | E::DatabaseLocked | E::SystemIoFailure | E::FileLockingProtocolFailed
    )
}

/// What SQLite says, without the statement that it says it of: a page of SQL helps no user.
pub(super) fn plain(error: &rusqlite::Error) -> String {
    match error {
        rusqlite::Error::SqlInputError { msg, .. } => msg.clone(),
        other => other.to_string(),
    }
}

/// Room below which a disk counts as full, bytes: a step of SQLite's log with its index takes less.
#[cfg(unix)]
const FULL_BELOW_BYTES: u64 = 256 * 1024;

/// Whether the disk that a file lies on has no room left.
#[cfg(unix)]
fn is_full(file: &std::path::Path) -> bool {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let found = rustix::fs::statvfs(folder.unwrap_or(std::path::Path::new(".")));
    found.is_ok_and(|disk| disk.f_bavail.saturating_mul(disk.f_frsize) < FULL_BELOW_BYTES)
}

#[cfg(not(unix))]
fn is_full(_file: &std::path::Path) -> bool {
    false
}

/// A failure inside a transaction, before the step's name is added.
pub(super) enum StepError {
    Sql(rusqlite::Error),
    Store(StoreError),
}

/// Names what was being done with the database at `path` when a step failed.
pub(super) fn named<'a>(
    path: &'a std::path::Path,
    doing: &'static str,
) -> impl Fn(StepError) -> StoreError + use<'a> {
    move |error| match error {
        StepError::Sql(error) => StoreError::from_sql(path, doing, error),
        StepError::Store(error) => error,
    }
}

impl From<rusqlite::Error> for StepError {
    fn from(error: rusqlite::Error) -> StepError {
        StepError::Sql(error)
    }
}

impl From<StoreError> for StepError {
    fn from(error: StoreError) -> StepError {
        StepError::Store(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_statement_that_fails_is_not_printed() {
        let connection = rusqlite::Connection::open_in_memory().unwrap();
        let error = connection
            .execute("INSERT INTO missing SELECT 1", [])
            .unwrap_err();
        let told = StoreError::from_sql(std::path::Path::new("c/campaign.db"), "storing", error);
        assert_eq!(
            told.to_string(),
            "c/campaign.db: storing failed: no such table: missing"
        );
    }
}
