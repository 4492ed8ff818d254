//! `ieap run`.

use clap::Args;
use serde_json::json;

use super::exit::{self, CliError};
use super::fit_choice::FitChoiceArgs;
use super::output::{Output, counted};
use super::{CampaignArg, Global, diagnose, ingest};
use crate::domain::Fault;
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

/// Done, done with refusals, or done but for what a fault of the program left out.
pub fn status(summary: &RunSummary) -> u8 {
    exit::after(summary.has_fault(), summary.ingest.refused.is_empty())
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
    super::fit::say_choices(fit, output);
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
    if !summary.set_aside.is_empty() {
        let runs = counted(summary.set_aside.len(), "run");
        output.result(&format!(
            "set aside, in no result: {runs}; `ieap status` says why"
        ));
    }
    if summary.alarms.standing > 0 {
        output.result(&format!(
            "alarms: {} ({} new); see `ieap status --alarms`",
            summary.alarms.standing,
            summary.alarms.new.len()
        ));
    }
    say_faults(&summary.faults, output);
    say_faults(&summary.report.faults, output);
    let state = if summary.report.rendered {
        ""
    } else {
        " (unchanged)"
    };
    // A report that could not be made has no page to open.
    if !summary.report.index.as_os_str().is_empty() {
        output.result(&format!("Report: {}{state}", summary.report.index.display()));
    }
}

/// What a fault of the program left out.
pub fn say_faults(faults: &[Fault], output: &Output) {
    for fault in faults {
        output.message(&format!(
            "fault of the program, this is missing: {}",
            fault.sentence()
        ));
    }
}
