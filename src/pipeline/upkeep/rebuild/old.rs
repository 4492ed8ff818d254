//! What the old database knows and the journal does not, before a new one is made.

use std::path::Path;

use super::what_is_wrong;
use crate::domain::Issue;
use crate::ingest::archive::Archive;
use crate::pipeline::{Context, PipelineError};
use crate::store::journal::{self, Entry};
use crate::store::{FILE_NAME, StoreError};

/// What looking at it came to.
#[derive(Debug, Default)]
pub struct Old {
    /// What only it had, in words; the journal has it now.
    pub of_database: Vec<String>,
    /// What is wrong with the journal, and could not be mended from it.
    pub wrong: Vec<Issue>,
}

/// Brings what only the old database knows into the journal.
///
/// # Errors
/// Both say different things; another instance works; the database is of a newer program; the disk refuses.
pub fn brought_in(folder: &Path, allow_network: bool) -> Result<Old, PipelineError> {
    let before = journal::read(folder)?;
    // As at every opening, where it can be opened; the rest is taken as far as it can be read.
    match Context::open_as_made(folder, allow_network) {
        Ok(_) | Err(PipelineError::Holdings(_)) => {}
        Err(PipelineError::Store(error)) if is_damage(&error) => {}
        Err(error) => return Err(error),
    }
    let owner = Archive::new(folder).owner()?;
    let union = journal::union(folder, owner.as_deref())?;
    let has_now = journal::read(folder)?.unwrap_or_default().lines.into_iter();
    let had = before.as_ref().map_or(0, |found| found.last_number);
    let is_new = |n: u64| {
        let there = |found: &journal::Found| found.lines.iter().any(|line| line.n == n);
        n > had || !before.as_ref().is_some_and(there)
    };
    let carried = has_now.filter(|line| is_new(line.n) && !matches!(line.entry, Entry::Missed { .. }));
    let mut wrong = if union.lacks_lines || union.found.is_none() {
        what_is_wrong(union.found.as_ref())
    } else {
        Vec::new()
    };
    wrong.extend(union.unread.map(|why| not_read(&why)));
    Ok(Old {
        of_database: carried.map(|line| line.entry.in_words()).collect(),
        wrong,
    })
}

/// What is said where words of the old database could not be read.
fn not_read(why: &str) -> Issue {
    let message =
        format!("its words could not be read ({why}); what the journal beside it does not say may be lost");
    Issue::error("old-database-not-read", message).at(FILE_NAME).mend(
        "it lies beside the new one under the name that is told; where the reason has passed, put it back and rebuild once more",
    )
}

/// Whether the database is what a rebuilding is for.
fn is_damage(error: &StoreError) -> bool {
    use StoreError as E;
    matches!(
        error,
        E::NotADatabase { .. }
            | E::NoVersion { .. }
            | E::Older { .. }
            | E::ChangedSchema { .. }
            | E::BadValue { .. }
            | E::Damaged { .. }
            | E::Lags { .. }
            | E::Sql { .. }
            | E::CannotOpen { .. }
    )
}
