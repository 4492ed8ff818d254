//! A backup: one copy of a campaign in a folder elsewhere, made while everything runs, and restored into a new folder.
//!
//! All bytes but those of the database lie under their hashes, so that the next backup copies what is new and nothing can be
//! half-changed: the list of what belongs to the backup, written last and in one step, is the backup. What only the list before
//! it named goes after that. The database is copied first, then the words, whose end is compared with its own, then raw files:
//! the archive holds whatever it names, since raw files are archived before the database names them. Versions are for programs
//! that keep versions of any folder.

mod blobs;
mod contents;
mod making;
pub mod manifest;
mod place;
mod restore;
mod words;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::ingest::archive::{self, Archive};
use crate::numerics::interrupt;
use crate::pipeline::campaign::context::now;
use crate::pipeline::{Context, Observer, PipelineError, failed};
use crate::store::{Found, Store, found};
use crate::system::fs;
use blobs::{Blobs, DATABASE, UNFINISHED};
use contents::{Omitted, Wanted, listed, reason};
use manifest::{Head, JOURNAL, LeftOut, Manifest, StoredFile};
use place::place;

pub use crate::pipeline::infra::error::BackupError;
pub use restore::{Restore, Restored};

/// Largest file that is read into a backup, bytes: none that is taken in is larger.
const LARGEST_FILE_BYTES: u64 = 1 << 30;

/// The verb `backup`.
#[derive(Debug, Clone)]
pub struct Backup {
    /// Folder of the backup.
    pub folder: PathBuf,
}

/// What `backup` did.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
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
    /// What is not in the backup as it is now, with the reason.
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
        let mut blobs = Blobs::open(&self.folder, &context.folder, &context.store.identity()?)?;
        let earlier = match Manifest::read(&self.folder) {
            // What cannot be read is no backup: another list takes its place.
            Err(PipelineError::Backup(damaged)) => {
                observer.warn(&damaged.to_string());
                None
            }
            found => found?,
        };
        let (database, copy) = self.copy_database(context, observer)?;
        let (files, left_out) = gathered(context, &copy, earlier.as_ref(), &mut blobs, observer)?;
        let head = Head {
            campaign: context.campaign.id.clone(),
            database_id: copy.identity()?,
            made_at: now(),
            changes: copy.changes()?.0,
        };
        drop(copy);
        let manifest = Manifest::of(head, database, files, left_out);
        manifest.put(&self.folder)?;
        // From here on the backup is the new one.
        blobs.forget(earlier.as_ref(), &manifest)?;
        Ok(BackedUp {
            folder: self.folder.clone(),
            made_at: manifest.made_at,
            files: manifest.files.len(),
            database_bytes: manifest.database.size_bytes,
            copied: blobs.copied.0,
            copied_bytes: blobs.copied.1,
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
        let file = fs::File::open_own(&unfinished).map_err(failed(&unfinished, "opening"))?;
        file.sync_all()
            .map_err(failed(&unfinished, "bringing it to the disk"))?;
        let wrong = Store::open_copy(&unfinished)?.check_all()?;
        if let Some(detail) = wrong.into_iter().next() {
            let _ = fs::remove_file(&unfinished);
            let folder = self.folder.clone();
            return Err(BackupError::DatabaseDamaged { folder, detail }.into());
        }
        let (blake3, size_bytes) =
            archive::hash_of_file(&unfinished).map_err(failed(&unfinished, "reading"))?;
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

/// Copies every file that is not there yet; gives what the list names, and what it does not.
fn gathered(
    context: &Context,
    copy: &Store,
    earlier: Option<&Manifest>,
    blobs: &mut Blobs,
    observer: &dyn Observer,
) -> Result<(Vec<StoredFile>, Vec<LeftOut>), PipelineError> {
    let mut omitted = Omitted::default();
    let mut files = raw_files(context, copy, blobs, observer, &mut omitted.unread)?;
    files.extend(kept_words(context, copy, earlier, blobs)?);
    for wanted in listed(context, copy, &mut omitted)? {
        interrupt::check();
        files.extend(kept(context, &wanted, blobs, &mut omitted.unread)?);
    }
    blobs.write()?;
    files.extend(omitted.of_earlier(earlier, &files, blobs));
    // What could not be restored everywhere is no part of a backup.
    files.retain(|file| match place(&file.path) {
        Ok(_) => true,
        Err(why) => {
            omitted.never.push(reason(&file.path, why));
            false
        }
    });
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok((files, omitted.sorted()))
}

/// Copies the words, where anything was said.
fn kept_words(
    context: &Context,
    copy: &Store,
    earlier: Option<&Manifest>,
    blobs: &mut Blobs,
) -> Result<Option<StoredFile>, PipelineError> {
    let earlier = earlier.and_then(|list| list.file(JOURNAL));
    let Some(bytes) = words::read(context, copy, earlier)? else {
        return Ok(None);
    };
    let stored = StoredFile {
        path: JOURNAL.to_owned(),
        size_bytes: bytes.len() as u64,
        blake3: archive::hash(&bytes),
        modified_ns: 0,
    };
    blobs.keep(stored.blake3.clone(), bytes, Path::new(JOURNAL))?;
    Ok(Some(stored))
}

/// Copies raw files that are not there yet: those of the archive, and those that the database names. One that the archive
/// lost is in the backup if an earlier one took it.
fn raw_files(
    context: &Context,
    copy: &Store,
    blobs: &mut Blobs,
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
        if !blobs.holds(&hash, size_bytes) {
            match archive.read(&hash) {
                Ok(bytes) => blobs.keep(hash.clone(), bytes, Path::new(&path))?,
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

/// Copies a file that people wrote or measured; none where it cannot be read now.
fn kept(
    context: &Context,
    wanted: &Wanted,
    blobs: &mut Blobs,
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
        .filter(|hash| blobs.holds(hash, wanted.size_bytes))
    {
        return Ok(Some(stored(hash.clone(), wanted.size_bytes)));
    }
    match (context.read_file)(&wanted.location, LARGEST_FILE_BYTES) {
        Ok(bytes) => {
            let (hash, size_bytes) = (archive::hash(&bytes), bytes.len() as u64);
            blobs.keep(hash.clone(), bytes, &wanted.location)?;
            Ok(Some(stored(hash, size_bytes)))
        }
        Err(error) => {
            left_out.push(reason(&wanted.path, &error.to_string()));
            Ok(None)
        }
    }
}
