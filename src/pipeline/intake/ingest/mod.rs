//! Takes in what is new in the campaign folder: scan, read, tag, archive, store. Idempotent.

mod batch;
mod continues;
mod copies;
pub(crate) mod frame_folder;
pub(crate) mod groups;
mod known;
mod left_out;
mod moves;
pub(crate) mod pairs;
mod places;
mod prepare;
mod readers;
mod retag;
mod rows;
mod settle;
mod start;
pub(crate) mod statements;
mod summary;
pub(crate) mod tagging;
pub(crate) mod unread;
pub(crate) mod waiting;
mod window;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::climate::{self, Shelf, holds_logs, is_below, log_folders};
use crate::domain::{FileState, Issue, RunKind};
use crate::ingest::scan::{self, Changes, Scan, SeenFile};
use crate::ingest::tags::{TagFiles, UNREAD_STATEMENT};
use crate::pipeline::campaign::context::now;
use crate::pipeline::campaign::{planned, standing};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::FileRow;
use batch::in_batches;
use known::{Orphans, note_change_times};
use prepare::{Group, not_read_now};
pub(crate) use readers::Readers;
use statements::{Statements, is_statement};

pub(crate) use batch::together;
pub use known::files_due;
pub(crate) use known::known;
pub(crate) use prepare::{
    LARGEST_FILE_BYTES, Outcome, PreparedFile, RunPart, With, prepare_bytes, run_parts,
};
pub(crate) use retag::retag_named;
pub use retag::retag_runs;
pub(crate) use rows::{content_of, file_row, set_aside};
pub(crate) use settle::{files_of_runs, runs_of};
pub use summary::{IngestSummary, UnreadableTags};
pub use window::run_window;

/// The verb `ingest`; [the library](crate) has an example.
pub struct Ingest<'a> {
    /// Says whether a file may be read now; one that may not waits for the next time.
    pub ready: &'a mut dyn FnMut(&SeenFile) -> bool,
}

/// What cannot be read of the tag files of a campaign.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn unreadable_tags(context: &Context) -> Result<Vec<UnreadableTags>, PipelineError> {
    let found = context.store.unreadable_tag_files()?.into_iter();
    Ok(found
        .map(|(issue, runs)| UnreadableTags { issue, runs })
        .collect())
}

impl Ingest<'_> {
    /// Takes in what is new; what cannot be read is refused and listed, and the rest goes on.
    ///
    /// # Errors
    /// The folder cannot be listed, the archive or the database refuses.
    pub fn run(
        &mut self,
        context: &mut Context,
        observer: &dyn Observer,
    ) -> Result<IngestSummary, PipelineError> {
        context
            .store
            .put_shown_of_kind(&standing::shown_samples(&context.campaign))?;
        let runs_folder = context.campaign.runs_folder.clone();
        let mut seen = scan::scan(
            &context.folder,
            &runs_folder,
            &context.campaign.optional_folders(),
            scan::ScanLimits::default(),
        )?;
        let mut statements = Statements::default();
        statements.take(&mut seen);
        let of_logs = |path: &str| holds_logs(path, &runs_folder);
        // Where the runs folder is the whole campaign, the logs lie in it.
        seen.files.retain(|file| !of_logs(&file.display));
        let known_files = context.store.files()?.into_iter();
        let (stated, files): (Vec<FileRow>, Vec<FileRow>) =
            known_files.partition(|file| is_statement(&file.path));
        let (logs, stored): (Vec<FileRow>, Vec<FileRow>) =
            files.into_iter().partition(|file| of_logs(&file.path));
        context.stated = TagFiles::of(&context.folder);
        let mut summary = IngestSummary {
            files: seen.files.len(),
            ..IngestSummary::default()
        };
        let of_runs = |path: &str| !of_logs(path) && !is_statement(path);
        let looked = named_by_bytes(context, (&seen, stored), (&of_runs, FileState::Run), observer)?;
        let (stored, changes) = (looked.stored, looked.changes);
        summary.renamed = looked.renamed.names;
        summary.replaced = looked.renamed.replaced;
        let readers = Readers::of(&context.profiles, &context.campaign, &stored);
        // Logs first, so that runs are tagged with them at once.
        for folder in log_folders(&runs_folder) {
            let (logs, _): (Vec<FileRow>, Vec<FileRow>) = logs
                .iter()
                .cloned()
                .partition(|file| is_below(&file.path, folder));
            let taken = self.take_logs(context, (folder, &logs), &mut summary, observer)?;
            match taken {
                Some(mut seen) => statements.take(&mut seen),
                None => statements.out_of_sight(folder),
            }
        }
        let shelf = Shelf::open(&context.store)?;
        let kind_of = |path: &str| context.campaign.kind_of(path);
        context.sheets = planned::sheets_now(context, &stored, &seen, &changes);
        let pairs = pairs::stored_pairs(context)?;
        let ready = self.ready_files(&readers, &stored, &changes, &mut summary);
        let due: BTreeSet<&str> = ready.into_iter().map(|file| file.display.as_str()).collect();
        let mut groups = groups_with(&|path| due.contains(path), (&seen, &pairs), kind_of, &summary);
        let mut orphans = Orphans::default();
        loop {
            observer.begin("reading", groups.len() as u64);
            let mended = in_batches(context, &groups, observer, &mut |context, prepared, observer| {
                let with = (&readers, &shelf);
                settle::settle(context, with, prepared, &changes, &mut summary, observer)
            })?;
            summary.mended.extend(mended);
            observer.end();
            // Where a run has new content, another file that held the old one is a run by itself now.
            let orphans = orphans.next(context, |path| !of_logs(path))?;
            if orphans.is_empty() {
                break;
            }
            let kind_of = |path: &str| context.campaign.kind_of(path);
            groups = groups_with(&|path| orphans.contains(path), (&seen, &pairs), kind_of, &summary);
        }
        settle::gone(context, &readers, &stored, &changes, &seen, &mut summary)?;
        pairs::settle_pairs(context, (&readers, &shelf), &seen, &mut summary, observer)?;
        // The lists of a large folder do not stand beside those that tagging needs.
        drop((groups, changes, seen, stored));
        // What runs of the same readings are tagged with is known together.
        summary.copies = copies::find_copies(context, observer)?;
        // A run sheet that could not be read is in doubt when runs are tagged.
        keep_unread(context, &mut summary)?;
        retag::retag_runs(context, &mut summary, observer)?;
        statements.settle(context, &stated)?;
        climate::assess(context, &shelf)?;
        list_states(context, &mut summary)?;
        Ok(summary)
    }

    /// Takes in what is new among the logs of a folder; gives what it saw. A folder that cannot be looked through costs the
    /// logs, not the runs.
    fn take_logs(
        &mut self,
        context: &mut Context,
        (folder, stored): (&str, &[FileRow]),
        summary: &mut IngestSummary,
        observer: &dyn Observer,
    ) -> Result<Option<Scan>, PipelineError> {
        let seen = match scan::scan(&context.folder, folder, &[], scan::ScanLimits::default()) {
            Ok(seen) => seen,
            Err(scan::ScanError::FolderMissing { .. }) if stored.is_empty() => {
                return Ok(Some(Scan::default()));
            }
            Err(scan::ScanError::FolderMissing { path }) => {
                let path = path.display();
                observer.warn(&format!(
                    "{path} is not there; the climate logs known from it stay"
                ));
                return Ok(None);
            }
            Err(error) => {
                let message = format!("the logs in it are not looked at: {error}");
                let issue = not_read_now(&message);
                summary.unread.push((folder.to_owned(), issue));
                return Ok(None);
            }
        };
        let of_folder = |path: &str| is_below(path, folder) && !is_statement(path);
        let looked = named_by_bytes(
            context,
            (&seen, stored.to_vec()),
            (&of_folder, FileState::Log),
            observer,
        )?;
        let (stored, changes) = (&looked.stored[..], looked.changes);
        summary.logs.renamed.extend(looked.renamed.names);
        summary.logs.files += seen.files.len();
        let readers = Readers::of(&context.profiles, &context.campaign, stored);
        let ready = self.ready_files(&readers, stored, &changes, summary);
        let group = |file: &Arc<SeenFile>| Group {
            run_name: file.display.clone(),
            kind: RunKind::Actuation,
            files: vec![Arc::clone(file)],
        };
        let mut groups: Vec<Group> = ready.into_iter().map(group).collect();
        let mut orphans = Orphans::default();
        loop {
            observer.begin("reading climate logs", groups.len() as u64);
            let mended = in_batches(context, &groups, observer, &mut |context, prepared, observer| {
                prepared.files.iter().try_for_each(|file| {
                    climate::settle_log(context, &readers, file, &mut summary.logs, observer)
                })
            })?;
            summary.mended.extend(mended);
            observer.end();
            let orphans = orphans.next(context, |path| is_below(path, folder))?;
            if orphans.is_empty() {
                break;
            }
            let found = seen.files.iter().filter(|file| orphans.contains(&file.display));
            groups = found.map(group).collect();
        }
        settle::gone(context, &readers, stored, &changes, &seen, summary)?;
        Ok(Some(seen))
    }

    /// Files that may be read now: new or changed ones, and those that another version of a reader read. The others
    /// of these wait.
    fn ready_files<'c>(
        &mut self,
        readers: &Readers,
        stored: &[FileRow],
        changes: &'c Changes,
        summary: &mut IngestSummary,
    ) -> Vec<&'c Arc<SeenFile>> {
        let outdated = readers.outdated(stored);
        let unchanged = changes.unchanged.iter();
        let retry = unchanged.filter(|file| outdated.contains(file.display.as_str()));
        let found = changes.new.iter().chain(&changes.changed).chain(retry);
        let (ready, waiting): (Vec<_>, Vec<_>) = found.partition(|file| (self.ready)(file));
        summary
            .waiting
            .extend(waiting.into_iter().map(|file| file.display.clone()));
        ready
    }
}

/// What is stored of files and how it differs from what a scan saw, when runs or logs have the names of the files that hold
/// their bytes.
struct Looked {
    stored: Vec<FileRow>,
    changes: Changes,
    renamed: moves::Renamed,
}

fn named_by_bytes(
    context: &mut Context,
    (seen, stored): (&Scan, Vec<FileRow>),
    (wanted, state): (&dyn Fn(&str) -> bool, FileState),
    observer: &dyn Observer,
) -> Result<Looked, PipelineError> {
    let changes = scan::diff(&known(&stored), seen);
    note_change_times(context, &stored, &changes)?;
    let mut held = context.store.held_files()?;
    held.retain(|file| wanted(&file.path));
    let renamed = moves::settle(context, (&held, state), (&stored, seen, &changes), observer)?;
    if !renamed.is_moved {
        return Ok(Looked {
            stored,
            changes,
            renamed,
        });
    }
    let mut stored = context.store.files()?;
    stored.retain(|file| wanted(&file.path));
    let changes = scan::diff(&known(&stored), seen);
    Ok(Looked {
        stored,
        changes,
        renamed,
    })
}

/// The groups of files with one that is `due` and none that waits.
fn groups_with(
    due: &dyn Fn(&str) -> bool,
    (seen, pairs): (&Scan, &[(String, [String; 2])]),
    kind_of: impl Fn(&str) -> RunKind,
    summary: &IngestSummary,
) -> Vec<Group> {
    let waiting: BTreeSet<&str> = summary.waiting.iter().map(String::as_str).collect();
    let by_path: BTreeMap<&str, &Arc<SeenFile>> =
        seen.files.iter().map(|f| (f.display.as_str(), f)).collect();
    // Of two files with the same bytes the first is the run: a copy comes after what it is of.
    let mut groups: Vec<_> = groups::grouped(by_path.keys().copied(), pairs)
        .into_iter()
        .collect();
    groups.sort_by_key(|(run_name, _)| groups::is_named_as_copy(run_name));
    groups
        .into_iter()
        .filter(|(_, paths)| paths.iter().any(|path| due(path)))
        .filter(|(_, paths)| !paths.iter().any(|path| waiting.contains(path)))
        .map(|(run_name, paths)| Group {
            kind: kind_of(&run_name),
            run_name,
            files: paths.iter().map(|path| Arc::clone(by_path[path])).collect(),
        })
        .collect()
}

/// Records what the system could not give: what failed now, and what failed before and was not tried again yet.
fn keep_unread(context: &mut Context, summary: &mut IngestSummary) -> Result<(), PipelineError> {
    summary.unread.append(&mut summary.logs.unread);
    let waiting: BTreeSet<String> = summary.waiting.drain(..).collect();
    let mut unread: BTreeMap<String, Issue> = summary.unread.drain(..).collect();
    let before = context.store.unread_files()?;
    unread.extend(before.into_iter().filter(|(path, _)| waiting.contains(path)));
    summary.waiting = waiting
        .into_iter()
        .filter(|path| !unread.contains_key(path))
        .collect();
    summary.unread = unread.into_iter().collect();
    Ok(context.store.save_unread_files(&now(), &summary.unread)?)
}

/// Lists what stands refused, waits or lacks tags after this round.
fn list_states(context: &Context, summary: &mut IngestSummary) -> Result<(), PipelineError> {
    for file in context.store.unsettled_files()? {
        match (file.state, file.issue) {
            (FileState::Refused, Some(issue)) => summary.refused.push((file.path, issue)),
            (FileState::Pending, Some(issue)) if issue.code == UNREAD_STATEMENT => {
                summary.unread_statements.push((file.path, issue));
            }
            (FileState::Pending, _) => summary.waiting.push(file.path),
            _ => {}
        }
    }
    let profiles = context.profiles.refused.iter();
    summary
        .refused
        .extend(profiles.map(|refused| (refused.path.clone(), refused.issue())));
    summary.waiting.sort();
    summary.waiting.dedup();
    summary.untagged = context.store.untagged_runs()?;
    summary.unreadable_tags = unreadable_tags(context)?;
    let aside = standing::runs(context)?.set_aside;
    let aside: BTreeSet<&str> = aside.iter().map(|run| run.path.as_str()).collect();
    summary.untagged.retain(|name| !aside.contains(name.as_str()));
    summary.lone_halves = pairs::paired(context)?.lone;
    summary.waiting_for = waiting::waiting_for(context)?;
    let untagged = summary.untagged.iter().map(String::as_str);
    summary.proposed_pattern = waiting::proposed_pattern(context, untagged);
    summary.no_steps = context.store.runs_without_steps()?;
    summary.undeclared_tags = waiting::undeclared_tags(context)?;
    summary.unused_columns = waiting::unused_columns(context)?;
    Ok(())
}
