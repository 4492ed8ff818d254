//! Makes the database and the journal of an opened campaign say the same (`store::journal::Compared`): what the journal lacks
//! is written into it, what the database lacks is said to it again.

use super::rebuild::replay;
use crate::domain::Issue;
use crate::pipeline::campaign::context::now;
use crate::pipeline::intake::ingest::{IngestSummary, retag_runs};
use crate::pipeline::{Context, PipelineError, Silent};
use crate::store::journal::{self, Entry, Line};

/// Compares the last lines of both, or all lines where `whole`, and makes good what differs. Gives what was done, in words.
///
/// # Errors
/// They are of two courses; the database, the archive or the disk refuses.
pub fn agree(context: &mut Context, whole: bool) -> Result<Vec<Issue>, PipelineError> {
    let mut done = Vec::new();
    if !whole && context.store.is_agreed(&context.folder)? {
        return Ok(done);
    }
    let agreed = context.store.agree()?;
    if !agreed.written.is_empty() {
        done.push(told(
            "journal-written",
            "the journal lacked what the database has, and has it now",
            &agreed.written,
        ));
    }
    if !agreed.to_say.is_empty() {
        say_again(context, &agreed.to_say)?;
        let message = "the database lacked what the journal has (an older one, or a program that was ended within a change), \
                       and has it now";
        done.push(told("database-caught-up", message, &agreed.to_say));
    }
    Ok(done)
}

fn told(code: &str, message: &str, lines: &[Line]) -> Issue {
    Issue::note(code, format!("{message}: {}", journal::in_words(lines)))
}

/// Says to the database what the journal has and it lacks.
fn say_again(context: &mut Context, lines: &[Line]) -> Result<(), PipelineError> {
    let folder = context.folder.clone();
    context.store.keep_journal_heard();
    let replayed = replay::replay(context, lines, &Silent);
    context.store.keep_journal_in(Some(&folder));
    let replayed = replayed?;
    retag_runs(context, &mut IngestSummary::default(), &Silent)?;
    let lost = replayed.lost.into_iter().map(|lost| {
        let lost = format!("{} did not come back: {}", lost.name, lost.issue.message);
        (now(), Entry::Missed { lost })
    });
    Ok(context.store.say(&now(), lost.collect())?)
}
