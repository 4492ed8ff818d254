//! Why the archive could not do what was asked.

use std::io;
use std::path::{Path, PathBuf};

/// Why the archive could not do what was asked.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// No room is left.
    #[error("{}: the disk is full: {needed_bytes} bytes could not be stored ({source}); make room, then run again: nothing is lost and no half file is left", path.display())]
    DiskFull {
        /// The file that was to be written.
        path: PathBuf,
        /// Its size.
        needed_bytes: u64,
        /// What the operating system said.
        source: io::Error,
    },
    /// No right to write or read there.
    #[error("{}: no right to {doing} ({source}); give your user the right to the campaign's archive folder", path.display())]
    Denied {
        /// The file or folder.
        path: PathBuf,
        /// `write`, `read`, ...
        doing: &'static str,
        /// What the operating system said.
        source: io::Error,
    },
    /// The disk or the share failed.
    #[error("{}: could not {doing} ({source}); check the disk or share, then run again", path.display())]
    Failed {
        /// The file or folder.
        path: PathBuf,
        /// `write`, `read`, ...
        doing: &'static str,
        /// What the operating system said.
        source: io::Error,
    },
    /// No file of that hash.
    #[error("{}: no raw file with the hash {hash}; bring it back from a backup, or put the original file into the runs folder again", folder.display())]
    Absent {
        /// Folder where it was looked for.
        folder: PathBuf,
        /// The hash.
        hash: String,
    },
    /// The bytes are not those that were stored.
    #[error("{}: damaged: its bytes hash to {found}; replace it from a backup, or put the original file into the runs folder again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The hash of what is there.
        found: String,
    },
    /// The text is no hash.
    #[error("\"{found}\" is no hash: 64 digits 0-9 a-f are needed")]
    NotAHash {
        /// What was given.
        found: String,
    },
}

/// The refusal of the operating system, sorted by what the user can do about it.
pub(super) fn sorted(path: &Path, doing: &'static str, needed_bytes: u64, source: io::Error) -> ArchiveError {
    let path = path.to_path_buf();
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
            ArchiveError::DiskFull {
                path,
                needed_bytes,
                source,
            }
        }
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            ArchiveError::Denied { path, doing, source }
        }
        _ => ArchiveError::Failed { path, doing, source },
    }
}
