//! Which files of a campaign a backup holds: raw files of the archive, what people wrote, and the data files themselves.
//!
//! Left out are the report, which is made from the rest, and pictures of frames, which are a thousand times larger than
//! what was traced from them; these are told.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

use super::blobs::Blobs;
use super::manifest::{LeftOut, Manifest, StoredFile};
use crate::ingest::campaign_file;
use crate::ingest::profiles;
use crate::ingest::scan::{self, Scan, SeenFile, display_path, is_passing_name, states_for};
use crate::pipeline::intake::climate::log_folders;
use crate::pipeline::{Context, PipelineError};
use crate::store::{FileRow, Store};
use crate::system::fs;

/// What is said of a file of which an earlier copy is at hand.
pub const IN_ITS_PLACE: &str = "an earlier copy of it is in the backup in its place";

/// How the campaign's own folder is named.
const ITSELF: &str = ".";

/// What is said of a folder that need not be there. Where the earlier list has files of it, it is out of sight and not gone.
const NOT_THERE: &str = "the folder is not there; make an empty one if its files are not wanted any more";

/// What is not in a backup.
#[derive(Debug, Default)]
pub struct Omitted {
    /// What is never backed up.
    pub never: Vec<LeftOut>,
    /// What could not be read now: files, and folders with all in them.
    pub unread: Vec<LeftOut>,
}

impl Omitted {
    /// The files of the earlier list that could not be read now: a copy of yesterday is better than none.
    pub fn of_earlier(
        &mut self,
        earlier: Option<&Manifest>,
        now: &[StoredFile],
        blobs: &Blobs,
    ) -> Vec<StoredFile> {
        let known: BTreeSet<&str> = now.iter().map(|file| file.path.as_str()).collect();
        let at_hand = |file: &&StoredFile| {
            !known.contains(file.path.as_str()) && blobs.holds(&file.blake3, file.size_bytes)
        };
        let mut taken = Vec::new();
        for file in earlier.iter().flat_map(|list| &list.files).filter(at_hand) {
            let holds = |left: &&mut LeftOut| {
                let below = file.path.strip_prefix(left.path.as_str());
                below.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
                    || left.path == ITSELF && !file.path.contains('/')
            };
            let Some(left) = self.unread.iter_mut().find(holds) else {
                continue;
            };
            if !left.reason.ends_with(IN_ITS_PLACE) {
                left.reason = format!("{}; {IN_ITS_PLACE}", left.reason);
            }
            taken.push(file.clone());
        }
        self.unread.retain(|left| left.reason != NOT_THERE);
        taken
    }

    /// All of it, by path.
    pub fn sorted(self) -> Vec<LeftOut> {
        let mut all = [self.never, self.unread].concat();
        all.sort();
        all
    }
}

/// A file that belongs to a backup.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    /// Path as the scan displays it.
    pub path: String,
    /// Where its bytes lie.
    pub location: PathBuf,
    /// Size, bytes, where the hash is known.
    pub size_bytes: u64,
    /// BLAKE3 of its bytes where that is known without reading it.
    pub hash: Option<String>,
    /// Modification time, ns since 1970.
    pub modified_ns: i64,
}

/// What people wrote and measured, by path, but for raw files of the archive.
///
/// # Errors
/// The database cannot be read.
pub fn listed(context: &Context, copy: &Store, omitted: &mut Omitted) -> Result<Vec<Wanted>, PipelineError> {
    let stored: BTreeMap<String, FileRow> = (copy.files()?.into_iter())
        .map(|row| (row.path.clone(), row))
        .collect();
    let mut found = BTreeMap::new();
    let mut add = |wanted: Wanted| {
        found.insert(wanted.path.clone(), wanted);
    };
    let root = &context.folder;
    let own = statement(root, Path::new(campaign_file::FILE_NAME), &mut omitted.unread);
    own.into_iter().for_each(&mut add);
    for folder in ["", profiles::FOLDER] {
        statements(root, Path::new(folder), &mut omitted.unread)
            .into_iter()
            .for_each(&mut add);
    }
    let runs_folder = &context.campaign.runs_folder;
    let mut optional = context.campaign.optional_folders().to_vec();
    optional.extend(log_folders(runs_folder));
    // Whatever campaign.toml says now: where files were taken in from they are.
    for path in stored.keys() {
        let mut folders = optional.iter().copied().chain([runs_folder.as_str()]);
        let is_seen = folders.any(|folder| Path::new(path).starts_with(folder));
        if let (false, Some((folder, _))) = (is_seen, path.split_once('/')) {
            optional.push(folder);
        }
    }
    match of_one_moment(|| scan::scan(root, runs_folder, &optional, scan::ScanLimits::default())) {
        Ok((seen, is_settled)) => {
            if !is_settled {
                let why =
                    "files in it came, went or got other names while it was listed; make a backup again";
                omitted.unread.push(reason(runs_folder, why));
            }
            // Links among them, which a scan does not follow, are told.
            for folder in &seen.folders {
                let stated = statements(root, folder, &mut omitted.unread);
                stated.into_iter().for_each(&mut add);
            }
            for path in &seen.unreadable {
                // Where the system cannot tell, it may well be there.
                let is_gone = matches!(fs::exists(root.join(path)), Ok(false));
                let why = if is_gone {
                    NOT_THERE
                } else {
                    "it cannot be looked into"
                };
                omitted.unread.push(reason(path, why));
            }
            for file in &seen.files {
                if file.location(root).is_dir() {
                    let why = "pictures of frames are not backed up, what was traced from them is; copy the folder by hand";
                    omitted.never.push(reason(&file.display, why));
                } else {
                    add(data_file(root, file, stored.get(&file.display)));
                }
            }
        }
        // The database and the archive are worth a copy without them.
        Err(error) => omitted.unread.push(reason(runs_folder, &error.to_string())),
    }
    Ok(found.into_values().collect())
}

/// Times at most that folders are listed for a backup. Chosen: names that change as often are written just now.
const MOST_LISTINGS: usize = 4;

/// What folders hold at one moment: a file that is renamed while they are listed may be in none of them, so that they are
/// listed until two listings in a row say the same. Says whether they did.
fn of_one_moment<E>(list: impl Fn() -> Result<Scan, E>) -> Result<(Scan, bool), E> {
    let names = |seen: &Scan| -> BTreeSet<String> {
        let files = seen.files.iter().chain(&seen.statements);
        let files = files.map(|file| file.display.clone());
        files.chain(seen.unreadable.iter().cloned()).collect()
    };
    let mut before = list()?;
    for _ in 1..MOST_LISTINGS {
        let now = list()?;
        if names(&now) == names(&before) {
            return Ok((now, true));
        }
        before = now;
    }
    Ok((before, false))
}

pub(super) fn reason(path: &str, reason: &str) -> LeftOut {
    LeftOut {
        path: path.to_owned(),
        reason: reason.to_owned(),
    }
}

/// A data file; its hash is that of the database where the file is as the database knows it.
fn data_file(root: &Path, file: &SeenFile, row: Option<&FileRow>) -> Wanted {
    let is_known = |row: &&FileRow| {
        row.size_bytes == file.size_bytes
            && row.modified_ns == file.modified_ns
            && row.inode == file.inode
            && row.changed_ns == file.changed_ns
    };
    Wanted {
        path: file.display.clone(),
        location: file.location(root),
        size_bytes: file.size_bytes,
        hash: row.filter(is_known).and_then(|row| row.hash.clone()),
        modified_ns: file.modified_ns,
    }
}

/// Files of a folder that state tags or profiles.
fn statements(root: &Path, folder: &Path, unread: &mut Vec<LeftOut>) -> Vec<Wanted> {
    let entries = match fs::entries(root.join(folder)) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
        Err(error) => {
            let why = format!("it cannot be listed, and the tag files in it are not known: {error}");
            unread.push(reason(&shown(folder), &why));
            Vec::new()
        }
    };
    let named = entries.into_iter().filter(|entry| {
        let name = entry.file_name();
        // What is no file, and a link that leads nowhere, is told when it is read.
        states_for(&name).is_some() && !is_passing_name(&name) && !entry.path().is_dir()
    });
    named
        .filter_map(|entry| statement(root, &folder.join(entry.file_name()), unread))
        .collect()
}

/// A folder as people name it: the campaign's own is none below itself.
fn shown(folder: &Path) -> String {
    if folder == Path::new("") {
        ITSELF.to_owned()
    } else {
        display_path(folder)
    }
}

/// None where it is a link that leads out of the campaign, which is told.
fn statement(root: &Path, relative: &Path, unread: &mut Vec<LeftOut>) -> Option<Wanted> {
    // A link keeps no meaning elsewhere: what it leads to is kept.
    let location = root.join(relative);
    let location = match fs::canonicalize_within(root, &location) {
        Ok(real) => real,
        Err(error) if error.kind() == io::ErrorKind::InvalidInput => {
            unread.push(reason(&display_path(relative), &error.to_string()));
            return None;
        }
        // What is not there, or cannot be reached, is told when it is read.
        Err(_) => location,
    };
    Some(Wanted {
        path: display_path(relative),
        location,
        size_bytes: 0,
        hash: None,
        modified_ns: 0,
    })
}
