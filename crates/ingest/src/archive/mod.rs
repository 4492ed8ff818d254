//! The raw files by content: `archive/ab/abcdef....csv`, written once, never changed.

mod check;
mod durability;
mod error;
mod owner;

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{OsStr, OsString};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use ieap_system::{Temporary, fs};

use durability::Durability;
use error::sorted;

pub use check::{BlobFault, BlobFinding};
pub use error::ArchiveError;

/// Folder of the archive inside the campaign.
pub const FOLDER: &str = "archive";

/// Begin of the names of files that are not written to their end yet.
pub(crate) const PARTIAL: &str = ".part-";

/// Bytes of a file that are in memory while it is hashed.
const HASHED_BYTES: usize = 256 << 10;

/// Most files that are open at once: systems allow 256 and more.
const MOST_OPEN: usize = 128;

/// Bytes on their way into the archive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Incoming<'a> {
    /// BLAKE3 of the bytes, as [`hash()`] gives it.
    pub hash: &'a str,
    /// The bytes.
    pub bytes: &'a [u8],
    /// Name of the file, for its ending.
    pub name: &'a Path,
}

/// What storing some bytes came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// They were not there and are now.
    Written,
    /// They were there already.
    AlreadyThere,
    /// A file of that hash was there with other bytes; it was replaced by the right ones.
    Repaired,
}

/// Where some bytes lie in the archive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Archived {
    /// BLAKE3 of the bytes, 64 hexadecimal digits.
    pub hash: String,
    /// Path relative to the campaign, with `/`.
    pub path: String,
    /// Size, bytes.
    pub size_bytes: u64,
}

/// BLAKE3 of some bytes, 64 hexadecimal digits.
pub fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// BLAKE3 and size, bytes, of a file of the program, read piece by piece.
///
/// # Errors
/// What the system says.
pub fn hash_of_file(path: &Path) -> io::Result<(String, u64)> {
    let (mut hasher, mut size_bytes) = (blake3::Hasher::new(), 0);
    let mut file = fs::File::open_own(path)?;
    let mut piece = vec![0; HASHED_BYTES];
    loop {
        let count = file.read(&mut piece)?;
        if count == 0 {
            return Ok((hasher.finalize().to_hex().to_string(), size_bytes));
        }
        hasher.update(&piece[..count]);
        size_bytes += count as u64;
    }
}

/// Whether a text can be such a hash.
pub fn is_hash(text: &str) -> bool {
    let is_digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
    text.len() == 64 && text.bytes().all(is_digit)
}

/// The archive of one campaign.
#[derive(Debug, Clone)]
pub struct Archive {
    campaign: PathBuf,
}

impl Archive {
    /// The archive of the campaign in that folder; nothing is created yet.
    pub fn new(campaign: &Path) -> Archive {
        Archive {
            campaign: campaign.to_path_buf(),
        }
    }

    /// Stores bytes under their hashes, with the endings of their names; the answers are in the order of `files`.
    /// When this returns, bytes and names are on the disk: only then may a database row speak of them. Many files
    /// wait for the disk together.
    ///
    /// # Errors
    /// Where there is no room, no right, or the disk fails; no half file is left then.
    pub fn store_all(&self, files: &[Incoming<'_>]) -> Result<Vec<(Archived, Outcome)>, ArchiveError> {
        let mut stored = Vec::with_capacity(files.len());
        for few in files.chunks(MOST_OPEN) {
            stored.extend(self.store_few(few)?);
        }
        Ok(stored)
    }

    /// Stores the bytes of one file: see [`Archive::store_all`].
    ///
    /// # Errors
    /// As there.
    pub fn store(&self, bytes: &[u8], name: &Path) -> Result<(Archived, Outcome), ArchiveError> {
        let hash = &hash(bytes);
        let stored = self.store_all(&[Incoming { hash, bytes, name }])?;
        stored.into_iter().next().ok_or_else(|| ArchiveError::Absent {
            folder: self.folder_of(hash),
            hash: hash.clone(),
        })
    }

    /// The bytes are safe before they get their names, and the names before this returns.
    fn store_few(&self, files: &[Incoming<'_>]) -> Result<Vec<(Archived, Outcome)>, ArchiveError> {
        let durability = Durability::of(&self.campaign);
        let mut places: BTreeMap<&str, PathBuf> = BTreeMap::new();
        // Also folders of files that are there: a program killed before this left their names unsafe.
        let mut folders = BTreeSet::from([self.campaign.clone(), self.campaign.join(FOLDER)]);
        let (mut written, mut stored) = (Vec::new(), Vec::new());
        for file in files {
            let (path, outcome) = match places.get(file.hash) {
                Some(path) => (path.clone(), Outcome::AlreadyThere),
                None => self.place(file)?,
            };
            let folder = self.folder_of(file.hash);
            if outcome != Outcome::AlreadyThere {
                written.push((temporary(&folder, &path, file.bytes)?, path.clone()));
            }
            folders.insert(folder);
            let archived = Archived {
                hash: file.hash.to_owned(),
                path: self.relative(&path),
                size_bytes: file.bytes.len() as u64,
            };
            places.insert(file.hash, path);
            stored.push((archived, outcome));
        }
        durability.sync_files(&written)?;
        for (file, path) in written {
            let kept = file.persist(&path);
            kept.map_err(|source| sorted(&path, "write", 0, source))?;
        }
        durability.sync_folders(&folders)?;
        Ok(stored)
    }

    /// Where bytes belong, and whether they are there.
    fn place(&self, file: &Incoming<'_>) -> Result<(PathBuf, Outcome), ArchiveError> {
        let folder = self.folder_of(file.hash);
        fs::create_dir_all(&folder).map_err(|source| sorted(&folder, "create", 0, source))?;
        Ok(match self.locate(file.hash)? {
            Some(path) if fs::read_own(&path).is_ok_and(|there| hash(&there) == file.hash) => {
                (path, Outcome::AlreadyThere)
            }
            Some(path) => (path, Outcome::Repaired),
            None => {
                let name = format!("{}{}", file.hash, ending(file.name));
                (folder.join(name), Outcome::Written)
            }
        })
    }

    /// The bytes with that hash, checked.
    ///
    /// # Errors
    /// Where they are not there, are damaged, or cannot be read.
    pub fn read(&self, hash_text: &str) -> Result<Vec<u8>, ArchiveError> {
        let path = self.find(hash_text)?;
        let bytes = fs::read_own(&path).map_err(|source| sorted(&path, "read", 0, source))?;
        let found = hash(&bytes);
        if found == hash_text {
            Ok(bytes)
        } else {
            Err(ArchiveError::Damaged { path, found })
        }
    }

    /// The path of the file with that hash; its bytes are not checked.
    ///
    /// # Errors
    /// Where it is not there or the folder cannot be read.
    pub fn find(&self, hash: &str) -> Result<PathBuf, ArchiveError> {
        if !is_hash(hash) {
            return Err(ArchiveError::NotAHash {
                found: hash.to_owned(),
            });
        }
        self.locate(hash)?.ok_or_else(|| ArchiveError::Absent {
            folder: self.folder_of(hash),
            hash: hash.to_owned(),
        })
    }

    /// Every file of the archive in the order of the hashes; their bytes are not checked.
    ///
    /// # Errors
    /// Where a folder cannot be read.
    pub fn entries(&self) -> Result<Vec<Archived>, ArchiveError> {
        let mut entries = Vec::new();
        for folder in folders(&self.campaign.join(FOLDER))? {
            for path in list(&folder)? {
                let Some(hash) = path.file_name().and_then(hash_in_name) else {
                    continue;
                };
                let hash = hash.to_owned();
                let there = fs::metadata(&path).map_err(|source| sorted(&path, "read", 0, source))?;
                entries.push(Archived {
                    hash,
                    path: self.relative(&path),
                    size_bytes: there.len(),
                });
            }
        }
        Ok(entries)
    }

    /// Removes what a killed program left half-written; only for the one who may write. Gives the number
    /// of files removed.
    ///
    /// # Errors
    /// Where a folder cannot be read or a file cannot be removed.
    pub fn remove_partial(&self) -> Result<usize, ArchiveError> {
        let mut removed = 0;
        let archive = self.campaign.join(FOLDER);
        let inside = folders(&archive)?.into_iter();
        for folder in inside.chain([archive]) {
            for path in list(&folder)? {
                let name = path.file_name().unwrap_or_default();
                if name.to_string_lossy().starts_with(PARTIAL) {
                    fs::remove_file(&path).map_err(|source| sorted(&path, "remove", 0, source))?;
                    removed += 1;
                }
            }
        }
        Ok(removed)
    }

    fn folder_of(&self, hash: &str) -> PathBuf {
        self.campaign.join(FOLDER).join(&hash[..2])
    }

    /// Asked of every file that comes in: a folder holds hundreds of names, which are neither sorted nor made paths of.
    fn locate(&self, hash: &str) -> Result<Option<PathBuf>, ArchiveError> {
        let folder = self.folder_of(hash);
        let failed = |source| sorted(&folder, "read", 0, source);
        let entries = match fs::read_dir(&folder) {
            Ok(entries) => entries,
            Err(source) if source.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(failed(source)),
        };
        let mut first: Option<OsString> = None;
        for entry in entries {
            let name = entry.map_err(failed)?.file_name();
            let is_it = hash_in_name(&name) == Some(hash);
            // Of several endings always the same one is taken.
            if is_it && first.as_ref().is_none_or(|first| name < *first) {
                first = Some(name);
            }
        }
        Ok(first.map(|name| folder.join(name)))
    }

    /// The path of a file of the archive as it is stored: relative to the campaign, with `/`.
    pub fn relative(&self, path: &Path) -> String {
        super::scan::display_path(path.strip_prefix(&self.campaign).unwrap_or(path))
    }
}

/// A file beside the place at `path` with these bytes, not safe yet; it goes when it is dropped.
fn temporary(folder: &Path, path: &Path, bytes: &[u8]) -> Result<Temporary, ArchiveError> {
    let failed = |source| sorted(path, "write", bytes.len() as u64, source);
    // Raw files are for everyone to read and for nobody to change.
    let mut file = Temporary::new_in(folder, PARTIAL, "", 0o444).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    Ok(file)
}

/// What lies in a folder, sorted; nothing where the folder is not there.
fn list(folder: &Path) -> Result<Vec<PathBuf>, ArchiveError> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(source) if source.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(source) => return Err(sorted(folder, "read", 0, source)),
    };
    let paths: io::Result<Vec<PathBuf>> = entries.map(|entry| Ok(entry?.path())).collect();
    let mut paths = paths.map_err(|source| sorted(folder, "read", 0, source))?;
    paths.sort();
    Ok(paths)
}

/// The folders in a folder, sorted.
fn folders(folder: &Path) -> Result<Vec<PathBuf>, ArchiveError> {
    let mut folders = Vec::new();
    for path in list(folder)? {
        if fs::is_dir(&path).map_err(|source| sorted(&path, "read", 0, source))? {
            folders.push(path);
        }
    }
    Ok(folders)
}

/// The hash that a file of the archive is named by.
fn hash_in_name(name: &OsStr) -> Option<&str> {
    let hash = name.to_str()?.split('.').next()?;
    (hash.len() == 64 && hash.bytes().all(|byte| byte.is_ascii_hexdigit())).then_some(hash)
}

/// `.csv` of `A.CSV`; nothing where there is no plain ending.
fn ending(name: &Path) -> String {
    let plain = |ending: &&str| ending.len() <= 16 && ending.bytes().all(|byte| byte.is_ascii_alphanumeric());
    let ending = name.extension().and_then(|ending| ending.to_str()).filter(plain);
    ending.map_or(String::new(), |ending| format!(".{}", ending.to_lowercase()))
}

#[cfg(test)]
mod tests;
