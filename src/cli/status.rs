//! `ieap status`.

use clap::Args;
use serde_json::json;

use super::CampaignArg;
use super::exit::{CliError, DONE};
use super::output::Output;
use crate::pipeline::Context;
use crate::pipeline::status::{Reasoned, Status, status};

/// Count runs by state; list refused files with reasons, gaps in the condition matrix, and what is out of date
#[derive(Debug, Args)]
pub struct StatusArgs {
    #[command(flatten)]
    campaign: CampaignArg,
}

pub fn run(args: &StatusArgs, output: &Output) -> Result<u8, CliError> {
    let context = Context::open_read_only(&args.campaign.folder()?)?;
    let status = status(&context)?;
    print(&status, output);
    output.document(&json!({ "schema": "ieap/status/1", "status": status }))?;
    Ok(DONE)
}

fn print(status: &Status, output: &Output) {
    let states: Vec<String> = status
        .runs_by_state
        .iter()
        .map(|(state, count)| format!("{count} {}", state.replace('_', " ")))
        .collect();
    output.result(&format!(
        "{}: {} runs ({})",
        status.campaign,
        status.runs,
        states.join(", ")
    ));
    section(output, "refused files", &status.refused);
    section(
        output,
        "files that wait (empty, header only, or still growing)",
        &status.pending,
    );
    section(output, "runs without the tags they need", &status.untagged);
    section(output, "runs that could not be fitted", &status.not_fitted);
    if status.aliases > 0 {
        output.result(&format!(
            "{} files hold the same bytes as a run's file",
            status.aliases
        ));
    }
    list(
        output,
        "files of runs that are no longer in the folder",
        &status.missing_files,
    );
    let gaps: Vec<String> = status
        .gaps
        .iter()
        .map(|gap| format!("{} in {} at {} V", gap.material, gap.environment, gap.voltage_v))
        .collect();
    list(output, "conditions without a run", &gaps);
    list(
        output,
        "runs fitted by another version of ieap",
        &status.fitted_by_older_program,
    );
}

fn section(output: &Output, title: &str, entries: &[Reasoned]) {
    if entries.is_empty() {
        return;
    }
    output.result(&format!("{} {title}:", entries.len()));
    for entry in entries {
        output.result(&format!("  {}", entry.path));
        for issue in entry
            .issues
            .iter()
            .filter(|issue| issue.severity > crate::domain::Severity::Note)
        {
            let place = if issue.place.is_empty() {
                String::new()
            } else {
                format!("{}: ", issue.place)
            };
            output.result(&format!("      {place}{}", issue.message));
            if !issue.mend.is_empty() {
                output.result(&format!("      -> {}", issue.mend));
            }
        }
    }
}

fn list(output: &Output, title: &str, entries: &[String]) {
    if !entries.is_empty() {
        output.result(&format!("{} {title}:", entries.len()));
        entries
            .iter()
            .for_each(|entry| output.result(&format!("  {entry}")));
    }
}
