//! Folders of frames, which the scan takes for one file each.

use std::io;
use std::path::Path;
use std::time::SystemTime;

use super::walk::Walk;
use super::{SeenFile, changed_ns, display_path, identity, is_passing_name, modified_ns};
use crate::frames::FILE_NAME;
use ieap_system::fs::{self, DirEntry};

/// Whether a folder with these entries is a folder of frames.
pub(super) fn is_one(entries: &[DirEntry]) -> bool {
    entries.iter().any(|entry| entry.file_name() == FILE_NAME)
}

impl Walk<'_> {
    /// A folder with `frames.toml` is one thing that is measured, as a file is: it has grown where any file in it has.
    pub(super) fn folder_of_frames(
        &mut self,
        relative: &Path,
        path: &Path,
        entries: &[DirEntry],
    ) -> io::Result<()> {
        let own = fs::metadata(path)?;
        let (mut size_bytes, mut modified) = (0, own.modified().unwrap_or(SystemTime::UNIX_EPOCH));
        let (mut latest_ns, mut latest_change_ns) = (modified_ns(&own), changed_ns(&own));
        for entry in entries
            .iter()
            .filter(|entry| !is_passing_name(&entry.file_name()))
        {
            let metadata = entry.metadata()?;
            size_bytes += metadata.len();
            latest_ns = latest_ns.max(modified_ns(&metadata));
            latest_change_ns = latest_change_ns.max(changed_ns(&metadata));
            modified = modified.max(metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH));
        }
        self.found.folders.push(relative.to_path_buf());
        let file = SeenFile {
            display: display_path(relative),
            relative: relative.to_path_buf(),
            size_bytes,
            modified_ns: latest_ns,
            inode: identity(&own).1,
            changed_ns: latest_change_ns,
            age: self.now.duration_since(modified).ok(),
            link_target: None,
        };
        self.found.files.push(file.into());
        Ok(())
    }
}
