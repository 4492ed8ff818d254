//! Makes the database and the journal of an opened campaign say the same (`store::journal::Compared`): what the journal lacks
//! is written into it, what the database lacks is said to it again.

use super::rebuild::replay;
use super::reported::Told;
use crate::domain::Issue;
use crate::pipeline::campaign::context::now;
use crate::pipeline::intake::ingest::{IngestSummary, retag_runs};
use crate::pipeline::{Context, FitRuns, PipelineError, Silent};
use crate::store::journal::{self, Entry, Line};

/// Compares the last lines of both, or all lines where `whole`, and makes good what differs. Gives what was done, in words.
///
/// # Errors
/// They are of two courses; the database, the archive or the disk refuses.
pub fn agree(context: &mut Context, whole: bool) -> Result<Vec<Issue>, PipelineError> {
    let mut done = if !context.store.has_course()? {
        taken_up(context)?
    } else {
        Vec::new()
    };
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
    context.store.keep_journal_in(None);
    let replayed = replay::replay(context, lines, &Silent);
    context.store.keep_journal_in(Some(&folder));
    let replayed = replayed?;
    retag_runs(context, &mut IngestSummary::default(), &Silent)?;
    if !replayed.asked.is_empty() {
        FitRuns::default().run_as_kept(context, &replayed.asked, &Silent)?;
    }
    let lost = replayed.lost.into_iter().map(|lost| {
        let lost = format!("{} did not come back: {}", lost.name, lost.issue.message);
        (now(), Entry::Missed { lost })
    });
    Ok(context.store.say(&now(), lost.collect())?)
}

/// Begins the course of a database that an earlier version of the program wrote, with the journal beside it as far as that
/// says what the database says; else with what the database says, and the journal is kept under another name.
fn taken_up(context: &mut Context) -> Result<Vec<Issue>, PipelineError> {
    let entries = context.store.journal_entries()?;
    if entries.is_empty() {
        return Ok(Vec::new());
    }
    let stored = Told::of(entries.iter().map(|(_, entry)| entry));
    let Some(found) = journal::read(&context.folder)? else {
        context.store.say(&now(), entries)?;
        return Ok(Vec::new());
    };
    let is_whole = found.damaged.is_empty() && found.gaps.is_empty();
    if let Some(known) = Told::agreeing(&found.lines, &stored).filter(|_| is_whole) {
        context.store.hear(&now(), &found.lines[..known])?;
        return Ok(Vec::new());
    }
    let mark = now().replace([':', '-'], "");
    journal::set_aside(&context.folder, &mark)?;
    let only = Told::of(found.lines.iter().map(|line| &line.entry)).only_here(&stored);
    let lost = |what: String| {
        let lost = format!("{what}, in the journal that was set aside ({mark}) and not in the database");
        (now(), Entry::Missed { lost })
    };
    let lost = only.into_iter().map(lost);
    context
        .store
        .say(&now(), entries.into_iter().chain(lost).collect())?;
    let message =
        "the journal did not say what the database says: it was written anew from the database, and kept as";
    let aside = format!("{message} archive/journal.jsonl.set-aside-{mark}");
    Ok(vec![Issue::warning("journal-set-aside", aside)])
}
