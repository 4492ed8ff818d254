//! `ieap status`.

use clap::Args;
use serde_json::json;

use super::CampaignArg;
use super::exit::{CliError, DONE};
use super::output::{Output, counted};
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
    if !status.modulus_logs_by_state.is_empty() {
        let states = status.modulus_logs_by_state.iter();
        let states: Vec<String> = states
            .map(|(state, count)| format!("{count} {}", state.replace('_', " ")))
            .collect();
        output.result(&format!("modulus logs: {}", states.join(", ")));
    }
    section(output, "file", "refused", &status.refused);
    let waiting = "waiting (empty, header only, or still growing)";
    section(output, "file", waiting, &status.pending);
    let untagged = "without the tags to be fitted";
    section(output, "run", untagged, &status.untagged);
    section(output, "run", "that could not be fitted", &status.not_fitted);
    let logs = &status.modulus_logs_not_analysed;
    section(output, "modulus log", "not analysed", logs);
    if status.aliases > 0 {
        let aliases = counted(status.aliases, "file");
        output.result(&format!("{aliases} with the bytes of a run's file"));
    }
    let missing = "no longer in the folder; the runs stay";
    list(output, "file", missing, &status.missing_files);
    let gaps: Vec<String> = status
        .gaps
        .iter()
        .map(|gap| format!("{} in {} at {} V", gap.material, gap.environment, gap.voltage_v))
        .collect();
    list(output, "condition", "without a run", &gaps);
    let older = "fitted by another version of ieap";
    list(output, "run", older, &status.fitted_by_older_program);
}

fn section(output: &Output, thing: &str, title: &str, entries: &[Reasoned]) {
    if entries.is_empty() {
        return;
    }
    output.result(&format!("{} {title}:", counted(entries.len(), thing)));
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

fn list(output: &Output, thing: &str, title: &str, entries: &[String]) {
    if !entries.is_empty() {
        output.result(&format!("{} {title}:", counted(entries.len(), thing)));
        entries
            .iter()
            .for_each(|entry| output.result(&format!("  {entry}")));
    }
}
