//! What the database knows of files, held against what lies in the folder.

use std::collections::{BTreeMap, BTreeSet};

use super::prepare::LARGEST_FILE_BYTES;
use super::statements::is_statement;
use super::{Readers, now};
use crate::ingest::archive;
use crate::ingest::scan::{self, Changes, Known, SeenFile};
use crate::pipeline::intake::climate::log_folders;
use crate::pipeline::{Context, PipelineError};
use crate::store::FileRow;

/// Number of files that would be read, or that have gone, without a change of anything.
///
/// # Errors
/// The folder cannot be listed, or the database cannot be read.
pub fn files_due(context: &Context) -> Result<usize, PipelineError> {
    let runs_folder = &context.campaign.runs_folder;
    let mut optional = context.campaign.optional_folders().to_vec();
    optional.extend(log_folders(runs_folder));
    let seen = scan::scan(
        &context.folder,
        runs_folder,
        &optional,
        scan::ScanLimits::default(),
    )?;
    let mut stored = context.store.files()?;
    stored.retain(|file| !is_statement(&file.path));
    let changes = scan::diff(&known(&stored), &seen);
    let listed: BTreeSet<&String> = seen.issues.iter().map(|issue| &issue.place).collect();
    let gone = changes.gone.iter().filter(|path| !listed.contains(path)).count();
    let outdated = Readers::of(&context.profiles, &context.campaign, &stored);
    let outdated = outdated.outdated(&stored);
    let orphans = context.store.orphaned_aliases()?;
    let orphans: BTreeSet<&str> = orphans.iter().map(String::as_str).collect();
    let unchanged = changes.unchanged.iter().map(|file| file.display.as_str());
    let again = unchanged
        .filter(|path| outdated.contains(path) || orphans.contains(path))
        .count();
    let stored: BTreeMap<&str, &FileRow> = stored.iter().map(|file| (&*file.path, file)).collect();
    let changed = changes.changed.iter();
    let changed = changed.filter(|file| {
        let row = stored.get(file.display.as_str());
        outdated.contains(file.display.as_str()) || row.is_none_or(|row| has_other_bytes(context, file, row))
    });
    Ok(changes.new.len() + changed.count() + gone + again)
}

/// Whether a file that has another time or place on the disk has other bytes, too: a copy of a campaign has all its files so.
fn has_other_bytes(context: &Context, file: &SeenFile, row: &FileRow) -> bool {
    let read = (context.read_file)(&file.location(&context.folder), LARGEST_FILE_BYTES);
    let hash = read.ok().map(|bytes| archive::hash(&bytes));
    row.missing_since.is_some() || hash.is_none() || hash != row.hash
}

pub fn known(stored: &[FileRow]) -> Vec<Known<'_>> {
    fn known(file: &FileRow) -> Known<'_> {
        Known {
            display: &file.path,
            size_bytes: file.size_bytes,
            modified_ns: file.modified_ns,
            inode: file.inode,
            changed_ns: file.changed_ns,
            missing: file.missing_since.is_some(),
        }
    }
    stored.iter().map(known).collect()
}

/// Completes what was stored before times of last changes were, without reading the files.
pub(super) fn note_change_times(
    context: &mut Context,
    stored: &[FileRow],
    changes: &Changes,
) -> Result<(), PipelineError> {
    let unknown: BTreeSet<&str> = stored
        .iter()
        .filter(|file| file.changed_ns == 0)
        .map(|file| file.path.as_str())
        .collect();
    let unchanged = changes.unchanged.iter().filter(|file| file.changed_ns != 0);
    let times: Vec<(&str, i64)> = unchanged
        .filter(|file| unknown.contains(file.display.as_str()))
        .map(|file| (file.display.as_str(), file.changed_ns))
        .collect();
    Ok(context.store.note_change_times(&now(), &times)?)
}

/// Files that were another name of a run or log whose content is another one now; each is tried once in a round.
#[derive(Debug, Default)]
pub(super) struct Orphans {
    tried: BTreeSet<String>,
}

impl Orphans {
    /// Those that there are now, of the paths that are `wanted`.
    pub fn next(
        &mut self,
        context: &Context,
        wanted: impl Fn(&str) -> bool,
    ) -> Result<BTreeSet<String>, PipelineError> {
        let mut found: BTreeSet<String> = context.store.orphaned_aliases()?.into_iter().collect();
        found.retain(|path| wanted(path) && self.tried.insert(path.clone()));
        Ok(found)
    }
}
