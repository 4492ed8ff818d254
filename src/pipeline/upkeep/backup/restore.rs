//! Restores a backup into a new folder, and tries what was restored before it gets its name.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use schemars::JsonSchema;
use serde::Serialize;

use super::blobs::{DATABASE, is_database};
use super::contents::reason;
use super::making::Making;
use super::manifest::{FILE_NAME, JOURNAL, LeftOut, Manifest, StoredFile};
use super::place::place;
use super::words;
use crate::ingest::archive::{Archive, hash_of_file};
use crate::ingest::campaign_file;
use crate::pipeline::infra::error::BackupError;
use crate::pipeline::upkeep::verify::archive::wanted;
use crate::pipeline::{Observer, PipelineError, failed};
use crate::store::{FILE_NAME as DATABASE_NAME, Store};
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
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Restored {
    /// The campaign folder.
    pub folder: PathBuf,
    /// When the backup was made, RFC 3339 UTC.
    pub made_at: String,
    /// Files that were restored, with the database.
    pub files: usize,
    /// Current runs, spectra and modulus logs in the restored database; none where the database could not be restored.
    pub runs: Option<usize>,
    /// What the backup does not hold, and said so when it was made.
    pub left_out: Vec<LeftOut>,
    /// What was damaged or missing in the backup and is not there now.
    pub lost: Vec<LeftOut>,
}

impl Restore {
    /// Copies every file, each held against its hash, into a folder beside the new one, looks through what is there then, and
    /// gives the folder its name. What campaign.toml says is not asked.
    ///
    /// # Errors
    /// There is no backup, it is damaged, the new folder is not empty, the result does not hold, or a disk refuses.
    /// Nothing is left then.
    pub fn run(&self, observer: &dyn Observer) -> Result<Restored, PipelineError> {
        let backup = self.backup.as_path();
        let Some(manifest) = Manifest::read(backup)? else {
            let folder = backup.to_owned();
            return Err(BackupError::NoBackup { folder }.into());
        };
        // Before anything is written.
        let (placed, mut lost) = places(&manifest);
        if let (false, Some(first)) = (self.damaged, lost.first()) {
            return Err(BackupError::OutOfPlace {
                path: backup.join(FILE_NAME),
                count: lost.len(),
                first: told(first),
            }
            .into());
        }
        refuse_filled(&self.folder)?;
        let making = self.begin()?;
        lost.extend(copy_all(backup, &placed, making.path(), observer)?);
        if !lost.iter().any(|lost| lost.path == DATABASE_NAME) {
            lost.extend(copy_database(backup, &manifest.database, making.path())?);
        }
        observer.end();
        if let (false, Some(first)) = (self.damaged, lost.first()) {
            return Err(BackupError::Damaged {
                folder: backup.to_owned(),
                count: lost.len(),
                first: told(first),
            }
            .into());
        }
        let files = manifest.files.len() + 1 - lost.len();
        let has_database = !lost.iter().any(|lost| lost.path == DATABASE_NAME);
        let runs = if has_database {
            Archive::new(making.path()).set_owner(&manifest.database_id)?;
            Some(drill(making.path(), &manifest, &mut lost, self.damaged)?)
        } else {
            None
        };
        sync(making.path()).map_err(failed(
            making.path(),
            "bringing the restored campaign to the disk",
        ))?;
        let placed = making.put(&self.folder);
        placed.map_err(failed(&self.folder, "putting the restored campaign in place"))?;
        Ok(Restored {
            folder: self.folder.clone(),
            files,
            made_at: manifest.made_at,
            runs,
            left_out: manifest.left_out,
            lost,
        })
    }

    /// Makes a folder beside the one to be; it goes again where anything fails.
    fn begin(&self) -> Result<Making, PipelineError> {
        let parent = std::path::absolute(&self.folder)
            .ok()
            .and_then(|path| path.parent().map(Path::to_owned))
            .unwrap_or_else(|| PathBuf::from("."));
        fs::create_dir_all(&parent).map_err(failed(&parent, "making the folder"))?;
        Making::begin(&parent).map_err(failed(&parent, "making a folder"))
    }
}

fn told(left: &LeftOut) -> String {
    format!("{} ({})", left.path, left.reason)
}

/// Where each file of a list goes; and those that have no place in a campaign, with the reason.
fn places(list: &Manifest) -> (Vec<(PathBuf, &StoredFile)>, Vec<LeftOut>) {
    let (mut placed, mut taken, mut refused) = (Vec::new(), BTreeSet::new(), Vec::new());
    for file in &list.files {
        match place(&file.path) {
            Err(why) => refused.push(reason(&file.path, why)),
            Ok(path) if !taken.insert(path.clone()) => refused.push(reason(&file.path, "it is named twice")),
            Ok(path) => placed.push((path, file)),
        }
    }
    let database = &list.database;
    if !is_database(&database.path) || database.path != format!("{DATABASE}{}", database.blake3) {
        let said = format!("{} is no copy of a database", database.path);
        refused.push(reason(DATABASE_NAME, &said));
    }
    (placed, refused)
}

/// Copies files; gives those that are not as they were backed up.
fn copy_all(
    backup: &Path,
    placed: &[(PathBuf, &StoredFile)],
    into: &Path,
    observer: &dyn Observer,
) -> Result<Vec<LeftOut>, PipelineError> {
    let archive = Archive::new(backup);
    let mut lost = Vec::new();
    observer.begin("restoring", placed.len() as u64 + 1);
    for (path, file) in placed {
        crate::numerics::interrupt::check();
        match archive.read(&file.blake3) {
            Ok(bytes) => write(into, path, file, &bytes)?,
            Err(error) => lost.push(reason(&file.path, &error.to_string())),
        }
        observer.advance();
    }
    Ok(lost)
}

/// Copies the database; gives it where it is not as it was backed up.
fn copy_database(
    backup: &Path,
    database: &StoredFile,
    into: &Path,
) -> Result<Option<LeftOut>, PipelineError> {
    let (from, to) = (backup.join(&database.path), into.join(DATABASE_NAME));
    let lost = |said: String| Ok(Some(reason(DATABASE_NAME, &format!("{}: {said}", database.path))));
    let mut source = match fs::File::open_own(&from) {
        Ok(source) => source,
        Err(error) => return lost(error.to_string()),
    };
    let mut options = fs::OpenOptions::own();
    let copied = options.write(true).create_new(true).open(&to);
    let copied = copied.and_then(|mut copy| std::io::copy(&mut source, &mut copy));
    copied.map_err(failed(&to, "copying the database"))?;
    let (found, _) = hash_of_file(&to).map_err(failed(&to, "reading what was copied"))?;
    if found == database.blake3 {
        return Ok(None);
    }
    fs::remove_file(&to).map_err(failed(&to, "removing"))?;
    lost(format!("its bytes hash to {found}"))
}

/// Refuses a folder that holds something, and what is no folder.
fn refuse_filled(folder: &Path) -> Result<(), PipelineError> {
    let found = match fs::symlink_metadata(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Ok(found) if found.is_symlink() => "it is a link to another place",
        Ok(found) if !found.is_dir() => "it is no folder",
        _ => match fs::read_dir(folder).map(|mut entries| entries.next().is_none()) {
            Ok(true) => return Ok(()),
            _ => "it is not empty",
        },
    };
    let folder = folder.to_owned();
    Err(BackupError::NotEmpty { folder, found }.into())
}

/// Writes a file of the campaign, with its time where that is known.
fn write(into: &Path, place: &Path, file: &StoredFile, bytes: &[u8]) -> Result<(), PipelineError> {
    let path = into.join(place);
    let write = || {
        fs::create_dir_all(path.parent().unwrap_or(into))?;
        let mut options = fs::OpenOptions::own();
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
    path.starts_with("archive/") && path != JOURNAL
}

/// Looks through what was restored: every checksum of the database, whether words and raw files hold what it names; gives the
/// number of current runs.
fn drill(
    folder: &Path,
    manifest: &Manifest,
    lost: &mut Vec<LeftOut>,
    damaged: bool,
) -> Result<usize, PipelineError> {
    let fails = |detail: String| PipelineError::from(BackupError::DrillFailed { detail });
    let store = Store::open_copy(&folder.join(DATABASE_NAME))?;
    if let Some(detail) = store.check_all()?.into_iter().next() {
        return Err(fails(detail));
    }
    let changes = store.changes()?.0;
    if changes != manifest.changes {
        return Err(fails(format!(
            "the database has seen {changes} changes, {} were backed up",
            manifest.changes
        )));
    }
    let is_lost = |path: &str, lost: &[LeftOut]| lost.iter().any(|lost| lost.path == path);
    if let Some(detail) =
        words::what_they_lack(&words::of(folder)?, &store)?.filter(|_| !is_lost(JOURNAL, lost))
    {
        return Err(fails(format!("{JOURNAL}: {detail}")));
    }
    for missing in Archive::new(folder).missing(&wanted(&store.contents()?))? {
        let path = missing.wanted.path;
        if manifest.left_out.iter().any(|left| left.path == path) || is_lost(&path, lost) {
            continue;
        }
        if !damaged {
            return Err(fails(format!("the raw file {path} is not in the archive")));
        }
        lost.push(reason(&path, "the raw file is not in the archive"));
    }
    lost.sort();
    lost.dedup_by(|a, b| a.path == b.path);
    // It may have been empty, and a campaign without it would wait for a disk.
    if let Ok(stated) = campaign_file::read(folder) {
        let runs = folder.join(&stated.campaign.runs_folder);
        fs::create_dir_all(&runs).map_err(failed(&runs, "making the folder of runs"))?;
    }
    Ok(store.run_names()?.len())
}

/// Brings everything to the disk before it gets its name.
#[cfg(target_os = "linux")]
fn sync(folder: &Path) -> std::io::Result<()> {
    fs::File::open(folder)?.sync_file_system()
}

/// The same where a system has no call for all of it.
#[cfg(not(target_os = "linux"))]
fn sync(folder: &Path) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            sync(&path)?;
        } else {
            fs::File::open_own(&path)?.sync_all()?;
        }
    }
    fs::sync_names(folder)
}
