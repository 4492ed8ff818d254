//! Why the database and the archive of a campaign are not worked on.

use std::path::PathBuf;

use thiserror::Error;

/// Why a campaign is not worked on as it stands.
#[derive(Debug, Error)]
pub enum HoldingsError {
    /// There was a database.
    #[error(
        "{}: {found}, but {evidence}, so this campaign had a database. `ieap rebuild` makes it anew from archive and journal, with tags set by hand, dropped runs and deleted files; or put a backup of it back. Without archive and journal, `ieap run --new-database` makes one from the files in the campaign alone.", path.display()
    )]
    DatabaseLost {
        /// Where it should be.
        path: PathBuf,
        /// What is there.
        found: String,
        /// What says that there was one.
        evidence: String,
    },
    /// There was an archive.
    #[error(
        "{}: the archive with the raw files is not there, or not all of it: archive/database-id is missing, and {lacks}. Mount its disk, or put the archive back from a backup. If there is none, `ieap run --new-archive` makes a new one from the files that still lie in the campaign.", path.display()
    )]
    ArchiveLost {
        /// Where it should be.
        path: PathBuf,
        /// What is not there.
        lacks: String,
    },
    /// A database of an earlier version cannot be made anew without a loss.
    #[error(
        "{}: an earlier version of the program made the database, and it would be made anew from the archive, which is not whole: {lacks}. Nothing was changed. Mount the disk of archive/, or put it back from a backup, then run again. If it is lost, `ieap rebuild` makes the database of what is left, names what did not come back, and keeps the old one.", path.display()
    )]
    LossAhead {
        /// The database file.
        path: PathBuf,
        /// What is not there.
        lacks: String,
    },
    /// Database and archive are of two campaigns.
    #[error(
        "{}: the database has the id {found}, the archive beside it belongs to the database {needed} (archive/database-id). Put the database and the archive back that belong together. If these two are meant to be one campaign from now on, delete archive/database-id and move archive/journal.jsonl away.", path.display()
    )]
    Foreign {
        /// The database file.
        path: PathBuf,
        /// Its id.
        found: String,
        /// The id that the archive states.
        needed: String,
    },
}
