//! `ieap report`.

use clap::Args;
use serde_json::json;

use super::exit::{self, CliError};
use super::output::Output;
use super::{CampaignArg, Global, run};
use crate::pipeline::RenderReport;

/// Render the report from the database, without looking for new files
#[derive(Debug, Args)]
pub struct ReportArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Render even where nothing changed
    #[arg(long)]
    again: bool,
}

pub fn run(args: &ReportArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let context = args.campaign.open(global, output)?;
    let summary = RenderReport { again: args.again }.run(&context, output)?;
    run::say_faults(&summary.faults, output);
    output.result(&format!("Report: {}", summary.index.display()));
    output.document(&json!({ "schema": "ieap/report/1", "report": summary }))?;
    Ok(exit::after(!summary.faults.is_empty(), true))
}
