//! The database: its structure, references between its rows, every checksum.

use super::part::Part;
use crate::domain::Issue;
use crate::pipeline::campaign::holdings;
use crate::pipeline::{Context, Observer, PipelineError};

/// Name of the part.
pub const NAME: &str = "database";

/// How a damaged database is mended.
const MEND: &str = "`ieap rebuild` makes it anew from archive and journal and keeps this one beside it; or put a backup of \
                    campaign.db back";

/// Looks at everything in it.
///
/// # Errors
/// The archive's mark cannot be read.
pub fn part(context: &Context, observer: &dyn Observer) -> Result<Part, PipelineError> {
    observer.begin("checking the database", 1);
    let faults = context.store.check_all();
    observer.end();
    let damaged = |found: String| Issue::error("database-damaged", found).mend(MEND);
    let mut findings: Vec<Issue> = match faults {
        Ok(faults) => faults.into_iter().map(damaged).collect(),
        Err(error) => vec![damaged(error.to_string())],
    };
    match holdings::check(&context.folder, &context.store) {
        // A database that was never written has no archive.
        Err(error @ (PipelineError::Holdings(_) | PipelineError::Store(_))) => {
            findings.push(Issue::error("holdings", error.to_string()));
        }
        other => other?,
    }
    Ok(Part {
        part: NAME,
        looked_at: "structure, references between rows, checksums of all rows, hashes of all readings"
            .to_owned(),
        findings,
    })
}
