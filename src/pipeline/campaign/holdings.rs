//! Whether the database and the archive of a campaign are there and belong together.
//!
//! The archive says in `archive/database-id` which database it belongs to. A campaign that had a database and has none
//! now is refused: made anew without a word it would lose what only the database held, and the report would follow.

use std::path::Path;

use super::places::{FAULTS, REPORT_FOLDER, STAMP};
use crate::ingest::archive::{Archive, FOLDER};
use crate::pipeline::PipelineError;
use crate::pipeline::infra::error::HoldingsError;
use crate::store::{self, FILE_NAME, Found, Store, journal};

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
/// [`HoldingsError::Foreign`]; [`HoldingsError::ArchiveLost`] where the archive is gone although the database names
/// raw files; the archive cannot be looked at.
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
        None if store.names_content(None)? && !archive.holds_anything()? => Err(HoldingsError::ArchiveLost {
            path: folder.join(FOLDER),
        }
        .into()),
        // Nothing was archived yet, or an earlier version of the program did it.
        None => Ok(()),
    }
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
