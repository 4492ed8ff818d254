//! The files that state tags of runs, each read once: what is parsed is what the digest is of.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use ieap_domain::{InputHash, TagSource};
use ieap_system::fs;

/// Name of the file that tags every run of a folder.
const FOLDER_TAGS: &str = "tags.toml";

/// Largest file that is read for tags: a page of tags has some hundred bytes.
const LARGEST_BYTES: u64 = 1 << 20;

/// Tag files of a campaign as they were when they were first asked for: what is written into one later is seen by the next
/// such reading, whose digest is another one.
#[derive(Debug)]
pub struct TagFiles {
    campaign: PathBuf,
    read: RefCell<BTreeMap<PathBuf, TagFile>>,
}

/// What the system gave of a tag file.
#[derive(Debug, Clone)]
pub(super) enum TagFile {
    /// Its bytes.
    There(Rc<[u8]>),
    /// There is none.
    Absent,
    /// Kind of the error, and what the system said.
    Unreadable(String, String),
}

impl TagFiles {
    /// None is read yet.
    pub fn of(campaign: &Path) -> TagFiles {
        TagFiles {
            campaign: campaign.to_owned(),
            read: RefCell::default(),
        }
    }

    /// A digest of what the tag files of these data files (relative to the campaign) hold: another digest means that the
    /// run is to be tagged again.
    pub fn digest(&self, data_files: &[PathBuf]) -> String {
        let mut hash = InputHash::new();
        for (file, _) in data_files.iter().flat_map(|file| relative_tag_files(file)) {
            hash.bytes(file.as_os_str().as_encoded_bytes());
            match self.file(&file) {
                TagFile::There(bytes) => hash.text("there").bytes(&bytes),
                TagFile::Absent => hash.text("absent"),
                TagFile::Unreadable(kind, _) => hash.text("unreadable").text(&kind),
            };
        }
        hash.finished()
    }

    /// What the file at that place, relative to the campaign, holds.
    pub(super) fn file(&self, relative: &Path) -> TagFile {
        if let Some(known) = self.read.borrow().get(relative) {
            return known.clone();
        }
        let found = match read_limited(&self.campaign, &self.campaign.join(relative)) {
            Ok(Some(bytes)) => TagFile::There(bytes.into()),
            Ok(None) => TagFile::Absent,
            Err(error) => TagFile::Unreadable(error.kind().to_string(), error.to_string()),
        };
        self.read.borrow_mut().insert(relative.to_owned(), found.clone());
        found
    }
}

/// The files that state tags of a data file (relative to the campaign), nearest first, whether they are
/// there or not: the sidecar, then tags.toml of its folder and of each folder above inside the campaign.
pub fn tag_files_for(campaign: &Path, data_file: &Path) -> Vec<PathBuf> {
    relative_tag_files(data_file)
        .into_iter()
        .map(|(file, _)| campaign.join(file))
        .collect()
}

/// The same relative to the campaign, with what each counts as.
pub(super) fn relative_tag_files(data_file: &Path) -> Vec<(PathBuf, TagSource)> {
    let mut sidecar = data_file.as_os_str().to_owned();
    sidecar.push(".toml");
    let folders = data_file.ancestors().skip(1);
    let folder_tags = folders.map(|folder| (folder.join(FOLDER_TAGS), TagSource::Folder));
    std::iter::once((PathBuf::from(sidecar), TagSource::Sidecar))
        .chain(folder_tags)
        .collect()
}

/// The bytes of a file of tags; none where it is not there, or cannot be for its name would be longer than names may be.
fn read_limited(campaign: &Path, path: &Path) -> io::Result<Option<Vec<u8>>> {
    let mut file = match fs::File::open_stated(campaign, path) {
        Err(error)
            if matches!(
                error.kind(),
                io::ErrorKind::NotFound | io::ErrorKind::NotADirectory | io::ErrorKind::InvalidFilename
            ) =>
        {
            return Ok(None);
        }
        opened => opened?,
    };
    let size_bytes = file.metadata()?.len();
    if size_bytes > LARGEST_BYTES {
        let message = format!("it has {size_bytes} bytes, more than {LARGEST_BYTES}");
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
    }
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    Ok(Some(bytes))
}
