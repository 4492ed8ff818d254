//! Backups: a copy of a campaign in a folder elsewhere, made while everything runs, and restored into a new folder.
//!
//! All bytes but those of the database lie under their hashes, so that a second backup copies what is new and nothing can
//! be half-changed: the list of what belongs to the backup, written last and in one step, is the backup. The database is
//! copied first: the archive holds whatever it names, since raw files are archived before the database names them.

mod contents;
mod error;
pub mod manifest;
mod restore;
mod shelf;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::context::now;
use super::{Context, Observer, PipelineError};
use crate::ingest::archive::{self, Archive, FOLDER};
use crate::numerics::interrupt;
use crate::store::{Found, Store, found};
use crate::system::fs;
use contents::{Wanted, listed, reason};
use manifest::{Head, LeftOut, Manifest, StoredFile};
use shelf::{DATABASE, Shelf, UNFINISHED, failed, hash_of, sync_names};

pub use error::BackupError;
pub use restore::{Restore, Restored};

/// What no file holds, one JSON document a line, inside the archive: it is only ever appended to.
const JOURNAL: &str = "journal.jsonl";
/// Largest file that is read into a backup, bytes: none that is taken in is larger.
const LARGEST_FILE_BYTES: u64 = 1 << 30;

/// The verb `backup`.
#[derive(Debug, Clone)]
pub struct Backup {
    /// Folder of the backup.
    pub folder: PathBuf,
    /// Whether every file that is there already is read and held against its hash; a damaged one is copied again.
    pub deep: bool,
}

/// What `backup` did.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BackedUp {
    /// Folder of the backup.
    pub folder: PathBuf,
    /// When it was made, RFC 3339 UTC.
    pub made_at: String,
    /// Files of the backup, the database not counted.
    pub files: usize,
    /// Size of the database, bytes.
    pub database_bytes: u64,
    /// Files that were not there yet and were copied, the database not counted.
    pub copied: usize,
    /// Their size, bytes.
    pub copied_bytes: u64,
    /// Files of the backup that were damaged and are whole again.
    pub mended: usize,
    /// What is not in the backup, with the reason.
    pub left_out: Vec<LeftOut>,
}

impl Backup {
    /// Makes the backup, or brings it up to date. Until its last step the earlier one holds.
    ///
    /// # Errors
    /// The folder is none for a backup, the database is damaged, or a disk refuses.
    pub fn run(&self, context: &Context, observer: &dyn Observer) -> Result<BackedUp, PipelineError> {
        if found(&context.folder) != Found::Something {
            return Err(BackupError::NoDatabase {
                folder: context.folder.clone(),
            }
            .into());
        }
        let mut shelf = Shelf::open(&self.folder, &context.folder, &context.store.identity()?)?;
        // A damaged list is written anew; what it named is held against its hash below.
        let earlier = Manifest::read(&self.folder).ok().flatten();
        let damaged = match self.deep {
            true => shelf.check_all()?,
            false => Vec::new(),
        };
        let (database, copy) = self.copy_database(context, observer)?;
        let mut left_out = Vec::new();
        let mut files = raw_files(context, &copy, &mut shelf, observer, &mut left_out)?;
        files.extend(journal(context, &mut shelf)?);
        for wanted in listed(context, &copy, &mut left_out)? {
            interrupt::check();
            files.extend(kept(context, &wanted, &mut shelf, &mut left_out)?);
        }
        shelf.write()?;
        files.sort_by(|a, b| a.path.cmp(&b.path));
        left_out.sort();
        let made_at = now();
        let head = Head {
            campaign: context.campaign.id.clone(),
            database_id: copy.identity()?,
            made_at: made_at.clone(),
            changes: copy.changes()?.0,
        };
        drop(copy);
        let manifest = Manifest::of(head, database, files, left_out);
        // Its names before the list that speaks of them.
        let synced = || sync_names(&self.folder).map_err(failed(&self.folder, "bringing it to the disk"));
        synced()?;
        manifest.write(&self.folder)?;
        synced()?;
        shelf.forget(&manifest.database.path, forgotten(earlier.as_ref(), &manifest))?;
        Ok(BackedUp {
            folder: self.folder.clone(),
            made_at,
            files: manifest.files.len(),
            database_bytes: manifest.database.size_bytes,
            copied: shelf.copied.0,
            copied_bytes: shelf.copied.1,
            mended: shelf.count_of(&damaged),
            left_out: manifest.left_out,
        })
    }

    /// Copies the database, checks the copy, and gives it the name of its hash.
    fn copy_database(
        &self,
        context: &Context,
        observer: &dyn Observer,
    ) -> Result<(StoredFile, Store), PipelineError> {
        let unfinished = self.folder.join(format!("{DATABASE}{UNFINISHED}"));
        if unfinished.exists() {
            fs::remove_file(&unfinished).map_err(failed(&unfinished, "removing"))?;
        }
        observer.begin("copying the database", 100);
        let reach = |done: u64, total: u64| observer.reach(100 * done / total.max(1));
        let copied = context.store.copy_to(&unfinished, &reach);
        observer.end();
        copied?;
        let file = fs::File::open(&unfinished).map_err(failed(&unfinished, "opening"))?;
        file.sync_all()
            .map_err(failed(&unfinished, "bringing it to the disk"))?;
        let wrong = Store::open_copy(&unfinished)?.check_all()?;
        if let Some(detail) = wrong.into_iter().next() {
            let _ = fs::remove_file(&unfinished);
            let folder = self.folder.clone();
            return Err(BackupError::DatabaseDamaged { folder, detail }.into());
        }
        let (blake3, size_bytes) = hash_of(&unfinished).map_err(failed(&unfinished, "reading"))?;
        let name = format!("{DATABASE}{blake3}");
        let path = self.folder.join(&name);
        fs::rename(&unfinished, &path).map_err(failed(&path, "naming"))?;
        let stored = StoredFile {
            path: name,
            size_bytes,
            blake3,
            modified_ns: 0,
        };
        Ok((stored, Store::open_copy(&path)?))
    }
}

/// Copies raw files that are not there yet: those of the archive, and those that the database names. One that the archive
/// lost is in the backup if an earlier one took it.
fn raw_files(
    context: &Context,
    copy: &Store,
    shelf: &mut Shelf,
    observer: &dyn Observer,
    left_out: &mut Vec<LeftOut>,
) -> Result<Vec<StoredFile>, PipelineError> {
    let archive = Archive::new(&context.folder);
    let mut wanted: Vec<(String, String, u64)> = (copy.contents()?.into_iter())
        .map(|content| (content.hash, content.archive_path, content.size_bytes))
        .collect();
    let named: BTreeSet<String> = wanted.iter().map(|(hash, ..)| hash.clone()).collect();
    let others = archive.entries()?.into_iter();
    wanted.extend(
        others
            .filter(|entry| !named.contains(&entry.hash))
            .map(|entry| (entry.hash, entry.path, entry.size_bytes)),
    );
    observer.begin("copying raw files", wanted.len() as u64);
    let mut files = Vec::new();
    for (hash, path, size_bytes) in wanted {
        interrupt::check();
        observer.advance();
        if !shelf.holds(&hash, size_bytes) {
            match archive.read(&hash) {
                Ok(bytes) => shelf.keep(hash.clone(), bytes, Path::new(&path))?,
                Err(error) => {
                    left_out.push(reason(&path, &format!("{error}")));
                    continue;
                }
            }
        }
        files.push(StoredFile {
            path,
            size_bytes,
            blake3: hash,
            modified_ns: 0,
        });
    }
    observer.end();
    Ok(files)
}

/// The journal as far as its lines are whole: it is appended to meanwhile, and read after the database was copied, so that
/// it holds whatever the database does.
fn journal(context: &Context, shelf: &mut Shelf) -> Result<Option<StoredFile>, PipelineError> {
    let path = context.folder.join(FOLDER).join(JOURNAL);
    let mut bytes = match fs::read(&path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(failed(&path, "reading")(source)),
    };
    let whole = bytes
        .iter()
        .rposition(|byte| *byte == b'\n')
        .map_or(0, |at| at + 1);
    bytes.truncate(whole);
    let stored = StoredFile {
        path: format!("{FOLDER}/{JOURNAL}"),
        size_bytes: bytes.len() as u64,
        blake3: archive::hash(&bytes),
        modified_ns: 0,
    };
    shelf.keep(stored.blake3.clone(), bytes, &path)?;
    Ok(Some(stored))
}

/// Copies a file that people wrote or measured; none where it cannot be read now.
fn kept(
    context: &Context,
    wanted: &Wanted,
    shelf: &mut Shelf,
    left_out: &mut Vec<LeftOut>,
) -> Result<Option<StoredFile>, PipelineError> {
    let stored = |blake3: String, size_bytes: u64| StoredFile {
        path: wanted.path.clone(),
        size_bytes,
        blake3,
        modified_ns: wanted.modified_ns,
    };
    if let Some(hash) = wanted
        .hash
        .as_ref()
        .filter(|hash| shelf.holds(hash, wanted.size_bytes))
    {
        return Ok(Some(stored(hash.clone(), wanted.size_bytes)));
    }
    match (context.read_file)(&wanted.location, LARGEST_FILE_BYTES) {
        Ok(bytes) => {
            let (hash, size_bytes) = (archive::hash(&bytes), bytes.len() as u64);
            shelf.keep(hash.clone(), bytes, &wanted.location)?;
            Ok(Some(stored(hash, size_bytes)))
        }
        Err(error) => {
            left_out.push(reason(&wanted.path, &error.to_string()));
            Ok(None)
        }
    }
}

/// Hashes that the earlier list named, and this one does not.
fn forgotten(earlier: Option<&Manifest>, now: &Manifest) -> impl Iterator<Item = String> {
    let named: BTreeSet<&String> = now.files.iter().map(|file| &file.blake3).collect();
    let before = earlier.into_iter().flat_map(|earlier| &earlier.files);
    // Raw files of the archive stay: nothing removes one, and one that is lost is here.
    let archived: BTreeSet<&String> = (earlier.iter().flat_map(|earlier| &earlier.files))
        .filter(|file| file.path.starts_with(&format!("{FOLDER}/")) && !file.path.ends_with(JOURNAL))
        .map(|file| &file.blake3)
        .collect();
    let gone: BTreeSet<String> = before
        .map(|file| &file.blake3)
        .filter(|hash| !named.contains(hash) && !archived.contains(hash))
        .cloned()
        .collect();
    gone.into_iter()
}
