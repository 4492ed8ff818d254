//! `ieap fit`.

use clap::Args;

use super::exit::{self, CliError};
use super::fit_choice::FitChoiceArgs;
use super::fit_group::{self, GroupArgs};
use super::output::Output;
use super::{CampaignArg, Global, ingest};
use crate::pipeline::estimate_words::in_words;
use crate::pipeline::fits_document::{FitEntry, fits_document};
use crate::pipeline::{FitRuns, FitSummary, Ingest};

/// Fit every run that has no fit yet or whose data, tags or model changed, after taking in new files
#[derive(Debug, Args)]
pub struct FitArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    #[command(flatten)]
    fit: FitChoiceArgs,
    /// Fit again even where nothing changed
    #[arg(long)]
    again: bool,
    #[command(flatten)]
    group: GroupArgs,
}

pub fn run(args: &FitArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let mut context = args.campaign.open(global, output)?;
    let ingest = Ingest { ready: &mut |_| true }.run(&mut context, output)?;
    ingest::left_out(&ingest, output);
    let summary = FitRuns {
        choice: args.fit.choice(global),
        again: args.again,
    }
    .run(&mut context, output)?;
    say(&summary, output);
    let mut document = fits_document(&context)?;
    match args.group.groups(args.fit.choice(global))? {
        None => document.fits.iter().for_each(|fit| print(fit, output)),
        Some(groups) => {
            let groups = groups.run(&context, output)?;
            groups.iter().for_each(|group| fit_group::print(group, output));
            document.groups = Some(groups);
        }
    }
    output.document(&document)?;
    Ok(exit::after(summary.has_fault(), !ingest.left_out_inputs()))
}

/// What was fitted, and what went wrong on the way.
pub(super) fn say(summary: &FitSummary, output: &Output) {
    output.message(&format!(
        "{} fitted, {} up to date, {} could not be fitted",
        summary.fitted,
        summary.up_to_date,
        summary.failed.len()
    ));
    say_choices(summary, output);
    say_unknown_groups(summary, output);
    summary
        .failed
        .iter()
        .for_each(|(path, issue)| output.issue(path, issue));
}

/// Which choices of method, steps and model hold, and where they come from.
pub(super) fn say_choices(summary: &FitSummary, output: &Output) {
    summary
        .choices
        .iter()
        .for_each(|choice| output.message(&choice.words()));
}

/// Groups that a model is adopted for and that are not there.
pub(super) fn say_unknown_groups(summary: &FitSummary, output: &Output) {
    for group in &summary.unknown_groups {
        output.message(&format!(
            "campaign.toml, [[adopted]]: there is no group \"{group}\"; `ieap diagnose` prints their names"
        ));
    }
}

fn print(fit: &FitEntry, output: &Output) {
    output.result(&format!("{}  {}  {}", fit.run, fit.model, fit.why_stopped));
    for (key, parameter) in &fit.parameters {
        output.result(&format!("    {key:<22} {}", in_words(parameter)));
    }
}
