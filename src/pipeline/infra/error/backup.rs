//! Why there is no backup, or why one is not restored.

use std::path::PathBuf;

use thiserror::Error;

/// Name of the list that is a backup.
pub const FILE_NAME: &str = "backup.json";

/// Why a campaign is not backed up or restored. Every text says what to do.
#[derive(Debug, Error)]
pub enum BackupError {
    /// The backup would be lost with the campaign.
    #[error("{}: lies in the campaign, so that both would be lost together. Name a folder elsewhere, best on another disk.", folder.display())]
    InsideCampaign {
        /// The folder named.
        folder: PathBuf,
    },
    /// The folder holds something else.
    #[error("{}: holds {found} and no backup; nothing in it was touched. Name a new or an empty folder.", folder.display())]
    NotABackup {
        /// The folder named.
        folder: PathBuf,
        /// Something that is in it.
        found: String,
    },
    /// The backup is that of another campaign.
    #[error("{}: is the backup of another database ({found}; this campaign's is {needed}), and was not touched. Name another folder. A campaign that got a new database needs a new backup, and the old one still has what only the old database held.", folder.display())]
    OfAnother {
        /// The folder named.
        folder: PathBuf,
        /// Id of the database that it is of.
        found: String,
        /// Id of the campaign's database.
        needed: String,
    },
    /// Nothing was stored yet.
    #[error("{}: there is no database yet, so that there is nothing to back up. `ieap run` makes one.", folder.display())]
    NoDatabase {
        /// The campaign folder.
        folder: PathBuf,
    },
    /// The database itself is damaged.
    #[error("the database is damaged: {detail}. The backup in {} was not changed and is as it was before. To go back to it: `ieap restore BACKUP NEW_FOLDER`.", folder.display())]
    DatabaseDamaged {
        /// The backup folder.
        folder: PathBuf,
        /// What is wrong with it.
        detail: String,
    },
    /// The words are not all that was said.
    #[error(
        "{path}: {detail}. The backup was not changed and is as it was before. Where the database is sound, move the file away: the next `ieap run` writes it from there, and then `ieap backup` goes on. To keep both, name another folder."
    )]
    Words {
        /// The journal.
        path: String,
        /// What it lacks.
        detail: String,
    },
    /// A file that was just written does not read back.
    #[error("{}: {path} does not read back as it was written: the disk, the cable or the memory is failing. The backup was not finished, and is as it was before. Try another disk.", folder.display())]
    NotAsWritten {
        /// The backup folder.
        folder: PathBuf,
        /// The file.
        path: String,
    },
    /// There is no backup in the folder.
    #[error("{}: there is no finished backup ({}) in it. Name the folder that was given to `ieap backup`.", folder.display(), FILE_NAME)]
    NoBackup {
        /// The folder named.
        folder: PathBuf,
    },
    /// The list of what the backup holds is damaged.
    #[error("{}: the list is damaged ({detail}), so that it is not known what that backup holds. If the campaign is still there, `ieap backup` into the same folder writes a new one. If not, the raw files lie in `archive/` of the backup under their hashes, and the database beside them.", path.display())]
    DamagedManifest {
        /// The list.
        path: PathBuf,
        /// What is wrong.
        detail: String,
    },
    /// The list names what would not lie in the restored folder.
    #[error("{}: the list names {count} files that would not lie in the restored folder: {first}. No `ieap backup` writes such a list: it was changed. Nothing was written. If the campaign is still there, `ieap backup` into the same folder writes a new list. If it is not, `ieap restore --damaged` restores the other files and lists these.", path.display())]
    OutOfPlace {
        /// The list.
        path: PathBuf,
        /// How many files.
        count: usize,
        /// The first of them, with the reason.
        first: String,
    },
    /// Files of the backup are missing or have other bytes.
    #[error("{}: {count} of its files are missing or damaged: {first}. Nothing was restored. If the campaign is still there, delete these files of the backup, and `ieap backup` copies them again. If it is not, `ieap restore --damaged` restores what is whole and lists the rest.", folder.display())]
    Damaged {
        /// The backup folder.
        folder: PathBuf,
        /// How many files.
        count: usize,
        /// The first of them, by the names that they have in the campaign.
        first: String,
    },
    /// The new folder is not empty.
    #[error("{}: {found}, and nothing in it was touched. Name a folder that does not exist yet.", folder.display())]
    NotEmpty {
        /// The folder named.
        folder: PathBuf,
        /// What it is.
        found: &'static str,
    },
    /// What was restored is not what was backed up.
    #[error("what was restored does not hold: {detail}. It was removed again; the backup was not touched.")]
    DrillFailed {
        /// What is wrong.
        detail: String,
    },
}

impl BackupError {
    /// Whether the user named a wrong folder, rather than a disk or a database being at fault.
    pub fn is_usage(&self) -> bool {
        use BackupError as E;
        matches!(
            self,
            E::InsideCampaign { .. }
                | E::NotABackup { .. }
                | E::OfAnother { .. }
                | E::NoDatabase { .. }
                | E::NoBackup { .. }
                | E::NotEmpty { .. }
        )
    }
}
