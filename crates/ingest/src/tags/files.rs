//! The files that state tags of runs, each read once: what is parsed is what the digest is of.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{OsStr, OsString};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::scan::{StatesFor, compared, states_for};
use ieap_domain::{InputHash, TagSource};
use ieap_system::fs;

/// Name of the file that tags every run of a folder, without its ending.
const FOLDER_TAGS: &str = "tags";

/// Largest file that is read for tags: a page of tags has some hundred bytes.
const LARGEST_BYTES: u64 = 1 << 20;

/// Tag files of a campaign as they were when they were first asked for: what is written into one later is seen by the next
/// such reading, whose digest is another one.
#[derive(Debug)]
pub struct TagFiles {
    campaign: PathBuf,
    read: Mutex<BTreeMap<PathBuf, TagFile>>,
    listed: Mutex<BTreeMap<PathBuf, Listed>>,
}

/// The statements in a folder, by what they are for.
type Statements = BTreeMap<StatesFor, Vec<Statement>>;

/// What the system listed of a folder; else kind and words of its error.
type Listed = Result<Arc<Statements>, (String, String)>;

/// A file that states something.
#[derive(Debug)]
struct Statement {
    name: OsString,
    /// The name without its ending.
    states: OsString,
    /// Whether the folder has a file of just that name: then it is for that one alone.
    has_own: bool,
}

/// What the system gave of a tag file.
#[derive(Debug, Clone)]
pub(super) enum TagFile {
    /// Its bytes.
    There(Arc<[u8]>),
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
            read: Mutex::default(),
            listed: Mutex::default(),
        }
    }

    /// A digest of what the tag files of these data files (relative to the campaign) hold: another digest means that the
    /// run is to be tagged again.
    pub fn digest(&self, data_files: &[PathBuf]) -> String {
        let mut hash = InputHash::new();
        for (file, _) in data_files.iter().flat_map(|file| self.of_file(file)) {
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
        if let Some(known) = locked(&self.read).get(relative) {
            return known.clone();
        }
        let found = match read_limited(&self.campaign, &self.campaign.join(relative)) {
            Ok(Some(bytes)) => TagFile::There(bytes.into()),
            Ok(None) => TagFile::Absent,
            Err(error) => TagFile::Unreadable(error.kind().to_string(), error.to_string()),
        };
        locked(&self.read).insert(relative.to_owned(), found.clone());
        found
    }

    /// The files that state tags of a data file, all relative to the campaign, nearest first, with what each counts as: its
    /// sidecar, then tags.toml of its folder and of each folder above inside the campaign. Where there is none it is named
    /// as it would be.
    pub fn of_file(&self, data_file: &Path) -> Vec<(PathBuf, TagSource)> {
        let mut files = Vec::new();
        if let (Some(folder), Some(name)) = (data_file.parent(), data_file.file_name()) {
            let beside = self.named(folder, StatesFor::File(compared(name)), name);
            files.extend(beside.into_iter().map(|file| (file, TagSource::Sidecar)));
        }
        for folder in data_file.ancestors().skip(1) {
            let above = self.named(folder, StatesFor::Folder, OsStr::new(FOLDER_TAGS));
            files.extend(above.into_iter().map(|file| (file, TagSource::Folder)));
        }
        files
    }

    /// The statements of a folder for the `file` of that name; the one that has just its name first, which also stands for none.
    fn named(&self, folder: &Path, states: StatesFor, file: &OsStr) -> Vec<PathBuf> {
        let mut wanted = file.to_owned();
        wanted.push(".toml");
        let listed = match self.statements(folder) {
            Ok(listed) => listed,
            Err((kind, error)) => {
                // What the system does not list is not known to be absent.
                let path = folder.join(wanted);
                let unreadable = TagFile::Unreadable(kind, format!("its folder cannot be listed: {error}"));
                locked(&self.read).insert(path.clone(), unreadable);
                return vec![path];
            }
        };
        let of = listed.get(&states).map_or(&[][..], Vec::as_slice);
        let is_it = |statement: &&Statement| !statement.has_own || statement.states == file;
        let mut names: Vec<&OsString> = of.iter().filter(is_it).map(|statement| &statement.name).collect();
        names.sort_by_key(|name| (**name != wanted, (*name).clone()));
        if names.is_empty() {
            names.push(&wanted);
        }
        names.into_iter().map(|name| folder.join(name)).collect()
    }

    /// The statements in a folder; kind and words of the error where it cannot be listed.
    fn statements(&self, folder: &Path) -> Listed {
        if let Some(known) = locked(&self.listed).get(folder) {
            return known.clone();
        }
        let listed = listed(&self.campaign.join(folder));
        locked(&self.listed).insert(folder.to_owned(), listed.clone());
        listed
    }

    /// Paths of the files that were there when they were asked for, relative to the campaign.
    pub fn there(&self) -> BTreeSet<PathBuf> {
        let read = locked(&self.read);
        let there = read.iter().filter(|(_, file)| !matches!(file, TagFile::Absent));
        there.map(|(path, _)| path.clone()).collect()
    }
}

/// The statements that the system lists in a folder.
fn listed(folder: &Path) -> Listed {
    let entries = match fs::entries(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
        Err(error) if error.kind() == io::ErrorKind::NotADirectory => Vec::new(),
        Err(error) => return Err((error.kind().to_string(), error.to_string())),
    };
    let is_folder = |entry: &fs::DirEntry| entry.file_type().is_ok_and(|kind| kind.is_dir());
    let names: BTreeSet<OsString> = entries.iter().map(fs::DirEntry::file_name).collect();
    let mut statements = Statements::new();
    for entry in entries.iter().filter(|entry| !is_folder(entry)) {
        let name = entry.file_name();
        if let Some(states) = states_for(&name) {
            let own = Path::new(&name).file_stem().unwrap_or_default().to_owned();
            statements.entry(states).or_default().push(Statement {
                has_own: names.contains(&own),
                states: own,
                name,
            });
        }
    }
    Ok(Arc::new(statements))
}

fn locked<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
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
