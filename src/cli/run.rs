//! `ieap run`.

use std::convert::Infallible;

use crate::domain::words::counted;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde_json::json;

use super::allow_command::AllowCommandArg;
use super::campaign::CampaignArg;
use super::exit::{self, CliError, STORAGE};
use super::faults::say_faults;
use super::fit_choice::FitChoiceArgs;
use super::global::Global;
use super::interrupted::{GoesOn, interrupted};
use super::output::Output;
use super::tag::user_name;
use super::words::{self, STEPS};
use super::{diagnose, ingest, report, signals};
use crate::pipeline::upkeep::verify::archive::raw_files_lost;
use crate::pipeline::upkeep::verify::missed;
use crate::pipeline::{Context, DiagnoseSummary, Made, Run, RunSummary, answer};

/// Read new files, fit, diagnose and write the report
///
/// Running it again does only what is new.
#[derive(Debug, Args)]
pub struct RunArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Do one step only, with options of its own, which `ieap run --only STEP --help` tells
    #[arg(long, value_name = "STEP", value_parser = PossibleValuesParser::new(STEPS).try_map(words::read))]
    only: Option<Infallible>,
    #[command(flatten)]
    fit: FitChoiceArgs,
    /// Leave the diagnosis for later (`ieap diagnose`)
    #[arg(long)]
    no_diagnose: bool,
    /// Make a new database from the files in the campaign, where the old one is lost or damaged; it is moved aside
    #[arg(long, hide = true, conflicts_with = "new_archive")]
    new_database: bool,
    /// Make a new archive from the files in the campaign, where the old one is lost
    #[arg(long, hide = true)]
    new_archive: bool,
    /// Say that you looked after words that may be lost since a rebuilding, and what you found: it is kept in the journal, and
    /// `status` and `run` then end as ever
    #[arg(long, value_name = "TEXT")]
    answer: Option<String>,
    #[command(flatten)]
    command: AllowCommandArg,
}

pub fn run(args: &RunArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    if let Some(never) = args.only {
        match never {}
    }
    let interrupt = signals::listen(global.quiet, None, CUT_OFF)?;
    let mut context = open(args, global, output)?;
    if let Some(found) = &args.answer {
        let lost = answer(&mut context, found, user_name())?;
        if lost.is_empty() {
            output.message("no words are known that may be lost: nothing to answer");
        }
        lost.iter()
            .for_each(|lost| output.message(&format!("answered: {lost}")));
    }
    let job = Run {
        fit: args.fit.choice(global),
        skip_diagnosis: args.no_diagnose,
        commands: args.command.allowed(&context, output)?,
    };
    let Some(done) = interrupt.run(|| job.run(&mut context, output)) else {
        let goes_on = GoesOn {
            verb: "run",
            diagnoses: !args.no_diagnose,
            reports: true,
        };
        return interrupted(&context, &goes_on, output);
    };
    let summary = done?;
    print(&summary, output);
    output.document(&json!({ "schema": "ieap/run/1", "run": summary }))?;
    let mut all_taken = !summary.ingest.left_out_inputs() && !summary.left_results();
    if args.new_archive {
        let lost = raw_files_lost(&context)?;
        for file in &lost {
            file.issues
                .iter()
                .for_each(|issue| output.issue(&file.path, issue));
        }
        all_taken &= lost.is_empty();
    }
    all_taken &= missed(&context)?.is_empty();
    Ok(status(&summary, all_taken))
}

/// Said where the work under way did not end by itself in time.
const CUT_OFF: &str = "Interrupted. What was made so far is kept; `ieap run` goes on from there.";

/// Done, done without some of the files, or done but for what a fault of the program left out, which comes first; then comes
/// a report that could not be written.
fn status(summary: &RunSummary, all_taken: bool) -> u8 {
    match summary.report.refused {
        Some(_) if !summary.has_fault() => STORAGE,
        _ => exit::after(
            summary.has_fault(),
            all_taken && summary.report.templates_left_out.is_empty(),
        ),
    }
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
            "A new database is made from the files in the campaign alone; the journal was moved aside with the old one. Not \
             in it are tags set by hand, which runs were dropped and why, earlier revisions and fits, which alarms were \
             told, and runs whose files are gone.",
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
    super::campaign::say_what_is_not_understood(&context, output);
    Ok(context)
}

/// What was done, and where the report is.
fn print(summary: &RunSummary, output: &Output) {
    if output.is_quiet() {
        say_faults(&summary.faults, output);
        report::say_refused(&summary.report, output);
        return;
    }
    ingest::print(&summary.ingest, output);
    let made = Made {
        fit: summary.fit.clone(),
        modulus: summary.modulus.clone(),
        alarms: summary.alarms.clone(),
        faults: Vec::new(),
    };
    print_made(&made, output);
    print_diagnosed(&summary.diagnose, output);
    if !summary.set_aside.is_empty() {
        let runs = counted(summary.set_aside.len(), "run");
        output.result(&format!(
            "set aside, in no result: {runs}; `ieap status` says why"
        ));
    }
    say_faults(&summary.faults, output);
    report::print(&summary.report, output);
}

/// Fits, modulus logs and alarms.
pub fn print_made(made: &Made, output: &Output) {
    let fit = &made.fit;
    output.result(&format!(
        "fits: {} new, {} up to date, {} could not be made",
        fit.fitted,
        fit.up_to_date,
        fit.failed.len()
    ));
    fit.failed
        .iter()
        .for_each(|(path, issue)| output.issue(path, issue));
    super::fit::say_changing(&fit.changing, output);
    super::fit::say_choices(fit, output);
    super::fit::say_unknown_groups(fit, output);
    for path in &fit.not_converged {
        output.message(&format!("  {path}: the search did not converge; see its page"));
    }
    let modulus = &made.modulus;
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
    super::fit::say_changing(&modulus.changing, output);
    if made.alarms.standing > 0 {
        output.result(&format!(
            "alarms: {} ({} new); see `ieap status --alarms`",
            made.alarms.standing,
            made.alarms.new.len()
        ));
    }
    say_faults(&made.faults, output);
}

/// What was diagnosed, and what is to come.
pub fn print_diagnosed(diagnosed: &DiagnoseSummary, output: &Output) {
    diagnose::say(diagnosed, output);
    let left = match diagnosed.left {
        0 => String::new(),
        left => format!(", {left} to come"),
    };
    output.result(&format!(
        "diagnoses: {} new, {} up to date{left}",
        diagnosed.diagnosed, diagnosed.up_to_date
    ));
}
