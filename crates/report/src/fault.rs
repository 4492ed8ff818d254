//! The border of a page and of a section: what cannot be made becomes a box that says so, and the rest is rendered.

use super::error::ReportError;
use ieap_domain::fault::caught;

/// What to do with a fault.
pub const REPORT_IT: &str =
    "report it with the files of the runs; the database and everything else in this report are not affected";

/// Does `work`; a panic is an error like any other.
///
/// # Errors
/// What `work` says, and [`ReportError::Fault`] where it panics.
pub fn guarded<T>(work: impl FnOnce() -> Result<T, ReportError>) -> Result<T, ReportError> {
    caught(work).unwrap_or_else(|reason| Err(ReportError::Fault(reason)))
}

/// Why a part cannot be made.
///
/// # Errors
/// The error itself where the disk refuses: no other page would fare better.
pub fn reason_of(error: ReportError) -> Result<String, ReportError> {
    if error.is_of_disk() {
        Err(error)
    } else {
        Ok(error.to_string())
    }
}
