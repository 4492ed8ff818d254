//! Restores a backup into a new folder, and tries what was restored before it gets its name.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use serde::Serialize;

use super::error::BackupError;
use super::manifest::{LeftOut, Manifest, StoredFile};
use super::shelf::{failed, hash_of, sync_names};
use crate::ingest::archive::Archive;
use crate::ingest::scan::parse_display_path;
use crate::pipeline::status::{self, Status};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::FILE_NAME as DATABASE_NAME;
use crate::system::fs;

/// The verb `restore`.
#[derive(Debug, Clone)]
pub struct Restore {
    /// Folder of the backup.
    pub backup: PathBuf,
    /// Folder of the campaign to be: not there yet, or empty.
    pub folder: PathBuf,
    /// Whether a damaged backup is restored as far as it is whole.
    pub damaged: bool,
}

/// What `restore` did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Restored {
    /// The campaign folder.
    pub folder: PathBuf,
    /// When the backup was made, RFC 3339 UTC.
    pub made_at: String,
    /// Files that were restored, with the database.
    pub files: usize,
    /// Current runs in the restored database; none where the database could not be restored.
    pub runs: Option<usize>,
    /// What the backup does not hold, and said so when it was made.
    pub left_out: Vec<LeftOut>,
    /// What was damaged or missing in the backup and is not there now.
    pub lost: Vec<LeftOut>,
}

impl Restore {
    /// Copies every file, each held against its hash, into a folder beside the new one, opens the campaign there and looks
    /// it through as `status` does, and gives the folder its name.
    ///
    /// # Errors
    /// There is no backup, it is damaged, the new folder is not empty, the result does not hold, or a disk refuses.
    /// Nothing is left then.
    pub fn run(&self, observer: &dyn Observer) -> Result<Restored, PipelineError> {
        let Some(manifest) = Manifest::read(&self.backup)? else {
            return Err(BackupError::NoBackup {
                folder: self.backup.clone(),
            }
            .into());
        };
        refuse_filled(&self.folder)?;
        let parent = std::path::absolute(&self.folder)
            .ok()
            .and_then(|path| path.parent().map(Path::to_owned))
            .unwrap_or_else(|| PathBuf::from("."));
        fs::create_dir_all(&parent).map_err(failed(&parent, "making the folder"))?;
        // It goes again where anything fails.
        let making = tempfile::Builder::new()
            .prefix(".ieap-restoring-")
            .tempdir_in(&parent)
            .map_err(failed(&parent, "making a folder"))?;
        let mut lost = self.copy_all(&manifest, making.path(), observer)?;
        if let (false, Some(first)) = (self.damaged, lost.first()) {
            return Err(BackupError::Damaged {
                folder: self.backup.clone(),
                count: lost.len(),
                first: format!("{} ({})", first.path, first.reason),
            }
            .into());
        }
        let files = manifest.files.len() + 1 - lost.len();
        let has_database = !lost.iter().any(|lost| lost.path == DATABASE_NAME);
        let runs = match has_database {
            true => {
                Archive::new(making.path()).set_owner(&manifest.database_id)?;
                Some(drill(making.path(), &manifest, &mut lost, self.damaged)?)
            }
            false => None,
        };
        sync(making.path());
        self.put(making)?;
        Ok(Restored {
            folder: self.folder.clone(),
            files,
            made_at: manifest.made_at,
            runs,
            left_out: manifest.left_out,
            lost,
        })
    }

    /// Copies every file; gives those that are not as they were backed up.
    fn copy_all(
        &self,
        manifest: &Manifest,
        into: &Path,
        observer: &dyn Observer,
    ) -> Result<Vec<LeftOut>, PipelineError> {
        let archive = Archive::new(&self.backup);
        let mut lost = Vec::new();
        observer.begin("restoring", manifest.files.len() as u64 + 1);
        for file in &manifest.files {
            crate::numerics::interrupt::check();
            match archive.read(&file.blake3) {
                Ok(bytes) => write(into, file, &bytes)?,
                Err(error) => lost.push(LeftOut {
                    path: file.path.clone(),
                    reason: error.to_string(),
                }),
            }
            observer.advance();
        }
        lost.extend(self.copy_database(&manifest.database, into)?);
        observer.end();
        Ok(lost)
    }

    fn copy_database(&self, database: &StoredFile, into: &Path) -> Result<Option<LeftOut>, PipelineError> {
        let (from, to) = (self.backup.join(&database.path), into.join(DATABASE_NAME));
        let lost = |reason: String| {
            Some(LeftOut {
                path: DATABASE_NAME.to_owned(),
                reason,
            })
        };
        if let Err(error) = fs::metadata(&from) {
            return Ok(lost(format!("{}: {error}", database.path)));
        }
        fs::copy(&from, &to).map_err(failed(&to, "copying the database"))?;
        let (found, _) = hash_of(&to).map_err(failed(&to, "reading what was copied"))?;
        match found == database.blake3 {
            true => Ok(None),
            false => {
                fs::remove_file(&to).map_err(failed(&to, "removing"))?;
                Ok(lost(format!("{}: its bytes hash to {found}", database.path)))
            }
        }
    }

    /// Gives the folder its name.
    fn put(&self, making: tempfile::TempDir) -> Result<(), PipelineError> {
        let failed = failed(&self.folder, "putting the restored campaign in place");
        let place = || {
            readable(making.path())?;
            if self.folder.exists() {
                fs::remove_dir(&self.folder)?;
            }
            fs::rename(making.path(), &self.folder)?;
            let above = making.path().parent().unwrap_or(Path::new("."));
            sync_names(above)
        };
        place().map_err(failed)?;
        // It has another name now, under which nothing removes it.
        let _ = making.keep();
        Ok(())
    }
}

/// Refuses a folder that holds something.
fn refuse_filled(folder: &Path) -> Result<(), PipelineError> {
    let is_free = match fs::read_dir(folder) {
        Ok(mut entries) => entries.next().is_none(),
        Err(error) => error.kind() == std::io::ErrorKind::NotFound,
    };
    match is_free {
        true => Ok(()),
        false => Err(BackupError::NotEmpty {
            folder: folder.to_owned(),
        }
        .into()),
    }
}

/// Writes a file of the campaign, with its time where that is known.
fn write(into: &Path, file: &StoredFile, bytes: &[u8]) -> Result<(), PipelineError> {
    let path = into.join(parse_display_path(&file.path));
    let write = || {
        fs::create_dir_all(path.parent().unwrap_or(into))?;
        let mut options = fs::OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        if is_raw(&file.path) {
            // Raw files are for everyone to read and for nobody to change.
            options.mode(0o444);
        }
        let mut out = options.open(&path)?;
        out.write_all(bytes)?;
        match u64::try_from(file.modified_ns) {
            Ok(0) | Err(_) => Ok(()),
            Ok(after) => out.set_modified(SystemTime::UNIX_EPOCH + Duration::from_nanos(after)),
        }
    };
    write().map_err(failed(&path, "writing"))
}

#[cfg(unix)]
fn is_raw(path: &str) -> bool {
    path.starts_with("archive/") && !path.ends_with(super::JOURNAL)
}

/// Opens what was restored and looks it through; gives the number of current runs.
fn drill(
    folder: &Path,
    manifest: &Manifest,
    lost: &mut Vec<LeftOut>,
    damaged: bool,
) -> Result<usize, PipelineError> {
    let fails = |detail: String| BackupError::DrillFailed { detail };
    let status: Status = {
        let context = Context::open_as_it_is(folder)?;
        if let Some(detail) = context.store.check_all()?.into_iter().next() {
            return Err(fails(detail).into());
        }
        let changes = context.store.changes()?.0;
        if changes != manifest.changes {
            let detail = format!(
                "the database has seen {changes} changes, {} were backed up",
                manifest.changes
            );
            return Err(fails(detail).into());
        }
        let runs = folder.join(&context.campaign.runs_folder);
        // It may have been empty, and a campaign without it would wait for a disk.
        fs::create_dir_all(&runs).map_err(failed(&runs, "making the folder of runs"))?;
        status::status(&context)?
    };
    let unknown = status.raw_files_lost.iter().filter(|raw| {
        !manifest
            .left_out
            .iter()
            .any(|left| raw.issues.iter().any(|issue| issue.place == left.path))
    });
    for raw in unknown {
        match damaged {
            true => lost.push(super::contents::reason(
                &raw.path,
                "its raw file is not in the archive",
            )),
            false => return Err(fails(format!("the raw file of {} is not in the archive", raw.path)).into()),
        }
    }
    lost.sort();
    lost.dedup_by(|a, b| a.path == b.path);
    // SQLite's companions of a database that was only read.
    for companion in ["-wal", "-shm"] {
        let _ = fs::remove_file(folder.join(format!("{DATABASE_NAME}{companion}")));
    }
    Ok(status.runs)
}

/// Brings everything to the disk before it gets its name.
fn sync(folder: &Path) {
    #[cfg(target_os = "linux")]
    if let Ok(folder) = fs::File::open(folder) {
        let _ = folder.sync_file_system();
    }
    #[cfg(not(target_os = "linux"))]
    let _ = folder;
}

/// Gives a temporary folder, which is its owner's alone, the rights of any other.
#[cfg(unix)]
fn readable(folder: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(folder, fs::Permissions::from_mode(0o755))
}

#[cfg(not(unix))]
fn readable(_folder: &Path) -> std::io::Result<()> {
    Ok(())
}
