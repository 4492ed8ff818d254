//! Folders that the program makes as a whole: written beside their place, exchanged in one step so that a reader never
//! sees half of one, and never at the cost of a file that somebody else put there.
//!
//! A finished folder lists what was written into it, with the hash of each file. Only a folder that holds nothing else is exchanged, and what is
//! removed is removed file by file from that list: a file that comes in between is left where it is.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::ingest::archive::{hash, hash_of_file, is_hash};
use crate::pipeline::{PipelineError, failed};
use crate::system::fs;
use crate::system::passing::Passing;

/// Lists the files of a finished folder, one a line: the hash of its bytes, two blanks, its path in the folder.
const WRITTEN: &str = ".written";
/// Holds the name under which a folder may be removed: that of a folder half-made, or put aside to be removed. A copy
/// that somebody keeps under another name is so never taken for one.
const PASSING: &str = ".passing";
/// What file managers write into folders that are looked at: nobody's work. In lower case.
const OF_FILE_MANAGERS: [&str; 4] = [".ds_store", ".directory", "thumbs.db", "desktop.ini"];

/// A folder in the making, under a name of its own. It goes again when it is dropped before it was put in place.
#[derive(Debug)]
pub struct Fresh {
    path: PathBuf,
    /// Files taken over from another folder, with the hashes that they were found to have here.
    kept: Mutex<BTreeMap<String, String>>,
    /// None from the moment on in which it may be what it is to become.
    passing: Option<Passing>,
}

impl Fresh {
    /// Makes an empty folder in `parent` whose name begins with `prefix`.
    ///
    /// # Errors
    /// What the system says.
    pub fn begin(parent: &Path, prefix: &str) -> io::Result<Fresh> {
        let process = std::process::id();
        let names = (0..).map(|turn| match turn {
            0 => format!("{prefix}{process}"),
            _ => format!("{prefix}{process}-{turn}"),
        });
        for name in names {
            let path = parent.join(&name);
            match Passing::made(|| fs::create_dir(&path), |()| path.clone()) {
                Ok(((), passing)) => {
                    let fresh = Fresh {
                        path,
                        kept: Mutex::default(),
                        passing: Some(passing),
                    };
                    // First of all: whatever cuts this short, the next one knows what it may remove.
                    mark(&fresh.path, &name)?;
                    return Ok(fresh);
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    /// Where to write.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Takes files of `other` over, a finished folder on the same disk, where all of them have the hashes that are given;
    /// says whether they have, and takes none where they have not.
    ///
    /// # Errors
    /// What the system says.
    pub fn keep(&self, other: &Path, files: &[(&str, &str)]) -> io::Result<bool> {
        for (at, (name, hash)) in files.iter().enumerate() {
            if !self.take(other, name, hash)? {
                let taken = files[..at].iter();
                taken
                    .map(|(name, _)| name)
                    .try_for_each(|name| fs::remove_file(self.path.join(name)))?;
                return Ok(false);
            }
        }
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.extend(
            files
                .iter()
                .map(|(name, hash)| ((*name).to_owned(), (*hash).to_owned())),
        );
        Ok(true)
    }

    fn take(&self, other: &Path, name: &str, hash: &str) -> io::Result<bool> {
        let (from, to) = (other.join(name), self.path.join(name));
        if fs::hard_link(&from, &to).is_err() {
            // File systems without a second name for a file: its bytes.
            let Ok(bytes) = fs::read_own(&from) else {
                return Ok(false);
            };
            fs::write(&to, bytes)?;
        }
        // Looked at here, where nobody exchanges it any more.
        let is_same = hash_of_file(&to).is_ok_and(|(found, _)| found == hash);
        if !is_same {
            fs::remove_file(&to)?;
        }
        Ok(is_same)
    }

    /// Lists what was written, and brings all of it to the disk: from here on the folder is whole.
    ///
    /// # Errors
    /// What the system says.
    pub fn finish(&self) -> io::Result<()> {
        let entries = entries(&self.path)?;
        let files = entries.iter().filter(|entry| !entry.is_dir);
        let names: Vec<&str> = files
            .map(|entry| entry.name.as_str())
            .filter(|name| *name != PASSING)
            .collect();
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let line = |name: &&str| {
            let hash = match kept.get(*name) {
                Some(hash) => hash.clone(),
                None => hash_of_file(&self.path.join(name))?.0,
            };
            Ok(format!("{hash}  {name}\n"))
        };
        let lines: io::Result<Vec<String>> = names.par_iter().map(line).collect();
        fs::write(self.path.join(WRITTEN), lines?.concat())?;
        sync_all(&self.path, &entries)
    }

    /// Puts the folder where `target` is, in one step, and removes what was there. `is_earlier` says whether a folder
    /// without a list is one that an earlier version of the program wrote.
    ///
    /// # Errors
    /// [`PipelineError::NotOurs`] where `target` holds what the program did not write; what the system says. `target`
    /// is then what it was, or the new folder.
    pub fn put(mut self, target: &Path, is_earlier: &dyn Fn(&Path) -> bool) -> Result<(), PipelineError> {
        check(target, is_earlier)?;
        self.passing = None;
        let failed = failed(target, "putting the folder in place");
        self.exchange_with(target).map_err(failed)
    }

    fn exchange_with(&self, target: &Path) -> io::Result<()> {
        let parent = parent_of(target);
        if !fs::exists(target)? {
            fs::rename(&self.path, target)?;
            fs::sync_names(parent)?;
            return fs::remove_file(target.join(PASSING));
        }
        let before = listed_or_all(target)?;
        mark(target, &fs::read_own_text(self.path.join(PASSING))?)?;
        let aside = match fs::exchange(&self.path, target) {
            Ok(()) => self.path.clone(),
            Err(_) => {
                // File systems without an exchange: a moment without a folder, never half a folder.
                let aside = self.path.with_extension(ASIDE);
                fs::rename(target, &aside)?;
                fs::rename(&self.path, target)?;
                aside
            }
        };
        // The names are exchanged on the disk before the old folder loses a file: it may be the one that is there after a
        // loss of power.
        fs::sync_names(parent)?;
        fs::remove_file(target.join(PASSING))?;
        remove_listed(&aside, &before)
    }
}

impl Drop for Fresh {
    fn drop(&mut self) {
        if is_passing(&self.path) {
            let _ = fs::remove_dir_all(&self.path);
        }
    }
}

/// Ending of the name of a folder that was put aside where the file system cannot exchange two.
const ASIDE: &str = "old";

/// Refuses where `folder` holds what the program did not write. One that is not there, or empty, is no obstacle.
///
/// # Errors
/// [`PipelineError::NotOurs`] with the first file that is not ours; or the folder cannot be read.
pub fn check(folder: &Path, is_earlier: &dyn Fn(&Path) -> bool) -> Result<(), PipelineError> {
    let found = foreign(folder, is_earlier).map_err(failed(folder, "looking whose files are in it"))?;
    match found {
        None => Ok(()),
        Some(found) => Err(PipelineError::NotOurs {
            folder: folder.to_owned(),
            found,
        }),
    }
}

fn foreign(folder: &Path, is_earlier: &dyn Fn(&Path) -> bool) -> io::Result<Option<PathBuf>> {
    match fs::symlink_metadata(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
        // A link leads to what is not ours to replace.
        Ok(found) if !found.is_dir() => return Ok(Some(folder.to_owned())),
        Ok(_) => {}
    }
    let known = listed(folder)?;
    let entries = entries(folder);
    if listed(folder)? != known {
        // Exchanged for another one meanwhile.
        return foreign(folder, is_earlier);
    }
    let entries = entries?;
    if known.is_none() && is_earlier(folder) {
        return Ok(None);
    }
    let listed = known.unwrap_or_default();
    // A folder is as good as what is in it.
    let is_ours = |entry: &&Entry| {
        entry.is_dir || entry.is_file && (listed.contains_key(&entry.name) || is_nobodys(&entry.name))
    };
    let other = entries.iter().find(|entry| !is_ours(entry));
    Ok(other.map(|entry| folder.join(&entry.name)))
}

/// Whether a file at that path in a folder is the program's own note, or a file manager's.
fn is_nobodys(name: &str) -> bool {
    let last = name.rsplit('/').next().unwrap_or(name).to_lowercase();
    name == WRITTEN || name == PASSING || OF_FILE_MANAGERS.contains(&last.as_str())
}

/// The files that a finished folder lists with the hashes of what was written, which earlier versions did not list; none where it
/// has no list.
fn listed(folder: &Path) -> io::Result<Option<BTreeMap<String, Option<String>>>> {
    let text = match fs::read_own_text(folder.join(WRITTEN)) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => {
            let said = format!("{WRITTEN}, the list of what was written into it, cannot be read: {error}");
            return Err(io::Error::new(error.kind(), said));
        }
    };
    let of_line = |line: &str| match line.split_once("  ").filter(|(hash, _)| is_hash(hash)) {
        Some((hash, name)) => (name.to_owned(), Some(hash.to_owned())),
        None => (line.to_owned(), None),
    };
    let lines = text.lines().filter(|line| !line.is_empty());
    Ok(Some(lines.map(of_line).collect()))
}

/// Whether the hashes of what was written into a folder are known.
pub fn is_hashed(folder: &Path) -> bool {
    listed(folder).is_ok_and(|listed| listed.is_some_and(|files| files.values().all(Option::is_some)))
}

/// The files of a finished folder with the hashes of what was written; empty where these are not known.
///
/// # Errors
/// The list cannot be read.
pub fn hashes(folder: &Path) -> io::Result<BTreeMap<String, String>> {
    let listed = listed(folder)?.unwrap_or_default().into_iter();
    Ok(listed.filter_map(|(name, hash)| Some((name, hash?))).collect())
}

/// The bytes of a file of a finished folder, where they are those that were written.
pub fn as_written(folder: &Path, name: &str) -> Option<Vec<u8>> {
    let written = hashes(folder).ok()?.remove(name)?;
    let bytes = fs::read_own(folder.join(name)).ok()?;
    (hash(&bytes) == written).then_some(bytes)
}

/// What became of a file that was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Altered {
    /// It is not there.
    Missing,
    /// Its bytes are others.
    Changed,
    /// The system does not give it, for this reason.
    Unreadable(String),
}

/// Files of a finished folder that are not as they were written, by their paths in it. Where the folder is exchanged for
/// another one meanwhile, that one is looked at.
///
/// # Errors
/// The list cannot be read.
pub fn altered(folder: &Path) -> io::Result<Vec<(String, Altered)>> {
    let mut known = listed(folder)?;
    loop {
        let found = altered_of(folder, known.clone().unwrap_or_default());
        let now = listed(folder)?;
        if found.is_empty() || now == known {
            return Ok(found);
        }
        known = now;
    }
}

fn altered_of(folder: &Path, listed: BTreeMap<String, Option<String>>) -> Vec<(String, Altered)> {
    let look = |(name, hash): (String, Option<String>)| {
        let found = match hash_of_file(&folder.join(&name)) {
            Ok((found, _)) if hash.is_none_or(|hash| hash == found) => return None,
            Ok(_) => Altered::Changed,
            Err(error) if error.kind() == io::ErrorKind::NotFound => Altered::Missing,
            Err(error) => Altered::Unreadable(error.to_string()),
        };
        Some((name, found))
    };
    listed.into_par_iter().filter_map(look).collect()
}

/// The names of the files that a folder lists; of a folder without a list, which was looked through before, all that is in it.
fn listed_or_all(folder: &Path) -> io::Result<BTreeSet<String>> {
    if let Some(listed) = listed(folder)? {
        return Ok(listed.into_keys().collect());
    }
    let files = entries(folder)?.into_iter().filter(|entry| entry.is_file);
    Ok(files.map(|entry| entry.name).collect())
}

/// Removes those files, the program's own notes and the folders that are empty then. What else is there stays.
fn remove_listed(folder: &Path, listed: &BTreeSet<String>) -> io::Result<()> {
    let entries = entries(folder)?;
    let is_note = |name: &str| name == WRITTEN || name == PASSING;
    let goes = |entry: &&Entry| entry.is_file && (listed.contains(&entry.name) || is_nobodys(&entry.name));
    for entry in entries.iter().filter(goes).filter(|entry| !is_note(&entry.name)) {
        fs::remove_file(folder.join(&entry.name))?;
    }
    for entry in entries.iter().rev().filter(|entry| entry.is_dir) {
        let _ = fs::remove_dir(folder.join(&entry.name));
    }
    // The mark last: a removal that is cut short is gone on with.
    for note in [WRITTEN, PASSING] {
        match fs::remove_file(folder.join(note)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    match fs::remove_dir(folder) {
        // Somebody's file came in: it stays, with the folder.
        Err(error) if error.kind() == io::ErrorKind::DirectoryNotEmpty => Ok(()),
        outcome => outcome,
    }
}

/// Removes what was cut short in `parent` under names with that prefix: folders with our mark, and empty ones. Gives
/// those that stay: they look like one and carry no mark, or cannot be removed.
pub fn remove_leftovers(parent: &Path, prefix: &str) -> Vec<PathBuf> {
    let mut kept = Vec::new();
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some(rest) = name.strip_prefix(prefix) else {
            continue;
        };
        let path = entry.path();
        if !entry.file_type().is_ok_and(|kind| kind.is_dir()) || fs::remove_dir(&path).is_ok() {
            continue;
        }
        if is_passing(&path) || is_just_begun(&path) {
            let _ = match listed(&path) {
                Ok(Some(listed)) => remove_listed(&path, &listed.into_keys().collect()),
                Ok(None) => fs::remove_dir_all(&path),
                // Nobody knows what was written into it: another try may tell.
                Err(_) => Ok(()),
            };
            if path.exists() {
                kept.push(path);
            }
        } else if rest
            .trim_end_matches(".old")
            .bytes()
            .all(|byte| byte.is_ascii_digit())
        {
            kept.push(path);
        }
    }
    kept
}

/// The folder that a file or folder lies in, which has no name in a path of one name.
fn parent_of(path: &Path) -> &Path {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    parent.unwrap_or(Path::new("."))
}

/// Marks a folder as one that may be removed under the name `may_have`; the mark is on the disk when this returns.
fn mark(folder: &Path, may_have: &str) -> io::Result<()> {
    let path = folder.join(PASSING);
    fs::write(&path, may_have)?;
    fs::File::open_own(&path)?.sync_all()?;
    fs::sync_names(folder)
}

/// Brings a folder with all that is in it to the disk.
#[cfg(target_os = "linux")]
fn sync_all(folder: &Path, _entries: &[Entry]) -> io::Result<()> {
    fs::File::open(folder)?.sync_file_system()
}

/// Brings a folder with all that is in it to the disk.
#[cfg(not(target_os = "linux"))]
fn sync_all(folder: &Path, entries: &[Entry]) -> io::Result<()> {
    let paths = entries.iter().map(|entry| folder.join(&entry.name));
    let mut files = paths.chain([folder.join(WRITTEN)]).filter(|path| path.is_file());
    files.try_for_each(|path| fs::File::open_own(path)?.sync_all())?;
    fs::sync_names(folder)
}

/// Whether a folder carries the mark that it may be removed under the name that it has.
fn is_passing(folder: &Path) -> bool {
    let name = folder
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let marked = fs::read_own_text(folder.join(PASSING));
    marked.is_ok_and(|marked| name == marked || name == format!("{marked}.{ASIDE}"))
}

/// Whether a folder holds the mark alone, which then may be torn: nothing is written before the mark is on the disk.
fn is_just_begun(folder: &Path) -> bool {
    entries(folder).is_ok_and(|entries| entries.iter().all(|entry| entry.name == PASSING && entry.is_file))
}

/// Something in a folder.
struct Entry {
    /// Its path in the folder, with `/`.
    name: String,
    is_dir: bool,
    /// Whether it is a plain file, no link.
    is_file: bool,
}

/// Everything in a folder and below it, a folder before what is in it. Links are not followed.
fn entries(folder: &Path) -> io::Result<Vec<Entry>> {
    let mut found = Vec::new();
    let mut waiting = vec![String::new()];
    while let Some(below) = waiting.pop() {
        for entry in fs::read_dir(folder.join(&below))? {
            let entry = entry?;
            let kind = entry.file_type()?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let name = match below.as_str() {
                "" => name,
                below => format!("{below}/{name}"),
            };
            if kind.is_dir() {
                waiting.push(name.clone());
            }
            found.push(Entry {
                name,
                is_dir: kind.is_dir(),
                is_file: kind.is_file(),
            });
        }
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
}

#[cfg(test)]
mod tests;
