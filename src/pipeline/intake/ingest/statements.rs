//! What became of the files that state something: files beside or below them are read with it, or none is.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::known::known;
use super::rows::file_row;
use crate::domain::{FileState, Issue};
use crate::ingest::campaign_file;
use crate::ingest::profiles;
use crate::ingest::scan::{self, Scan, SeenFile, StatesFor, display_path, parse_display_path, states_for};
use crate::ingest::tags::unread_statement;
use crate::pipeline::campaign::context::now;
use crate::pipeline::{Context, PipelineError};
use crate::store::FileRow;

/// Whether a file of that path states something rather than that it is read.
pub(crate) fn is_statement(path: &str) -> bool {
    states(Path::new(path)).is_some()
}

fn states(path: &Path) -> Option<StatesFor> {
    path.file_name().and_then(states_for)
}

/// The statements that scans saw.
#[derive(Default)]
pub(super) struct Statements {
    seen: Scan,
}

impl Statements {
    /// Takes those of a scan.
    pub fn take(&mut self, scan: &mut Scan) {
        self.seen.files.append(&mut scan.statements);
        self.seen.unreadable.extend_from_slice(&scan.unreadable);
    }

    /// Nothing is known now of what lies in a folder.
    pub fn out_of_sight(&mut self, folder: &str) {
        self.seen.unreadable.push(folder.to_owned());
    }

    /// Writes down of each whether something is read with it; `stored` is what was known of them.
    ///
    /// # Errors
    /// The database refuses.
    pub fn settle(mut self, context: &mut Context, stored: &[FileRow]) -> Result<(), PipelineError> {
        let files = &mut self.seen.files;
        files.sort_by(|a, b| a.display.cmp(&b.display));
        files.dedup_by(|a, b| a.display == b.display);
        let gone = scan::diff(&known(stored), &self.seen).gone;
        let read = read_with_files(context)?;
        let rows = rows_of(context, &self.seen.files, &read)?;
        let before: BTreeMap<&str, &FileRow> = stored.iter().map(|row| (row.path.as_str(), row)).collect();
        let is_news = |row: &FileRow| before.get(row.path.as_str()) != Some(&row);
        let news: Vec<FileRow> = rows.into_iter().filter(is_news).collect();
        context.store.record_files(&now(), &news)?;
        Ok(context.store.forget_files(&now(), &gone)?)
    }
}

/// The statements with which files of runs were read, or will be when what keeps them from being runs is mended.
fn read_with_files(context: &Context) -> Result<BTreeSet<PathBuf>, PipelineError> {
    let files = context.store.files()?.into_iter();
    let waits = |file: &FileRow| {
        let may_be_a_run = matches!(
            file.state,
            FileState::Refused | FileState::Pending | FileState::Alias
        );
        may_be_a_run && file.missing_since.is_none() && !is_statement(&file.path)
    };
    let waiting = files.filter(waits).map(|file| file.path);
    let unread = context.store.unread_files()?.into_iter().map(|(path, _)| path);
    let mut read = context.stated.there();
    for path in waiting.chain(unread) {
        let of_file = context.stated.of_file(&parse_display_path(&path));
        read.extend(of_file.into_iter().map(|(statement, _)| statement));
    }
    Ok(read)
}

fn rows_of(
    context: &Context,
    seen: &[Arc<SeenFile>],
    read: &BTreeSet<PathBuf>,
) -> Result<Vec<FileRow>, PipelineError> {
    let is_used = |file: &SeenFile| {
        let path = &file.relative;
        // A folder's tags hold for whatever will come into it.
        states(path) == Some(StatesFor::Folder)
            || read.contains(path)
            || path == Path::new(campaign_file::FILE_NAME)
            || path.parent() == Some(Path::new(profiles::FOLDER))
    };
    let (used, unread): (Vec<_>, Vec<_>) = seen.iter().partition(|file| is_used(file));
    let row = |file: &SeenFile, state, issue| file_row(file, None, state, String::new(), issue);
    let mut rows: Vec<FileRow> = (used.into_iter())
        .map(|file| row(file, FileState::Sidecar, None))
        .collect();
    if unread.is_empty() {
        return Ok(rows);
    }
    let beside = names_by_folder(context)?;
    for file in unread {
        let folder = file.relative.parent().map(display_path).unwrap_or_default();
        let names = beside.get(&folder).map_or(&[][..], Vec::as_slice);
        let issue: Issue = unread_statement(&file.relative, names);
        rows.push(row(file, FileState::Pending, Some(issue)));
    }
    Ok(rows)
}

/// Names of the files that may be read, by folder.
fn names_by_folder(context: &Context) -> Result<BTreeMap<String, Vec<String>>, PipelineError> {
    let mut names: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for file in context.store.files()? {
        if file.missing_since.is_none() && !is_statement(&file.path) {
            let (folder, name) = file.path.rsplit_once('/').unwrap_or(("", &file.path));
            names.entry(folder.to_owned()).or_default().push(name.to_owned());
        }
    }
    Ok(names)
}
