//! Makes written bytes and names safe against a loss of power.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::error::{ArchiveError, sorted};
#[cfg(target_os = "linux")]
use ieap_system::fs::File;
use ieap_system::{Temporary, fs};

/// More files or folders than these wait for their file system as a whole. Fewer wait each by itself, which does not
/// write out what other programs left to be written.
#[cfg(target_os = "linux")]
const FEW: usize = 8;

/// How files of one folder are made safe.
pub(super) struct Durability {
    /// The folder, opened before anything is written so that later failures of the disk are told to it; none where
    /// the file system as a whole cannot be waited for.
    #[cfg(target_os = "linux")]
    whole: Option<(PathBuf, File)>,
}

impl Durability {
    /// For files that will be written below `folder`.
    #[cfg(target_os = "linux")]
    pub fn of(folder: &Path) -> Durability {
        let opened = || Some((folder.to_path_buf(), File::open(folder).ok()?));
        Durability {
            whole: linux::can_wait_for_all(folder).then(opened).flatten(),
        }
    }

    #[cfg(not(target_os = "linux"))]
    pub fn of(_folder: &Path) -> Durability {
        Durability {}
    }

    /// Returns when the bytes of all files are on the disk; beside each is the path that it is meant for.
    pub fn sync_files(&self, files: &[(Temporary, PathBuf)]) -> Result<(), ArchiveError> {
        if self.sync_whole(files.len())? {
            return Ok(());
        }
        files.iter().try_for_each(|(file, path)| {
            let synced = file.sync_all();
            synced.map_err(|source| sorted(path, "write", 0, source))
        })
    }

    /// Returns when the names in all folders are on the disk; where folders cannot be opened, the operating system
    /// does that by itself.
    pub fn sync_folders(&self, folders: &BTreeSet<PathBuf>) -> Result<(), ArchiveError> {
        if cfg!(not(unix)) || self.sync_whole(folders.len())? {
            return Ok(());
        }
        let mut folders = folders.iter();
        folders
            .try_for_each(|folder| fs::sync_names(folder).map_err(|source| sorted(folder, "sync", 0, source)))
    }

    /// Waits for the whole file system where so many files are worth it; tells whether it did.
    #[cfg(target_os = "linux")]
    fn sync_whole(&self, count: usize) -> Result<bool, ArchiveError> {
        match &self.whole {
            Some((path, folder)) if count > FEW => {
                let synced = folder.sync_file_system();
                synced.map_err(|source| sorted(path, "sync", 0, source))?;
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    #[cfg(not(target_os = "linux"))]
    fn sync_whole(&self, _count: usize) -> Result<bool, ArchiveError> {
        Ok(false)
    }
}

#[cfg(target_os = "linux")]
mod linux {
    use std::path::Path;

    /// File systems whose `syncfs` waits for data, names and the disk's own cache: ext2 to ext4, XFS, Btrfs, and
    /// overlays, which pass it on. FAT, for one, does not wait for the cache. Numbers from the kernel's
    /// `include/uapi/linux/magic.h`.
    const WAITS_FOR_ALL: [u32; 4] = [0xEF53, 0x5846_5342, 0x9123_683E, 0x794C_7630];

    /// Whether `syncfs` below that folder makes all safe and tells failures.
    pub fn can_wait_for_all(folder: &Path) -> bool {
        let is_known =
            rustix::fs::statfs(folder).is_ok_and(|found| WAITS_FOR_ALL.contains(&(found.f_type as u32)));
        is_known && tells_failures(&rustix::system::uname().release().to_string_lossy())
    }

    /// From Linux 5.8 on `syncfs` tells that data could not be written (its manual page).
    fn tells_failures(release: &str) -> bool {
        let mut numbers = release.split(|c: char| !c.is_ascii_digit());
        let mut next = || numbers.next().and_then(|number| number.parse::<u32>().ok());
        matches!((next(), next()), (Some(major), Some(minor)) if (major, minor) >= (5, 8))
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn kernels_that_keep_failures_to_themselves_are_known() {
            for (release, tells) in [
                ("6.18.44-generic", true),
                ("5.8", true),
                ("5.8.0-rc1", true),
                ("5.7.19", false),
                ("4.19.0-27-amd64", false),
                ("10.0", true),
                ("unknown", false),
                ("", false),
            ] {
                assert_eq!(tells_failures(release), tells, "{release}");
            }
            // proc(5) is none of the file systems.
            assert!(!can_wait_for_all(Path::new("/proc")));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_and_many_files_are_synced_and_a_lost_folder_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let durability = Durability::of(folder.path());
        for count in [0, 1, 40] {
            let file = |k: usize| {
                let made = Temporary::new_in(folder.path(), ".part-", "", 0o444).unwrap();
                (made, folder.path().join(k.to_string()))
            };
            let files: Vec<_> = (0..count).map(file).collect();
            durability.sync_files(&files).unwrap();
        }
        let folders = BTreeSet::from([folder.path().to_path_buf()]);
        durability.sync_folders(&folders).unwrap();
        if cfg!(unix) {
            let lost = BTreeSet::from([folder.path().join("lost")]);
            assert!(durability.sync_folders(&lost).is_err());
        }
    }
}
