//! The folder that a database is made in before it takes the place of the old one.

use std::io;
use std::path::{Path, PathBuf};

use crate::pipeline::{PipelineError, failed};
use crate::store::FILE_NAME;
use crate::system::fs;
use crate::system::passing::Passing;

/// Its name inside a campaign; hidden, so that no scan takes it for data.
const FOLDER: &str = ".ieap-rebuild";

/// Where it is.
pub fn path_in(campaign: &Path) -> PathBuf {
    campaign.join(FOLDER)
}

/// The folder, empty: what a rebuilding that was cut short left in it is removed.
///
/// # Errors
/// It holds something else, or cannot be made.
pub fn emptied(campaign: &Path) -> Result<Passing, PipelineError> {
    remove(campaign)?;
    let folder = path_in(campaign);
    let made = Passing::made(|| fs::create_dir(&folder), |()| folder.clone());
    let ((), passing) = made.map_err(failed(&folder, "making the folder"))?;
    Ok(passing)
}

/// Removes the folder with the database in it, and nothing else.
///
/// # Errors
/// It holds something else, or the system refuses.
pub fn remove(campaign: &Path) -> Result<(), PipelineError> {
    let folder = path_in(campaign);
    for companion in ["", "-wal", "-shm"] {
        let file = folder.join(format!("{FILE_NAME}{companion}"));
        match fs::remove_file(&file) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(failed(&file, "removing")(error));
            }
            _ => {}
        }
    }
    match fs::remove_dir(&folder) {
        Err(error) if error.kind() == io::ErrorKind::DirectoryNotEmpty => Err(PipelineError::NotOurs {
            found: folder.clone(),
            folder,
        }),
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(failed(&folder, "removing")(error)),
        _ => Ok(()),
    }
}

/// Removes what a rebuilding that did not end left, where the campaign has its database: else what was made may be needed.
/// Whoever asks holds the lock. What stays for a reason of the system, or because it holds something else, the next
/// rebuilding tells.
pub fn clear(campaign: &Path) {
    if fs::symlink_metadata(campaign.join(FILE_NAME)).is_ok() {
        let _ = remove(campaign);
    }
}
