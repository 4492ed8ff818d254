//! Rows of files as the database holds them.

use super::prepare::PreparedFile;
use super::readers::Readers;
use crate::domain::{FileState, Issue};
use crate::ingest::scan::SeenFile;
use crate::pipeline::campaign::context::now;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{FileRow, RunContent};

/// A row for a file that holds no new run.
pub(crate) fn file_row(
    file: &SeenFile,
    hash: Option<String>,
    state: FileState,
    reader: String,
    issue: Option<Issue>,
) -> FileRow {
    FileRow {
        path: file.display.clone(),
        size_bytes: file.size_bytes,
        modified_ns: file.modified_ns,
        inode: file.inode,
        changed_ns: file.changed_ns,
        hash,
        state,
        reader,
        issue,
        missing_since: None,
    }
}

/// Records a file that was refused or waits. A run read from an earlier content of it stays.
pub(crate) fn set_aside(
    context: &mut Context,
    readers: &Readers,
    prepared: &PreparedFile,
    state: FileState,
    issue: &Issue,
    observer: &dyn Observer,
) -> Result<(), PipelineError> {
    observer.say(&format!(
        "{} {}: {}",
        state.key(),
        prepared.file.display,
        issue.message
    ));
    let hash = prepared.hash.clone();
    let row = file_row(&prepared.file, hash, state, readers.all(), Some(issue.clone()));
    Ok(context.store.record_files(&now(), &[row])?)
}

/// What the archive holds of a file.
pub(crate) fn content_of(file: &PreparedFile) -> Option<RunContent> {
    let archived = file.archived.clone()?;
    Some(RunContent {
        path: file.file.display.clone(),
        hash: archived.hash,
        size_bytes: archived.size_bytes,
        archive_path: archived.path,
    })
}
