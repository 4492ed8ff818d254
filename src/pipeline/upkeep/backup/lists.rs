//! The lists of a backup. Every backup that was finished has one under a number of its own, which is never changed;
//! `backup.json` is the newest once more.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::contents::reason;
use super::manifest::{ENDING, FILE_NAME, LeftOut, Manifest, PREFIX, StoredFile, number_in};
use super::shelf::Shelf;
use crate::pipeline::infra::error::BackupError;
use crate::pipeline::infra::whole_file::put_own;
use crate::pipeline::{PipelineError, failed};
use crate::system::fs;

/// The lists in the folder of a backup.
#[derive(Debug, Default)]
pub struct Lists {
    /// Those that can be read, the newest first, with their names.
    pub whole: Vec<(String, Manifest)>,
    /// Names of those that cannot, with the reason.
    pub damaged: Vec<LeftOut>,
}

impl Lists {
    /// Those that have a number, in `folder`.
    ///
    /// # Errors
    /// The folder cannot be listed.
    pub fn of(folder: &Path) -> Result<Lists, PipelineError> {
        let mut lists = Lists::default();
        let entries = fs::read_dir(folder).map_err(failed(folder, "looking into it"))?;
        for entry in entries {
            let name = entry.map_err(failed(folder, "looking into it"))?.file_name();
            let name = name.to_string_lossy().into_owned();
            if number_in(&name).is_none() {
                continue;
            }
            match Manifest::read(&folder.join(&name)) {
                Ok(Some(manifest)) => lists.whole.push((name, manifest)),
                Ok(None) => {}
                Err(error) => {
                    let said = format!(
                        "{error} What only this list names stays in the backup until somebody removes it."
                    );
                    lists.damaged.push(reason(&name, &said));
                }
            }
        }
        lists
            .whole
            .sort_by_key(|(_, manifest)| std::cmp::Reverse(manifest.number));
        Ok(lists)
    }

    /// The same, once `backup.json` has a number, too: an earlier version of the program gave it none.
    ///
    /// # Errors
    /// As [`Lists::of`]; a list cannot be written.
    pub fn numbered(folder: &Path) -> Result<Lists, PipelineError> {
        let lists = Lists::of(folder)?;
        let newest = folder.join(FILE_NAME);
        match Manifest::read(&newest) {
            Ok(Some(list)) if !lists.has(list.number) => {
                put_own(&folder.join(name_of(&list)), list.text()?.as_bytes())?;
            }
            // The only one, and it cannot be read: it is not written over.
            Err(_) if lists.whole.is_empty() => {
                let aside = format!("{PREFIX}{:05}-damaged{ENDING}", lists.next_number());
                fs::rename(&newest, folder.join(aside)).map_err(failed(&newest, "giving it a number"))?;
            }
            _ => return Ok(lists),
        }
        fs::sync_names(folder).map_err(failed(folder, "bringing it to the disk"))?;
        Lists::of(folder)
    }

    fn has(&self, number: u64) -> bool {
        self.whole.iter().any(|(_, manifest)| manifest.number == number)
    }

    /// The number of the list to be.
    pub fn next_number(&self) -> u64 {
        let damaged = self.damaged.iter().filter_map(|list| number_in(&list.path));
        let whole = self.whole.iter().map(|(_, manifest)| manifest.number);
        damaged.chain(whole).max().unwrap_or(0) + 1
    }

    /// Removes all but the newest `keep` of those that can be read, and gives what only the removed ones named back to the
    /// disk. A damaged one stays: nobody knows what it names.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn keep(&mut self, keep: usize, folder: &Path, shelf: &Shelf) -> Result<(), PipelineError> {
        let removed = self.whole.split_off(keep.min(self.whole.len()));
        for (name, _) in &removed {
            let path = folder.join(name);
            fs::remove_file(&path).map_err(failed(&path, "removing"))?;
        }
        // A list is gone before anything that it names is.
        fs::sync_names(folder).map_err(failed(folder, "bringing it to the disk"))?;
        let named: BTreeSet<&str> = self.whole.iter().flat_map(|(_, list)| list.hashes()).collect();
        let gone = removed.iter().flat_map(|(_, list)| list.hashes_to_forget());
        shelf.forget(gone.filter(|hash| !named.contains(hash)))?;
        let databases: BTreeSet<&str> = self
            .whole
            .iter()
            .map(|(_, list)| list.database.path.as_str())
            .collect();
        if self.damaged.is_empty() {
            shelf.forget_databases(|name| !databases.contains(name))
        } else {
            let gone = |name: &str| removed.iter().any(|(_, list)| list.database.path == name);
            shelf.forget_databases(|name| gone(name) && !databases.contains(name))
        }
    }

    /// Notes which of them name files that the backup has lost.
    pub fn look_for_losses(&mut self, shelf: &Shelf, deep: bool) {
        for (name, list) in &self.whole {
            let is_lost = |file: &&StoredFile| !shelf.holds(&file.blake3, file.size_bytes);
            let lost = list.files.iter().filter(is_lost).map(|file| file.path.as_str());
            let database = (!shelf.holds_database(&list.database, deep)).then_some("the database");
            let lost: Vec<&str> = lost.chain(database).collect();
            if let Some(first) = lost.first() {
                let (count, made_at) = (lost.len(), &list.made_at);
                let said = format!(
                    "{count} of the files of the backup of {made_at} are missing or damaged in it: {first}"
                );
                self.damaged.push(reason(name, &said));
            }
        }
    }
}

/// Puts a list in place, safe on the disk and read back: under its number, and then as the newest. Until the last step the one
/// before it is the backup.
///
/// # Errors
/// The disk refuses, or does not give back what was written.
pub fn put(manifest: &Manifest, folder: &Path) -> Result<String, PipelineError> {
    let (name, text) = (name_of(manifest), manifest.text()?);
    for name in [name.as_str(), FILE_NAME] {
        let path = folder.join(name);
        put_own(&path, text.as_bytes())?;
        fs::sync_names(folder).map_err(failed(folder, "bringing it to the disk"))?;
        if Manifest::read(&path)?.as_ref() != Some(manifest) {
            let (folder, path) = (folder.to_owned(), name.to_owned());
            return Err(BackupError::NotAsWritten { folder, path }.into());
        }
    }
    Ok(name)
}

/// The folder of a backup and the list that is meant, by the name of either.
pub fn meant(named: &Path) -> (PathBuf, PathBuf) {
    let file = named.file_name().unwrap_or_default().to_string_lossy();
    if file == FILE_NAME || number_in(&file).is_some() {
        let folder = named.parent().filter(|folder| !folder.as_os_str().is_empty());
        (folder.unwrap_or(Path::new(".")).to_owned(), named.to_owned())
    } else {
        (named.to_owned(), named.join(FILE_NAME))
    }
}

/// What can be restored besides a list that cannot, in words; nothing where there is nothing.
pub fn others(folder: &Path, tried: &Path) -> String {
    let mut lists = Lists::of(folder).unwrap_or_default();
    lists.whole.retain(|(name, _)| folder.join(name) != tried);
    let Some((newest, _)) = lists.whole.first() else {
        return String::new();
    };
    let of = |(name, list): &(String, Manifest)| format!("{name} ({})", list.made_at);
    let all: Vec<String> = lists.whole.iter().map(of).collect();
    format!(
        " Lists of it that are whole: {}. Name one in place of the folder to restore that: `ieap restore {} NEW_FOLDER`.",
        all.join(", "),
        folder.join(newest).display()
    )
}

/// `backup-00012-20261124T000446Z.json`: numbers are in order whatever the clock showed.
fn name_of(manifest: &Manifest) -> String {
    let made_at = manifest
        .made_at
        .replace(|sign: char| !sign.is_ascii_alphanumeric(), "");
    format!("{PREFIX}{:05}-{made_at}{ENDING}", manifest.number)
}
