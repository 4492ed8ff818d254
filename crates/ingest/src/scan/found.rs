//! What a scan finds, and why there may be none.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use ieap_domain::Issue;

/// How much a scan may find before it says that the folder cannot be meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScanLimits {
    /// Most files.
    pub files: usize,
    /// Most folders in each other below the runs folder.
    pub depth: usize,
}

impl Default for ScanLimits {
    fn default() -> ScanLimits {
        ScanLimits {
            files: 1_000_000,
            depth: 64,
        }
    }
}

/// A file as the scan saw it, or a folder of frames.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeenFile {
    /// Path relative to the campaign, every byte kept.
    pub relative: PathBuf,
    /// The path as text, see [`super::display_path`]: what is stored and shown.
    pub display: String,
    /// Size, bytes.
    pub size_bytes: u64,
    /// Modification time, ns since 1970; of the link's target where the name is a link.
    pub modified_ns: i64,
    /// Number of the file in its file system; 0 where the operating system gives none.
    pub inode: u64,
    /// Time of the last change of anything of the file, rights and name included, ns since 1970; 0 where the operating
    /// system gives none.
    pub changed_ns: i64,
    /// Time since the modification; none where the modification time lies in the future.
    pub age: Option<Duration>,
    /// Where the bytes lie if the name is a link: an absolute path inside the campaign.
    pub link_target: Option<PathBuf>,
}

impl SeenFile {
    /// The path to open: the link's target, or the file itself.
    pub fn location(&self, campaign: &Path) -> PathBuf {
        match &self.link_target {
            Some(target) => target.clone(),
            None => campaign.join(&self.relative),
        }
    }
}

/// What a scan found, in the order of the paths' bytes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scan {
    /// Files that can be data.
    pub files: Vec<Arc<SeenFile>>,
    /// Files that state something of others ([`super::states_for`]).
    pub statements: Vec<Arc<SeenFile>>,
    /// Folders looked into, relative to the campaign, the runs folder first.
    pub folders: Vec<PathBuf>,
    /// Folders that could not be looked into, as text: what is known below them is not gone.
    pub unreadable: Vec<String>,
    /// Links that lead out, folders that cannot be read.
    pub issues: Vec<Issue>,
}

/// Why there is no scan at all.
#[derive(Debug, thiserror::Error)]
pub enum ScanError {
    /// The runs folder is not there: offline, not emptied.
    #[error("{}: the runs folder is not there; nothing known is taken for removed. Connect the disk or share, create the folder, or correct `folder` under [runs] in campaign.toml", path.display())]
    FolderMissing {
        /// The runs folder.
        path: PathBuf,
    },
    /// The folder cannot be read.
    #[error("{}: the folder cannot be read ({source}); give your user the right to list it", path.display())]
    FolderUnreadable {
        /// The runs folder.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The folder leads out of the campaign.
    #[error("{}: the folder is a link that leads out of the campaign; move the files in, or mount the share there", path.display())]
    FolderOutside {
        /// The runs folder.
        path: PathBuf,
    },
    /// More files than the limit.
    #[error("{}: more than {limit} files; is this the right folder? Name a smaller one under [runs] in campaign.toml", path.display())]
    TooManyFiles {
        /// The runs folder.
        path: PathBuf,
        /// The limit.
        limit: usize,
    },
}
