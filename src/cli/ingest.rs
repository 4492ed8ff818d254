//! `ieap ingest`.

use std::collections::BTreeMap;

use clap::Args;
use serde_json::json;

use super::exit::{CliError, DONE, SOME_REFUSED};
use super::output::{Output, counted};
use super::{CampaignArg, Global};
use crate::domain::Issue;
use crate::pipeline::{Ingest, IngestSummary};

/// Take in new files: recognise, read, tag, archive and store them
#[derive(Debug, Args)]
pub struct IngestArgs {
    #[command(flatten)]
    campaign: CampaignArg,
}

pub fn run(args: &IngestArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let mut context = args.campaign.open(global, output)?;
    let summary = Ingest { ready: &mut |_| true }.run(&mut context, output)?;
    print(&summary, output);
    output.document(&json!({ "schema": "ieap/ingest/1", "ingest": summary }))?;
    Ok(status(&summary))
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
            "climate logs: {} in the folder, {} new, {} with new content, {} renamed",
            logs.files,
            logs.new.len(),
            logs.revised.len(),
            logs.renamed.len()
        ));
    }
    let same = "with the bytes of a climate log: an alias";
    list(output, "file", same, &summary.logs.aliases);
    let aliases = "with the bytes of a run's file: an alias, no run";
    list(output, "file", aliases, &summary.aliases);
    list(output, "file", "no longer there; the runs stay", &summary.gone);
    let waiting = "waiting (empty, header only, or still growing)";
    list(output, "file", waiting, &summary.waiting);
    let untagged = "without the tags to be fitted; `ieap status` says which";
    list(output, "run", untagged, &summary.untagged);
    left_out(summary, output);
}

/// The exit status after taking in: done, or done with inputs left out.
pub(super) fn status(summary: &IngestSummary) -> u8 {
    match summary.left_out_inputs() {
        false => DONE,
        true => SOME_REFUSED,
    }
}

/// What could not be used: files that were refused, tag files that cannot be read.
pub(super) fn left_out(summary: &IngestSummary, output: &Output) {
    refused(output, &summary.refused);
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

/// Refused files; of many with the same kind of reason only the first are listed.
fn refused(output: &Output, refused: &[(String, Issue)]) {
    if refused.is_empty() {
        return;
    }
    output.message(&format!("{} refused:", counted(refused.len(), "file")));
    let mut listed: BTreeMap<&str, usize> = BTreeMap::new();
    for (path, issue) in refused {
        let of_kind = listed.entry(&issue.code).or_insert(0);
        *of_kind += 1;
        if *of_kind <= SHOWN {
            output.issue(path, issue);
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
