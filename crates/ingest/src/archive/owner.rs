//! Which database an archive belongs to: `archive/database-id`.

use std::io::{self, Write};

use super::error::{ArchiveError, sorted};
use super::{Archive, FOLDER, PARTIAL, folders, list};
use ieap_system::{Temporary, fs};

/// Name of the file inside the archive.
const OWNER: &str = "database-id";

impl Archive {
    /// The id of the database that the archive belongs to; none where nothing says it.
    ///
    /// # Errors
    /// Where the file is there and cannot be read.
    pub fn owner(&self) -> Result<Option<String>, ArchiveError> {
        let path = self.campaign.join(FOLDER).join(OWNER);
        match fs::read_own_text(&path) {
            Ok(text) => Ok(text.split_whitespace().next().map(str::to_owned)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(sorted(&path, "read", 0, source)),
        }
    }

    /// Writes down which database the archive belongs to; the folder is made where it is not there.
    ///
    /// # Errors
    /// Where there is no room, no right, or the disk fails.
    pub fn set_owner(&self, id: &str) -> Result<(), ArchiveError> {
        let folder = self.campaign.join(FOLDER);
        let path = folder.join(OWNER);
        let failed = |source| sorted(&path, "write", 0, source);
        fs::create_dir_all(&folder).map_err(failed)?;
        let mut file = Temporary::new_in(&folder, PARTIAL, "", 0o644).map_err(failed)?;
        let text =
            format!("{id}\nThis archive belongs to the campaign.db with this id. Keep them together.\n");
        file.write_all(text.as_bytes())
            .and_then(|()| file.sync_all())
            .map_err(failed)?;
        file.persist(&path).map_err(failed)?;
        fs::sync_names(&folder).map_err(failed)
    }

    /// Whether the archive holds a raw file.
    ///
    /// # Errors
    /// Where a folder cannot be read.
    pub fn holds_anything(&self) -> Result<bool, ArchiveError> {
        for folder in folders(&self.campaign.join(FOLDER))? {
            if list(&folder)?
                .iter()
                .any(|path| path.file_name().and_then(super::hash_in_name).is_some())
            {
                return Ok(true);
            }
        }
        Ok(false)
    }
}
