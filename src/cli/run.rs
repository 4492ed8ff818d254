//! `ieap run`.

use clap::Args;
use serde_json::json;

use super::exit::{CliError, STORAGE};
use super::fit_choice::FitChoiceArgs;
use super::output::Output;
use super::{CampaignArg, Global, diagnose, ingest, report};
use crate::pipeline::{Run, RunSummary};

/// Take in new files, fit every run, diagnose every group and render the report; once. Running again does only what is new
#[derive(Debug, Args)]
pub struct RunArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    #[command(flatten)]
    fit: FitChoiceArgs,
    /// Leave the diagnosis for later (`ieap diagnose`)
    #[arg(long)]
    no_diagnose: bool,
}

pub fn run(args: &RunArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let mut context = args.campaign.open(global, output)?;
    let summary = Run {
        fit: args.fit.choice(global),
        skip_diagnosis: args.no_diagnose,
    }
    .run(&mut context, output)?;
    print(&summary, output);
    output.document(&json!({ "schema": "ieap/run/1", "run": summary }))?;
    Ok(status(&summary))
}

/// Done, or done without some of the files; a report that could not be written comes first.
pub fn status(summary: &RunSummary) -> u8 {
    match summary.report.refused {
        Some(_) => STORAGE,
        None => ingest::status(&summary.ingest),
    }
}

/// What was done, and where the report is.
pub fn print(summary: &RunSummary, output: &Output) {
    ingest::print(&summary.ingest, output);
    let fit = &summary.fit;
    output.result(&format!(
        "fits: {} new, {} up to date, {} could not be made",
        fit.fitted,
        fit.up_to_date,
        fit.failed.len()
    ));
    fit.failed
        .iter()
        .for_each(|(path, issue)| output.issue(path, issue));
    super::fit::say_unknown_groups(fit, output);
    for path in &fit.not_converged {
        output.message(&format!("  {path}: the search did not converge; see its page"));
    }
    let modulus = &summary.modulus;
    if modulus.analysed + modulus.up_to_date + modulus.failed.len() > 0 {
        output.result(&format!(
            "modulus logs: {} analysed, {} up to date, {} could not be analysed",
            modulus.analysed,
            modulus.up_to_date,
            modulus.failed.len()
        ));
        modulus
            .failed
            .iter()
            .for_each(|(path, issue)| output.issue(path, issue));
    }
    let diagnosed = &summary.diagnose;
    diagnose::say(diagnosed, output);
    let left = match diagnosed.left {
        0 => String::new(),
        left => format!(", {left} to come"),
    };
    output.result(&format!(
        "diagnoses: {} new, {} up to date{left}",
        diagnosed.diagnosed, diagnosed.up_to_date
    ));
    if summary.alarms.standing > 0 {
        output.result(&format!(
            "alarms: {} ({} new); see `ieap status --alarms`",
            summary.alarms.standing,
            summary.alarms.new.len()
        ));
    }
    report::print(&summary.report, output);
}
