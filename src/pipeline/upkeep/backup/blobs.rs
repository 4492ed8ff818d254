//! The folder of a backup: bytes under their hashes, as an archive keeps them, and copies of the database.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

use super::manifest::{self, Manifest};
use crate::ingest::archive::{Archive, Archived, FOLDER, Incoming, is_hash};
use crate::pipeline::infra::error::BackupError;
use crate::pipeline::{PipelineError, failed};
use crate::store::InstanceLock;
use crate::system::fs;

/// How the name of a copy of the database begins; its hash follows.
pub const DATABASE: &str = "campaign.db.";
/// Ending of the name of a copy that is not finished.
pub const UNFINISHED: &str = "unfinished";
/// Most files, and most bytes, that are in memory and wait for the disk together.
const MOST_FILES: usize = 128;
const MOST_BYTES: usize = 16 << 20;

/// The folder of a backup under way.
pub struct Blobs {
    folder: PathBuf,
    archive: Archive,
    /// Sizes of what is there, bytes, by hash.
    there: BTreeMap<String, u64>,
    /// Read, and not written yet.
    waiting: Vec<(String, Vec<u8>, PathBuf)>,
    /// Number and bytes of files that were copied.
    pub copied: (usize, u64),
    /// Keeps another backup out.
    _lock: InstanceLock,
}

impl Blobs {
    /// Opens the folder for a backup of the database with that id; makes it where there is none.
    ///
    /// # Errors
    /// It lies in the campaign, holds something else, is of another database, or cannot be written.
    pub fn open(folder: &Path, campaign: &Path, id: &str) -> Result<Blobs, PipelineError> {
        let absolute = std::path::absolute(folder).map_err(failed(folder, "finding the folder"))?;
        let existing = absolute.ancestors().find_map(|above| above.canonicalize().ok());
        let inside = match (existing, campaign.canonicalize()) {
            (Some(existing), Ok(campaign)) => existing.starts_with(campaign),
            _ => false,
        };
        if inside {
            return Err(BackupError::InsideCampaign {
                folder: folder.to_owned(),
            }
            .into());
        }
        let archive = Archive::new(folder);
        match archive.owner()? {
            Some(found) if found != id => {
                return Err(BackupError::OfAnother {
                    folder: folder.to_owned(),
                    found,
                    needed: id.to_owned(),
                }
                .into());
            }
            // A copy of a campaign has an owner, too.
            owner => refuse_other(folder, owner.is_some())?,
        }
        fs::create_dir_all(folder).map_err(failed(folder, "making the folder"))?;
        let lock = InstanceLock::take(folder)?;
        archive.set_owner(id)?;
        archive.remove_partial()?;
        Ok(Blobs {
            there: (archive.entries()?.into_iter())
                .map(|entry| (entry.hash, entry.size_bytes))
                .collect(),
            folder: folder.to_owned(),
            archive,
            waiting: Vec::new(),
            copied: (0, 0),
            _lock: lock,
        })
    }

    /// Whether bytes with that hash are there; looked at is their size.
    pub fn holds(&self, hash: &str, size_bytes: u64) -> bool {
        self.there.get(hash) == Some(&size_bytes)
    }

    /// Keeps bytes under their hash, unless they are there.
    ///
    /// # Errors
    /// The disk refuses, or does not give back what was written.
    pub fn keep(&mut self, hash: String, bytes: Vec<u8>, name: &Path) -> Result<(), PipelineError> {
        if self.holds(&hash, bytes.len() as u64) {
            return Ok(());
        }
        self.there.insert(hash.clone(), bytes.len() as u64);
        self.waiting.push((hash, bytes, name.to_owned()));
        let waiting: usize = self.waiting.iter().map(|(_, bytes, _)| bytes.len()).sum();
        if self.waiting.len() >= MOST_FILES || waiting >= MOST_BYTES {
            self.write()
        } else {
            Ok(())
        }
    }

    /// Writes what waits: when this returns it is on the disk, and was read back.
    ///
    /// # Errors
    /// As [`Blobs::keep`].
    pub fn write(&mut self) -> Result<(), PipelineError> {
        let waiting = std::mem::take(&mut self.waiting);
        let incoming: Vec<Incoming<'_>> = waiting
            .iter()
            .map(|(hash, bytes, name)| Incoming { hash, bytes, name })
            .collect();
        let stored: Vec<Archived> = (self.archive.store_all(&incoming)?.into_iter())
            .map(|(archived, _)| archived)
            .collect();
        if let Some(wrong) = self.archive.verify(&stored)?.into_iter().next() {
            return Err(BackupError::NotAsWritten {
                folder: self.folder.clone(),
                path: wrong.wanted.path,
            }
            .into());
        }
        self.copied.0 += stored.len();
        self.copied.1 += stored.iter().map(|archived| archived.size_bytes).sum::<u64>();
        Ok(())
    }

    /// Removes what only the list before it named, raw files left out, and every other copy of the database.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn forget(&self, earlier: Option<&Manifest>, now: &Manifest) -> Result<(), PipelineError> {
        let named: BTreeSet<&str> = now.hashes().collect();
        let earlier = earlier.iter().flat_map(|list| list.hashes_to_forget());
        let gone: BTreeSet<&str> = earlier
            .filter(|hash| !named.contains(hash) && self.there.contains_key(*hash))
            .collect();
        for hash in gone {
            let path = self.archive.find(hash)?;
            fs::remove_file(&path).map_err(failed(&path, "removing"))?;
        }
        let entries = fs::entries(&self.folder).map_err(failed(&self.folder, "looking into it"))?;
        for entry in entries {
            let name = entry.file_name().to_string_lossy().into_owned();
            if is_database(&name) && name != now.database.path {
                let path = self.folder.join(name);
                fs::remove_file(&path).map_err(failed(&path, "removing"))?;
            }
        }
        Ok(())
    }
}

/// Refuses a folder that holds what no backup does.
fn refuse_other(folder: &Path, is_begun: bool) -> Result<(), PipelineError> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(source) => return Err(failed(folder, "looking into it")(source)),
    };
    for entry in entries {
        let entry = entry.map_err(failed(folder, "looking into it"))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let ours = is_database(&name)
            || [FOLDER, manifest::FILE_NAME, InstanceLock::FILE_NAME].contains(&name.as_str())
            // Of a list that was cut short, or of a file manager.
            || name.starts_with('.');
        if !ours || !is_begun && !name.starts_with('.') && name != InstanceLock::FILE_NAME {
            let folder = folder.to_owned();
            return Err(BackupError::NotABackup { folder, found: name }.into());
        }
    }
    Ok(())
}

/// Whether a name is that of a copy of the database: its hash, or that it is not finished.
pub(super) fn is_database(name: &str) -> bool {
    let hash = name.strip_prefix(DATABASE);
    hash.is_some_and(|hash| hash == UNFINISHED || is_hash(hash))
}
