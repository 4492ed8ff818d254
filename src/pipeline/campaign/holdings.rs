//! Whether the database and the archive of a campaign are there and belong together.
//!
//! The archive says in `archive/database-id` which database it belongs to. A campaign that had a database and has none
//! now is refused: made anew without a word it would lose what only the database held, and the report would follow.

use std::path::Path;

use super::places::{FAULTS, REPORT_FOLDER, STAMP};
use crate::domain::words::counted;
use crate::ingest::archive::{Archive, Archived, FOLDER};
use crate::pipeline::PipelineError;
use crate::pipeline::infra::error::HoldingsError;
use crate::store::{self, FILE_NAME, Found, RunContent, Store, journal};

/// Refuses a campaign whose database is gone or empty although something says that there was one.
///
/// # Errors
/// [`HoldingsError::DatabaseLost`]; the archive cannot be looked at.
pub fn refuse_lost_database(folder: &Path) -> Result<(), PipelineError> {
    let found = match store::found(folder) {
        Found::Something => return Ok(()),
        Found::Nothing => "it is not there".to_owned(),
        Found::Empty { bytes } => format!("nothing is stored in it ({bytes} bytes)"),
    };
    match evidence(folder)? {
        None => Ok(()),
        Some(evidence) => Err(HoldingsError::DatabaseLost {
            path: folder.join(FILE_NAME),
            found,
            evidence: evidence.to_owned(),
        }
        .into()),
    }
}

/// What says that the campaign had a database.
fn evidence(folder: &Path) -> Result<Option<&'static str>, PipelineError> {
    let archive = Archive::new(folder);
    if archive.owner()?.is_some() {
        return Ok(Some("archive/database-id names one"));
    }
    if journal::path_in(folder).exists() {
        return Ok(Some("archive/journal.jsonl was kept for one"));
    }
    if archive.holds_anything()? {
        return Ok(Some("archive/ holds raw files"));
    }
    let report = folder.join(REPORT_FOLDER);
    let was_made = [STAMP, FAULTS].iter().any(|name| report.join(name).exists());
    Ok(was_made.then_some("report/ was made from one"))
}

/// Holds the open database against the archive beside it.
///
/// # Errors
/// [`HoldingsError::Foreign`]; [`HoldingsError::ArchiveLost`] where nothing says whose the archive is and it lacks raw files
/// that the database names; the archive cannot be looked at.
pub fn check(folder: &Path, store: &Store) -> Result<(), PipelineError> {
    let (archive, id) = (Archive::new(folder), store.identity()?);
    match archive.owner()? {
        Some(owner) if owner == id => Ok(()),
        Some(needed) => Err(HoldingsError::Foreign {
            path: store.path().to_owned(),
            found: id,
            needed,
        }
        .into()),
        // Nothing was archived yet, or all of it is there and only the file that says whose it is has gone.
        None => match lost(folder, &store.contents()?)? {
            None => Ok(()),
            Some(lacks) => Err(HoldingsError::ArchiveLost {
                path: folder.join(FOLDER),
                lacks,
            }
            .into()),
        },
    }
}

/// Refuses to make a database of an earlier version anew where the archive lacks what it is made from: a disk may not be
/// mounted.
///
/// # Errors
/// [`HoldingsError::LossAhead`]; the old database or the archive cannot be looked at.
pub fn refuse_loss(folder: &Path) -> Result<(), PipelineError> {
    let named = store::raw_files_named(folder)?;
    let no_journal = !named.is_empty() && !journal::path_in(folder).exists();
    let no_journal = no_journal.then(|| "archive/journal.jsonl is not there".to_owned());
    match no_journal.map_or_else(|| lost(folder, &named), |lacks| Ok(Some(lacks)))? {
        None => Ok(()),
        Some(lacks) => Err(HoldingsError::LossAhead {
            path: folder.join(FILE_NAME),
            lacks,
        }
        .into()),
    }
}

/// What the archive lacks of these raw files, in words.
fn lost(folder: &Path, named: &[RunContent]) -> Result<Option<String>, PipelineError> {
    let wanted = |named: &RunContent| Archived {
        hash: named.hash.clone(),
        path: named.archive_path.clone(),
        size_bytes: named.size_bytes,
    };
    let wanted: Vec<Archived> = named.iter().map(wanted).collect();
    let lost = Archive::new(folder).missing(&wanted)?;
    let first = lost.first().map(|lost| lost.wanted.path.clone());
    Ok(first.map(|first| {
        let named = counted(named.len(), "raw file");
        format!(
            "of the {named} that the database names, {} not in archive/ ({first})",
            lost.len()
        )
    }))
}

/// Writes down that the archive belongs to the database, where that is not written yet.
///
/// # Errors
/// As [`check`]; the archive cannot be written.
pub fn check_and_mark(folder: &Path, store: &Store) -> Result<(), PipelineError> {
    check(folder, store)?;
    let archive = Archive::new(folder);
    match archive.owner()? {
        Some(_) => Ok(()),
        None => Ok(archive.set_owner(&store.identity()?)?),
    }
}
