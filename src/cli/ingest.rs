//! `ieap run --only ingest`.

use crate::domain::words::counted;
use std::collections::BTreeMap;

use clap::Args;
use serde_json::json;

use super::campaign::CampaignArg;
use super::exit::{self, CliError};
use super::global::Global;
use super::output::Output;
use crate::domain::Issue;
use crate::domain::pairs::LoneHalf;
use crate::ingest::name_pattern::ProposedPattern;
use crate::pipeline::infra::mends::{Together, together};
use crate::pipeline::{Ingest, IngestSummary};

/// A step of `run`: take in new files
///
/// Recognises, reads, tags, archives and stores them.
#[derive(Debug, Args)]
#[command(override_usage = "ieap run --only ingest [OPTIONS] [CAMPAIGN]")]
pub struct IngestArgs {
    #[command(flatten)]
    campaign: CampaignArg,
}

pub fn run(args: &IngestArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let mut context = args.campaign.open(global, output)?;
    let summary = Ingest { ready: &mut |_| true }.run(&mut context, output)?;
    print(&summary, output);
    output.document(&json!({ "schema": "ieap/ingest/1", "ingest": summary }))?;
    Ok(exit::after(false, !summary.left_out_inputs()))
}

/// How many entries of a kind are listed; `ieap status` lists all.
const SHOWN: usize = 10;

/// What came in, and what did not.
pub fn print(summary: &IngestSummary, output: &Output) {
    output.result(&format!(
        "files: {} in the folder; runs: {} new, {} with new content, {} renamed, {} tagged again",
        summary.files,
        summary.new.len(),
        summary.revised.len(),
        summary.renamed.len(),
        summary.retagged.len()
    ));
    if summary.logs.files > 0 {
        let logs = &summary.logs;
        output.result(&format!(
            "logs of climate and probes: {} in the folder, {} new, {} with new content, {} renamed",
            logs.files,
            logs.new.len(),
            logs.revised.len(),
            logs.renamed.len()
        ));
    }
    let same = "with the bytes of a log: an alias";
    list(output, "file", same, &summary.logs.aliases);
    let aliases = "with the bytes of a run's file: an alias, no run";
    list(output, "file", aliases, &summary.aliases);
    if summary.copies > 0 {
        let pairs = counted(summary.copies, "pair");
        output.message(&format!(
            "{pairs} of runs with the same readings: one of each counts, `ieap status` says which"
        ));
    }
    let replaced =
        "under whose name another measurement lay before; what was said of that one does not hold of it";
    list(output, "run", replaced, &summary.replaced);
    pairs(summary, output);
    list(output, "file", "no longer there; the runs stay", &summary.gone);
    let waiting = "waiting (empty, header only, or still growing)";
    list(output, "file", waiting, &summary.waiting);
    let untagged = "without the tags to be fitted; `ieap status` says which";
    list(output, "run", untagged, &summary.untagged);
    told(output, &summary.waiting_for);
    pattern(output, summary.proposed_pattern.as_ref());
    let no_steps = "whose voltage does not go in steps (a sweep, or another technique): kept, not fitted";
    list(output, "run", no_steps, &summary.no_steps);
    told(output, &summary.undeclared_tags);
    told(output, &summary.unused_columns);
    left_out(summary, output);
}

/// Files that were joined, and halves whose partner is not there.
fn pairs(summary: &IngestSummary, output: &Output) {
    let joined = summary.paired.iter();
    let joined = joined.map(|pair| format!("{} + {}, by {}", pair.electrical, pair.bending, pair.by.label()));
    list(
        output,
        "pair",
        "of files joined to a run",
        &joined.collect::<Vec<_>>(),
    );
    let waits = |half: &LoneHalf| {
        format!(
            "{} ({}) waits for {}",
            half.path,
            half.holds.label(),
            half.waits_for
        )
    };
    let lone: Vec<String> = summary.lone_halves.iter().map(waits).collect();
    list(output, "file", "with half of a run alone", &lone);
}

/// What could not be used: files that were refused or that the system could not give, tag files that cannot be read.
pub(super) fn left_out(summary: &IngestSummary, output: &Output) {
    refused(output, "refused", &summary.refused);
    refused(output, NOT_READ, &summary.unread);
    refused(output, TAGS_NO_RUN, &summary.unread_statements);
    if summary.unreadable_tags.is_empty() {
        return;
    }
    output.message(&format!(
        "{} of tags cannot be read; the runs that they speak for keep the tags that they had, or wait:",
        counted(summary.unreadable_tags.len(), "statement")
    ));
    for tags in summary.unreadable_tags.iter().take(SHOWN) {
        let place = format!("{} ({})", tags.issue.place, counted(tags.runs, "run"));
        let issue = Issue {
            place: String::new(),
            ..tags.issue.clone()
        };
        output.issue(&place, &issue);
    }
    if summary.unreadable_tags.len() > SHOWN {
        output.message("  ... `ieap status` lists all");
    }
}

/// What is said of statements that are of no run.
pub const TAGS_NO_RUN: &str = "of tags by which no run is tagged";

/// What is said of files that the system could not give.
pub const NOT_READ: &str = "that could not be read now, tried again at every look";

/// The same of many runs: one line for all, with their number and one of them.
fn told(output: &Output, all: &[Together]) {
    for told in all {
        for issue in &told.issues {
            let runs = match told.paths.len() {
                1 => told.paths[0].clone(),
                count => format!("{count} runs, as {}", told.paths[0]),
            };
            output.message(&format!("  {runs}: {}\n    {}", issue.message, issue.mend));
        }
    }
}

/// A name pattern that would tag runs which lack tags.
pub fn pattern(output: &Output, proposed: Option<&ProposedPattern>) {
    let Some(found) = proposed else { return };
    output.message(&format!(
        "  name_pattern = \"{}\" in campaign.toml, [runs], reads tags from {} of these {} names",
        found.pattern, found.explains, found.names
    ));
}

/// Files that were not taken in; those with the same reason and mend are told together, and of many only the first are
/// listed.
fn refused(output: &Output, title: &str, refused: &[(String, Issue)]) {
    if refused.is_empty() {
        return;
    }
    output.message(&format!("{} {title}:", counted(refused.len(), "file")));
    let entries = refused
        .iter()
        .map(|(path, issue)| (path.as_str(), vec![issue.clone()]));
    let mut listed: BTreeMap<String, usize> = BTreeMap::new();
    for told in together(entries) {
        for issue in &told.issues {
            let of_kind = listed.entry(issue.code.clone()).or_insert(0);
            let shown = SHOWN.saturating_sub(*of_kind).min(told.paths.len());
            *of_kind += told.paths.len();
            if let Some((last, first)) = told.paths[..shown].split_last() {
                first
                    .iter()
                    .for_each(|path| output.message(&format!("  {path},")));
                output.issue(last, issue);
            }
        }
    }
    for (code, count) in listed.into_iter().filter(|(_, count)| *count > SHOWN) {
        let more = count - SHOWN;
        output.message(&format!(
            "  ... and {more} more ({code}); `ieap status` lists all"
        ));
    }
}

fn list(output: &Output, thing: &str, title: &str, paths: &[String]) {
    if paths.is_empty() {
        return;
    }
    output.message(&format!("{} {title}:", counted(paths.len(), thing)));
    for path in paths.iter().take(SHOWN) {
        output.message(&format!("  {path}"));
    }
    if paths.len() > SHOWN {
        output.message(&format!("  ... and {} more", paths.len() - SHOWN));
    }
}
