//! Backups: a copy of a campaign in a folder elsewhere, made while everything runs, and restored into a new folder.
//!
//! All bytes but those of the database lie under their hashes, so that a second backup copies what is new and nothing can
//! be half-changed: the list of what belongs to the backup, written last and in one step, is the backup. The lists before it
//! stay, and what they name: a new backup takes nothing away that can still be needed. The database is copied first: the
//! archive holds whatever it names, since raw files are archived before the database names them.

mod contents;
mod journal;
mod lists;
mod making;
pub mod manifest;
mod place;
mod restore;
mod shelf;

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
use contents::{Omitted, Wanted, listed, reason};
use lists::Lists;
use manifest::{Head, LeftOut, Manifest, StoredFile};
use place::place;
use shelf::{DATABASE, Shelf, UNFINISHED};

pub use crate::pipeline::infra::error::BackupError;
pub use restore::{Restore, Restored};

/// Lists that stay unless the user says otherwise, the new one counted: a week of evenings. Each costs a copy of the database.
pub const KEEP: usize = 7;
/// Largest file that is read into a backup, bytes: none that is taken in is larger.
const LARGEST_FILE_BYTES: u64 = 1 << 30;

/// The verb `backup`.
#[derive(Debug, Clone)]
pub struct Backup {
    /// Folder of the backup.
    pub folder: PathBuf,
    /// Whether every file that is there already is read and held against its hash; a damaged one is copied again.
    pub deep: bool,
    /// How many lists stay, the new one counted; at least one.
    pub keep: usize,
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
    /// Files of the backup that were damaged and are whole again.
    pub mended: usize,
    /// Its list, which is kept beside `backup.json`.
    pub list: String,
    /// Lists of backups before it that can be restored, the newest first.
    pub earlier: Vec<String>,
    /// What is not in the backup as it is now, with the reason.
    pub left_out: Vec<LeftOut>,
    /// Lists of backups before it that are damaged, or of which files are lost.
    pub damaged: Vec<LeftOut>,
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
        let before = Lists::numbered(&self.folder)?;
        let earlier = before.whole.first().map(|(_, list)| list);
        let damaged = if self.deep { shelf.check_all()? } else { Vec::new() };
        let (database, copy) = self.copy_database(context, observer)?;
        let (files, left_out) = gathered(context, &copy, earlier, &mut shelf, observer)?;
        let head = Head {
            campaign: context.campaign.id.clone(),
            database_id: copy.identity()?,
            number: before.next_number(),
            made_at: now(),
            changes: copy.changes()?.0,
        };
        drop(copy);
        let manifest = Manifest::of(head, database, files, left_out);
        let list = lists::put(&manifest, &self.folder)?;
        // From here on the backup is the new one.
        let mut lists = Lists::of(&self.folder)?;
        lists.keep(self.keep.max(1), &self.folder, &shelf)?;
        lists.look_for_losses(&shelf, self.deep);
        let is_lost = |name: &String| lists.damaged.iter().any(|lost| lost.path == *name);
        let others = lists
            .whole
            .iter()
            .map(|(name, _)| name)
            .filter(|name| **name != list);
        Ok(BackedUp {
            folder: self.folder.clone(),
            made_at: manifest.made_at,
            files: manifest.files.len(),
            database_bytes: manifest.database.size_bytes,
            copied: shelf.copied.0,
            copied_bytes: shelf.copied.1,
            mended: shelf.count_of(&damaged),
            earlier: others.filter(|name| !is_lost(name)).cloned().collect(),
            list,
            left_out: manifest.left_out,
            damaged: lists.damaged,
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
    shelf: &mut Shelf,
    observer: &dyn Observer,
) -> Result<(Vec<StoredFile>, Vec<LeftOut>), PipelineError> {
    let mut omitted = Omitted::default();
    let mut files = raw_files(context, copy, shelf, observer, &mut omitted.unread)?;
    files.extend(journal::kept(context, copy, earlier, shelf, &mut omitted.never)?);
    for wanted in listed(context, copy, &mut omitted)? {
        interrupt::check();
        files.extend(kept(context, &wanted, shelf, &mut omitted.unread)?);
    }
    shelf.write()?;
    files.extend(omitted.of_earlier(earlier, &files, shelf));
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
