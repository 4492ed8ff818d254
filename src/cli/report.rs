//! `ieap run --only report`.

use crate::domain::words::counted;
use clap::Args;
use serde_json::json;

use super::campaign::CampaignArg;
use super::exit::{self, CliError, STORAGE};
use super::faults::say_faults;
use super::global::Global;
use super::output::Output;
use crate::pipeline::{Context, RenderReport, ReportSummary, standing_report};

/// A step of `run`: write the report anew
///
/// Without looking for files.
#[derive(Debug, Args)]
#[command(override_usage = "ieap run --only report [OPTIONS] [CAMPAIGN]")]
pub struct ReportArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Render even where nothing changed
    #[arg(long)]
    again: bool,
}

pub fn run(args: &ReportArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let due = |context: &Context| -> Result<Option<String>, CliError> {
        let stands = !args.again && standing_report(context)?.is_some();
        Ok((!stands).then(|| "the report to write anew".to_owned()))
    };
    let (context, is_to_work) = args.campaign.open_or_read(global, output, due)?;
    let verb = RenderReport {
        again: args.again,
        before: None,
    };
    let stands = if is_to_work {
        None
    } else {
        standing_report(&context)?
    };
    let summary = match stands {
        Some(summary) => summary,
        None => verb.run(&context, output)?,
    };
    print(&summary, output);
    output.document(&json!({ "schema": "ieap/report/1", "report": summary }))?;
    Ok(match summary.refused {
        None => exit::after(!summary.faults.is_empty(), summary.templates_left_out.is_empty()),
        Some(_) => STORAGE,
    })
}

/// Most files that are named.
const NAMED: usize = 5;

/// What went wrong with the report.
pub fn say_refused(summary: &ReportSummary, output: &Output) {
    say_faults(&summary.faults, output);
    for left_out in &summary.templates_left_out {
        output.message(&format!("the program's template stands in place of {left_out}"));
    }
    if let Some(refused) = &summary.refused {
        output.error(&format!("the report was not written. {refused}"));
    }
}

/// Where the report is and what it lacks, or why it was not made.
pub fn print(summary: &ReportSummary, output: &Output) {
    say_refused(summary, output);
    if !summary.altered.is_empty() {
        let files = counted(summary.altered.len(), "file");
        let first: Vec<&str> = summary.altered.iter().map(String::as_str).take(NAMED).collect();
        let more = if first.len() < summary.altered.len() {
            ", ..."
        } else {
            ""
        };
        output.message(&format!(
            "{files} of the report not as written before, made anew: {}{more}",
            first.join(", ")
        ));
    }
    match (&summary.refused, summary.rendered) {
        (Some(_), _) => {}
        // A report that could not be made has no page to open.
        (None, false) if summary.index.as_os_str().is_empty() => {}
        (None, true) => output.result(&format!("Report: {}", summary.index.display())),
        (None, false) => output.result(&format!("Report: {} (unchanged)", summary.index.display())),
    }
}
