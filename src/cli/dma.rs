//! `ieap dma`.

use clap::Args;

use super::campaign::CampaignArg;
use super::exit::{self, CliError};
use super::global::Global;
use super::ingest;
use super::output::Output;
use crate::domain::number::estimates::in_words;
use crate::domain::number::fixed;
use crate::domain::number::seconds::seconds;
use crate::pipeline::documents::dma::{LogEntry, dma_document};
use crate::pipeline::{AnalyseModulus, Ingest};

/// Find the humidity steps in the modulus logs under dma/ and what the modulus does at each, after taking in new files
#[derive(Debug, Args)]
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
    let document = dma_document(&context)?;
    document.logs.iter().for_each(|log| print(log, output));
    output.document(&document)?;
    Ok(exit::after(summary.has_fault(), !ingest.left_out_inputs()))
}

fn print(log: &LogEntry, output: &Output) {
    let sample = log.sample.as_deref().unwrap_or("no sample");
    let steps = match (&log.modulus_source, log.steps.len()) {
        (None, _) => format!("not analysed ({})", log.state.replace('_', " ")),
        (Some(_), 1) => "1 humidity step".to_owned(),
        (Some(_), count) => format!("{count} humidity steps"),
    };
    output.result(&format!("{}  {sample}  {steps}", log.log));
    for step in &log.steps {
        output.result(&format!("  at {} s:", seconds(step.start_s)));
        for (key, entry) in &step.estimates {
            output.result(&format!("    {key:<34} {}", in_words(entry)));
        }
    }
    if let Some(recovery) = &log.recovery_percent {
        output.result(&format!("  {:<36} {}", "recovery_percent", in_words(recovery)));
    }
    for entry in &log.hysteresis {
        let at = entry
            .relative_humidity_percent
            .map_or(String::new(), |percent| format!(" at {} % RH", fixed(percent, 0)));
        let name = format!("hysteresis_percent{at}");
        output.result(&format!("  {name:<36} {}", in_words(&entry.hysteresis_percent)));
    }
}
