//! `ieap run`.

use clap::Args;
use serde_json::json;

use super::exit::{self, CliError};
use super::fit_choice::FitChoiceArgs;
use super::output::{Output, counted};
use super::{CampaignArg, Global, diagnose, ingest};
use crate::domain::Fault;
use crate::pipeline::status::raw_files_lost;
use crate::pipeline::{Context, Run, RunSummary};

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
    /// Make a new database from the files in the campaign, where the old one is lost or damaged; it is moved aside
    #[arg(long, conflicts_with = "new_archive")]
    new_database: bool,
    /// Make a new archive from the files in the campaign, where the old one is lost
    #[arg(long)]
    new_archive: bool,
}

pub fn run(args: &RunArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let mut context = open(args, global, output)?;
    let summary = Run {
        fit: args.fit.choice(global),
        skip_diagnosis: args.no_diagnose,
    }
    .run(&mut context, output)?;
    print(&summary, output);
    output.document(&json!({ "schema": "ieap/run/1", "run": summary }))?;
    let mut all_taken = !summary.ingest.left_out_inputs();
    if args.new_archive {
        let lost = raw_files_lost(&context)?;
        for file in &lost {
            file.issues
                .iter()
                .for_each(|issue| output.issue(&file.path, issue));
        }
        all_taken &= lost.is_empty();
    }
    Ok(exit::after(summary.has_fault(), all_taken))
}

/// Opens the campaign, with a new database or a new archive where that is asked for, and says what that means.
fn open(args: &RunArgs, global: &Global, output: &Output) -> Result<Context, CliError> {
    let folder = args.campaign.folder()?;
    let context = if args.new_database {
        let (context, aside) = Context::open_with_new_database(&folder, global.i_know)?;
        if let Some(aside) = aside {
            output.message(&format!("The old database was moved aside: {}", aside.display()));
        }
        output.message(
            "A new database is made. What only the old one held is not in it: tags set by hand, which runs were \
             dropped and why, earlier revisions and fits, which alarms were told, and runs whose files are gone.",
        );
        context
    } else if args.new_archive {
        let context = Context::open_with_new_archive(&folder, global.i_know)?;
        output.message(
            "A new archive is made from the files in the campaign; `ieap status` lists what it lacks.",
        );
        context
    } else {
        return args.campaign.open(global, output);
    };
    super::say_what_is_not_understood(&context, output);
    Ok(context)
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
