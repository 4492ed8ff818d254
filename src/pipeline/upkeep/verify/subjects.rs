//! Whether every current result is of a run, log or group that is there, and each of these has its results or waits for them.

use std::collections::{BTreeMap, BTreeSet};

use super::part::Part;
use crate::domain::words::counted;
use crate::domain::{Issue, RunState};
use crate::pipeline::campaign::standing;
use crate::pipeline::findings::diagnose;
use crate::pipeline::{Context, PipelineError};
use crate::store::ResultKind;

/// Holds results and what they are of against each other.
///
/// # Errors
/// The database cannot be read, or the model of campaign.toml is not known.
pub fn part(context: &Context) -> Result<Part, PipelineError> {
    let _moment = context.store.snapshot()?;
    let mut findings: Vec<Issue> = (context.store.stray_results()?.into_iter()).map(stray).collect();
    let runs: BTreeSet<String> = (context.store.fit_tasks()?.into_iter())
        .map(|task| task.path)
        .collect();
    let logs = context.store.dma_logs()?.into_iter();
    let logs: BTreeSet<String> = logs
        .filter(|log| log.state == RunState::Ready)
        .map(|log| log.path)
        .collect();
    let subjects = runs.len() + logs.len();
    // One that could not be made is there with its reason.
    for (kind, of, word) in [
        (ResultKind::Fit, runs, "fit"),
        (ResultKind::Modulus, logs, "analysis"),
    ] {
        let made: BTreeMap<String, String> = context.store.result_keys(kind)?;
        let waiting: Vec<String> = of.into_iter().filter(|name| !made.contains_key(name)).collect();
        findings.extend(waits(&waiting, word, "`ieap run`"));
    }
    let groups = diagnose::waiting(context, standing::all(context)?)?;
    let groups = [groups.missing, groups.outdated].concat();
    findings.extend(waits(&groups, "diagnosis", "`ieap diagnose`"));
    Ok(Part {
        part: "subjects",
        looked_at: format!(
            "every current result, and {} that have one or wait for it",
            counted(subjects, "run")
        ),
        findings,
    })
}

fn stray(result: String) -> Issue {
    let message = format!("{result} is current, and what it is of is not there");
    Issue::error("result-stray", message)
        .mend("`ieap rebuild` makes the database anew from archive and journal")
}

/// What is said of those that wait; nothing where there is none.
fn waits(names: &[String], word: &str, verb: &str) -> Option<Issue> {
    let first = names.first()?;
    let more = if names.len() > 1 {
        format!(" and {} more wait", names.len() - 1)
    } else {
        " waits".to_owned()
    };
    let message = format!("{first}{more} for the {word}");
    Some(Issue::note("result-waits", message).mend(format!("{verb} makes it")))
}
