//! `ieap run --only dma`.

use clap::Args;

use super::campaign::CampaignArg;
use super::exit::{self, CliError};
use super::global::Global;
use super::ingest;
use super::output::Output;
use crate::pipeline::documents::dma::{SCHEMA, dma};
use crate::pipeline::{AnalyseModulus, Ingest};

/// A step of `run`: humidity steps in modulus logs
///
/// Finds the steps in the logs under dma/ and what the modulus does at each, after taking in new files.
#[derive(Debug, Args)]
#[command(override_usage = "ieap run --only dma [OPTIONS] [CAMPAIGN]")]
pub struct DmaArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Analyse again even where nothing changed
    #[arg(long)]
    again: bool,
}

pub fn run(args: &DmaArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let mut context = args.campaign.open(global, output)?;
    let ingest = Ingest { ready: &mut |_| true }.run(&mut context, output)?;
    ingest::left_out(&ingest, output);
    let summary = AnalyseModulus { again: args.again }.run(&mut context, output)?;
    output.message(&format!(
        "{} analysed, {} up to date, {} could not be analysed",
        summary.analysed,
        summary.up_to_date,
        summary.failed.len()
    ));
    summary
        .failed
        .iter()
        .for_each(|(path, issue)| output.issue(path, issue));
    super::fit::say_changing(&summary.changing, output);
    let (found, blocks) = dma(&context)?;
    output.show(SCHEMA, &found, &blocks)?;
    let all_made = summary.changing.is_empty();
    Ok(exit::after(
        summary.has_fault(),
        all_made && !ingest.left_out_inputs(),
    ))
}
