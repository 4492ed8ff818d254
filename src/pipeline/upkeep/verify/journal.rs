//! The journal: its lines, and whether it says what the database says.

use crate::domain::words::counted;
use std::path::Path;

use super::part::Part;
use crate::domain::Issue;
use crate::pipeline::show::report::line_of_report;
use crate::pipeline::upkeep::rebuild::what_is_wrong;
use crate::pipeline::{Context, PipelineError};
use crate::store::StoreError;
use crate::store::journal::{self, Compared, Found};

/// Name of the part.
const NAME: &str = "journal";

/// Looks at its lines alone.
///
/// # Errors
/// It cannot be read.
pub fn alone(folder: &Path) -> Result<Part, PipelineError> {
    let found = journal::read(folder)?;
    Ok(of_lines(found.as_ref()))
}

/// Looks at its lines and holds them against the database.
///
/// # Errors
/// It or the database cannot be read.
pub fn part(context: &Context) -> Result<Part, PipelineError> {
    let (found, mut findings) = match context.store.compared(&context.folder) {
        Ok((found, compared)) => {
            let lacks = what_is_lacked(&compared, found.is_some());
            (found, lacks)
        }
        Err(error @ StoreError::Parted { .. }) => {
            let parted = Issue::error("journal-parted", error.to_string());
            (journal::read(&context.folder)?, vec![parted])
        }
        Err(error) => return Err(error.into()),
    };
    if found.is_none() && context.store.last_said()? == journal::End::default() {
        return Ok(Part {
            part: NAME,
            looked_at: "nothing was said yet".to_owned(),
            findings,
        });
    }
    let mut part = of_lines(found.as_ref());
    part.findings.extend(missed(context)?);
    part.findings.append(&mut findings);
    Ok(part)
}

fn of_lines(found: Option<&Found>) -> Part {
    let mut findings = what_is_wrong(found);
    if found.is_some_and(|found| found.is_torn) {
        let torn = "the last line is cut off: a program was ended while it wrote it, and nobody was told of what it says";
        findings.push(
            Issue::note("journal-torn", torn).mend("nothing needs to be done: the next line takes its place"),
        );
    }
    Part {
        part: NAME,
        looked_at: counted(found.map_or(0, |found| found.lines.len()), "line"),
        findings,
    }
}

/// What the database and the journal lack of each other, where they do not end level: for whoever only reads, and mends
/// nothing.
///
/// # Errors
/// The database or the journal cannot be read; [`StoreError::Parted`] where they are of two courses.
pub fn behind(context: &Context) -> Result<Vec<Issue>, PipelineError> {
    // A database in memory, where there is none yet, has no journal.
    if !context.store.path().exists() || context.store.is_level(&context.folder)? {
        return Ok(Vec::new());
    }
    let (found, compared) = context.store.compared(&context.folder)?;
    Ok(what_is_lacked(&compared, found.is_some()))
}

/// What one of them lacks.
fn what_is_lacked(compared: &Compared, has_journal: bool) -> Vec<Issue> {
    let mut found = Vec::new();
    if !compared.is_database_whole() {
        let message = format!("the database lacks what the journal says: {}", compared.lacks());
        let mend = if compared.can_be_said_again() {
            "the next `ieap run` takes it up"
        } else {
            "`ieap rebuild` makes a database of all that either has"
        };
        found.push(Issue::error("database-lags", message).mend(mend));
    }
    let lacking = compared.of_database.len();
    if lacking > 0 && has_journal {
        let message = format!(
            "the journal lacks {} that the database has",
            counted(lacking, "line")
        );
        found.push(
            Issue::error("journal-lags", message).mend("the next `ieap run` writes them from the database"),
        );
    }
    found
}

/// What journal and database both lack, in words, where nobody was told yet: the report was made when they had more.
///
/// # Errors
/// The database cannot be read.
pub fn cut(context: &Context) -> Result<Option<String>, PipelineError> {
    // Whoever is asked already looks after all that may be lost.
    let is_asked = !context.store.words_missed()?.is_empty();
    let Some((n, sum)) = line_of_report(context)?.filter(|_| !is_asked) else {
        return Ok(None);
    };
    if context.store.has_line(n, &sum)? || context.store.was_missed(&sum)? {
        return Ok(None);
    }
    Ok(Some(format!(
        "the report was made when line {n} of the journal was the last ({sum}), and neither journal nor database has that line: \
         both end at line {}",
        context.store.last_said()?.n
    )))
}

/// What may be lost since a rebuilding, until a person answers.
pub fn missed(context: &Context) -> Result<Vec<Issue>, PipelineError> {
    let issue = |lost: String| {
        Issue::error("words-may-be-lost", lost).mend(
            "look which run, tag, dropped run or wish how to fit is missing, put it back or say it again, then \
             `ieap run --answer ...`",
        )
    };
    let missed = context.store.words_missed()?.into_iter().chain(cut(context)?);
    Ok(missed.map(issue).collect())
}
