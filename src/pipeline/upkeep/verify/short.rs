//! The short look at a campaign: what an opening after a disorderly end takes, and `watch` once a week.

use super::{archive, journal};
use crate::domain::{Issue, Severity};
use crate::pipeline::{Context, PipelineError};

/// The short form: the structure of the database, names and sizes of raw files, the lines of the journal. Checksums of rows
/// are looked at whenever these are read.
///
/// # Errors
/// The archive cannot be looked through, or the journal cannot be read.
pub(crate) fn quick(context: &Context) -> Result<Vec<Issue>, PipelineError> {
    match context.store.check_structure() {
        Err(error) => Ok(vec![Issue::error("database-damaged", error.to_string())]),
        Ok(()) => of_archive(context),
    }
}

/// The short form of what lies in `archive/`.
///
/// # Errors
/// As of [`quick`].
pub(crate) fn of_archive(context: &Context) -> Result<Vec<Issue>, PipelineError> {
    let mut findings = Vec::new();
    for lost in archive::raw_files_lost(context)? {
        findings.extend(lost.issues);
    }
    if crate::store::journal::path_in(&context.folder).exists() {
        findings.extend(journal::alone(&context.folder)?.findings);
    }
    findings.retain(|issue| issue.severity == Severity::Error);
    Ok(findings)
}
