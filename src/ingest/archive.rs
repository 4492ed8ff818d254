//! The raw files by content: `archive/ab/abcdef....csv`, written once, never changed.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Folder of the archive inside the campaign.
pub const FOLDER: &str = "archive";

/// Begin of the names of files that are not written to their end yet.
const PARTIAL: &str = ".part-";

/// What storing some bytes came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// They were not there and are now.
    Written,
    /// They were there already.
    AlreadyThere,
    /// A file of that hash was there with another size; it was replaced by the right bytes.
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

/// Why the archive could not do what was asked.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// No room is left.
    #[error("{}: the disk is full: {needed_bytes} bytes could not be stored ({source}); make room, then run again: nothing is lost and no half file is left", path.display())]
    DiskFull {
        /// The file that was to be written.
        path: PathBuf,
        /// Its size.
        needed_bytes: u64,
        /// What the operating system said.
        source: io::Error,
    },
    /// No right to write or read there.
    #[error("{}: no right to {doing} ({source}); give your user the right to the campaign's archive folder", path.display())]
    Denied {
        /// The file or folder.
        path: PathBuf,
        /// `write`, `read`, ...
        doing: &'static str,
        /// What the operating system said.
        source: io::Error,
    },
    /// The disk or the share failed.
    #[error("{}: could not {doing} ({source}); check the disk or share, then run again", path.display())]
    Failed {
        /// The file or folder.
        path: PathBuf,
        /// `write`, `read`, ...
        doing: &'static str,
        /// What the operating system said.
        source: io::Error,
    },
    /// No file of that hash.
    #[error("{}: no raw file with the hash {hash}; bring it back from a backup, or put the original file into the runs folder again", folder.display())]
    Absent {
        /// Folder where it was looked for.
        folder: PathBuf,
        /// The hash.
        hash: String,
    },
    /// The bytes are not those that were stored.
    #[error("{}: damaged: its bytes hash to {found}; replace it from a backup, or put the original file into the runs folder again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The hash of what is there.
        found: String,
    },
    /// The text is no hash.
    #[error("\"{found}\" is no hash: 64 digits 0-9 a-f are needed")]
    NotAHash {
        /// What was given.
        found: String,
    },
}

/// BLAKE3 of some bytes, 64 hexadecimal digits.
pub fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
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

    /// Stores `bytes` under their hash, with the ending of `name`. When this returns, bytes and name are on
    /// the disk: only then may a database row speak of them.
    ///
    /// # Errors
    /// Where there is no room, no right, or the disk fails; no half file is left then.
    pub fn store(&self, bytes: &[u8], name: &Path) -> Result<(Archived, Outcome), ArchiveError> {
        let hash = hash(bytes);
        let folder = self.folder_of(&hash);
        self.create(&folder)?;
        let (path, outcome) = match self.locate(&hash)? {
            Some(path) if fs::metadata(&path).is_ok_and(|there| there.len() == bytes.len() as u64) => {
                (path, Outcome::AlreadyThere)
            }
            Some(path) => (path, Outcome::Repaired),
            None => (folder.join(format!("{hash}{}", ending(name))), Outcome::Written),
        };
        if outcome != Outcome::AlreadyThere {
            write_whole(&folder, &path, bytes)?;
        }
        // Also where the file was there: a program killed between rename and this may have left it unsafe.
        sync_folder(&folder)?;
        let archived = Archived {
            path: self.relative(&path),
            size_bytes: bytes.len() as u64,
            hash,
        };
        Ok((archived, outcome))
    }

    /// The bytes with that hash, checked.
    ///
    /// # Errors
    /// Where they are not there, are damaged, or cannot be read.
    pub fn read(&self, hash_text: &str) -> Result<Vec<u8>, ArchiveError> {
        let path = self.find(hash_text)?;
        let bytes = fs::read(&path).map_err(|source| error(&path, "read", 0, source))?;
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
        let is_digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
        if hash.len() != 64 || !hash.bytes().all(is_digit) {
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
        for folder in list(&self.campaign.join(FOLDER))?
            .into_iter()
            .filter(|path| path.is_dir())
        {
            for path in list(&folder)? {
                let Some(hash) = hash_in_name(&path) else { continue };
                let there = fs::metadata(&path).map_err(|source| error(&path, "read", 0, source))?;
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
        for folder in list(&self.campaign.join(FOLDER))?
            .into_iter()
            .filter(|path| path.is_dir())
        {
            for path in list(&folder)? {
                let name = path.file_name().unwrap_or_default();
                if name.to_string_lossy().starts_with(PARTIAL) {
                    fs::remove_file(&path).map_err(|source| error(&path, "remove", 0, source))?;
                    removed += 1;
                }
            }
        }
        Ok(removed)
    }

    fn folder_of(&self, hash: &str) -> PathBuf {
        self.campaign.join(FOLDER).join(&hash[..2])
    }

    fn locate(&self, hash: &str) -> Result<Option<PathBuf>, ArchiveError> {
        let files = list(&self.folder_of(hash))?;
        Ok(files
            .into_iter()
            .find(|path| hash_in_name(path).as_deref() == Some(hash)))
    }

    fn relative(&self, path: &Path) -> String {
        super::scan::display_path(path.strip_prefix(&self.campaign).unwrap_or(path))
    }

    /// Creates the folder and makes its name safe in the folders above.
    fn create(&self, folder: &Path) -> Result<(), ArchiveError> {
        if folder.is_dir() {
            return Ok(());
        }
        fs::create_dir_all(folder).map_err(|source| error(folder, "create", 0, source))?;
        sync_folder(&self.campaign.join(FOLDER))?;
        sync_folder(&self.campaign)
    }
}

/// Temporary file beside the place, written and synced, then renamed to the place.
fn write_whole(folder: &Path, path: &Path, bytes: &[u8]) -> Result<(), ArchiveError> {
    let failed = |source| error(path, "write", bytes.len() as u64, source);
    let mut builder = tempfile::Builder::new();
    builder.prefix(PARTIAL);
    // Raw files are for everyone to read and for nobody to change.
    #[cfg(unix)]
    let permissions = <fs::Permissions as std::os::unix::fs::PermissionsExt>::from_mode(0o444);
    #[cfg(unix)]
    builder.permissions(permissions);
    let mut file = builder.tempfile_in(folder).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    file.as_file().sync_all().map_err(failed)?;
    file.persist(path).map_err(|kept| failed(kept.error))?;
    Ok(())
}

/// Makes the names in a folder safe against a loss of power.
fn sync_folder(folder: &Path) -> Result<(), ArchiveError> {
    File::open(folder)
        .and_then(|folder| folder.sync_all())
        .map_err(|source| error(folder, "sync", 0, source))
}

/// What lies in a folder, sorted; nothing where the folder is not there.
fn list(folder: &Path) -> Result<Vec<PathBuf>, ArchiveError> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(source) if source.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(source) => return Err(error(folder, "read", 0, source)),
    };
    let paths: io::Result<Vec<PathBuf>> = entries.map(|entry| Ok(entry?.path())).collect();
    let mut paths = paths.map_err(|source| error(folder, "read", 0, source))?;
    paths.sort();
    Ok(paths)
}

/// The hash that a file of the archive is named by.
fn hash_in_name(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let hash = name.split('.').next()?;
    (hash.len() == 64 && hash.bytes().all(|byte| byte.is_ascii_hexdigit())).then(|| hash.to_owned())
}

/// `.csv` of `A.CSV`; nothing where there is no plain ending.
fn ending(name: &Path) -> String {
    let plain = |ending: &&str| ending.len() <= 16 && ending.bytes().all(|byte| byte.is_ascii_alphanumeric());
    let ending = name.extension().and_then(|ending| ending.to_str()).filter(plain);
    ending.map_or(String::new(), |ending| format!(".{}", ending.to_lowercase()))
}

fn error(path: &Path, doing: &'static str, needed_bytes: u64, source: io::Error) -> ArchiveError {
    let path = path.to_path_buf();
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
            ArchiveError::DiskFull {
                path,
                needed_bytes,
                source,
            }
        }
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            ArchiveError::Denied { path, doing, source }
        }
        _ => ArchiveError::Failed { path, doing, source },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn archive() -> (tempfile::TempDir, Archive) {
        let folder = tempfile::tempdir().unwrap();
        let archive = Archive::new(folder.path());
        (folder, archive)
    }

    #[test]
    fn the_hash_is_blake3() {
        // The published test vector for the empty input.
        assert_eq!(
            hash(b""),
            "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262"
        );
    }

    #[test]
    fn bytes_are_stored_once_and_read_back() {
        let (folder, archive) = archive();
        let (first, outcome) = archive.store(b"readings", Path::new("runs/A.CSV")).unwrap();
        assert_eq!(outcome, Outcome::Written);
        assert_eq!(
            first.path,
            format!("archive/{}/{}.csv", &first.hash[..2], first.hash)
        );
        let (second, outcome) = archive.store(b"readings", Path::new("b.txt")).unwrap();
        assert_eq!((second, outcome), (first.clone(), Outcome::AlreadyThere));
        assert_eq!(archive.read(&first.hash).unwrap(), b"readings");
        assert_eq!(archive.entries().unwrap(), std::slice::from_ref(&first));
        assert_eq!(fs::read(folder.path().join(&first.path)).unwrap(), b"readings");
    }

    #[test]
    fn an_ending_that_is_no_plain_one_is_left_out() {
        for (name, expected) in [
            ("a.CSV", ".csv"),
            ("a", ""),
            ("a.b c", ""),
            ("a.abcdefghijklmnopq", ""),
            (".dta", ""),
            ("a.tar.gz", ".gz"),
            ("a.µ", ""),
        ] {
            assert_eq!(ending(Path::new(name)), expected, "{name}");
        }
    }

    #[test]
    fn damage_is_found_and_a_wrong_size_is_repaired() {
        let (folder, archive) = archive();
        let (stored, _) = archive.store(b"readings", Path::new("a.csv")).unwrap();
        let path = folder.path().join(&stored.path);
        fs::remove_file(&path).unwrap();
        fs::write(&path, b"rEadings").unwrap();
        assert!(matches!(
            archive.read(&stored.hash),
            Err(ArchiveError::Damaged { .. })
        ));
        fs::write(&path, b"read").unwrap();
        let (again, outcome) = archive.store(b"readings", Path::new("a.csv")).unwrap();
        assert_eq!((again, outcome), (stored.clone(), Outcome::Repaired));
        assert_eq!(archive.read(&stored.hash).unwrap(), b"readings");
    }

    #[test]
    fn what_is_not_there_or_no_hash_is_said() {
        let (_folder, archive) = archive();
        assert!(matches!(
            archive.read(&hash(b"x")),
            Err(ArchiveError::Absent { .. })
        ));
        for text in [
            "",
            "ab",
            "../../../../etc/passwd",
            &"g".repeat(64),
            &"A".repeat(64),
        ] {
            assert!(
                matches!(archive.read(text), Err(ArchiveError::NotAHash { .. })),
                "{text}"
            );
        }
        assert_eq!(archive.entries().unwrap(), []);
        assert_eq!(archive.remove_partial().unwrap(), 0);
    }

    #[test]
    fn half_files_of_a_killed_program_are_no_entries_and_are_removed() {
        let (folder, archive) = archive();
        let (stored, _) = archive.store(b"readings", Path::new("a.csv")).unwrap();
        let partial = folder.path().join(&stored.path).with_file_name(".part-abc");
        fs::write(&partial, b"rea").unwrap();
        assert_eq!(archive.entries().unwrap().len(), 1);
        assert_eq!(archive.remove_partial().unwrap(), 1);
        assert!(!partial.exists());
        assert_eq!(archive.read(&stored.hash).unwrap(), b"readings");
    }

    #[test]
    fn refusals_of_the_system_are_sorted() {
        let from = |code: rustix::io::Errno| error(Path::new("x"), "write", 5, code.into());
        assert!(matches!(
            from(rustix::io::Errno::NOSPC),
            ArchiveError::DiskFull { needed_bytes: 5, .. }
        ));
        assert!(matches!(
            from(rustix::io::Errno::DQUOT),
            ArchiveError::DiskFull { .. }
        ));
        assert!(matches!(
            from(rustix::io::Errno::FBIG),
            ArchiveError::DiskFull { .. }
        ));
        assert!(matches!(
            from(rustix::io::Errno::ACCESS),
            ArchiveError::Denied { doing: "write", .. }
        ));
        assert!(matches!(
            from(rustix::io::Errno::ROFS),
            ArchiveError::Denied { .. }
        ));
        assert!(matches!(from(rustix::io::Errno::IO), ArchiveError::Failed { .. }));
    }
}
