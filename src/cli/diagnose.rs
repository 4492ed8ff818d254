//! `ieap diagnose`.

use crate::domain::words::counted;
use clap::Args;

use super::campaign::CampaignArg;
use super::exit::{self, CliError};
use super::global::Global;
use super::ingest;
use super::interrupted::{GoesOn, interrupted};
use super::output::Output;
use super::signals;
use crate::pipeline::documents::diagnosis::{DiagnosisDocument, GroupEntry, diagnosis_document};
use crate::pipeline::documents::group_lines::lines;
use crate::pipeline::{
    Adopt, Context, DiagnoseChoice, DiagnoseRuns, DiagnoseSummary, Draws, FitChoice, FitRuns, Ingest,
    stands_in,
};

/// Say what the model gets wrong, and name the cause
///
/// New files are taken in and what is due is fitted before. What the extended model gains is measured on runs
/// that it has not seen.
#[derive(Debug, Args)]
pub struct DiagnoseArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Base model [default: the campaign's]
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// Diagnose again even where nothing changed
    #[arg(long)]
    again: bool,
    /// Draws of what chance does; a p-value is never below 1 in N + 1 [default: 999]
    #[arg(long, value_name = "N")]
    draws: Option<Draws>,
    /// Only the group of that name
    #[arg(long, value_name = "NAME")]
    group: Option<String>,
    /// Adopt the extended model of every group of which a law is missing (with --group: of that one): written to
    /// campaign.toml, and the group's runs are fitted with it at once and from then on
    #[arg(long)]
    adopt: bool,
}

/// Said where the work under way did not end by itself in time.
const CUT_OFF: &str = "Interrupted. What was made so far is kept; `ieap diagnose` goes on from there.";

pub fn run(args: &DiagnoseArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let interrupt = signals::listen(global.quiet, None, CUT_OFF)?;
    let mut context = args.campaign.open(global, output)?;
    let done = interrupt.run(|| diagnosed(args, global, &mut context, output));
    done.unwrap_or_else(|| {
        let goes_on = GoesOn {
            verb: "diagnose",
            diagnoses: true,
            reports: false,
        };
        interrupted(&context, &goes_on, output)
    })
}

fn diagnosed(
    args: &DiagnoseArgs,
    global: &Global,
    context: &mut Context,
    output: &Output,
) -> Result<u8, CliError> {
    let choice = DiagnoseChoice {
        model: args.model.clone(),
        draws: args.draws.map(Draws::count),
        seed: global.seed,
    };
    // Wrong usage is told before anything is taken in or fitted.
    let instead = stands_in(&choice, &context.campaign)?;
    let ingest = Ingest { ready: &mut |_| true }.run(context, output)?;
    ingest::left_out(&ingest, output);
    let mut all_made = fit_what_is_due(global, context, output)?;
    instead.iter().for_each(|words| output.message(words));
    let summary = DiagnoseRuns {
        choice: choice.clone(),
        again: args.again,
        group: args.group.clone(),
    }
    .run(context, output)?;
    say(&summary, output);
    output.message(&format!(
        "{} diagnosed, {} up to date",
        summary.diagnosed, summary.up_to_date
    ));
    let document = diagnosis_document(context, &choice, args.group.as_deref())?;
    document
        .groups
        .iter()
        .for_each(|group| print(group, document.draws, output));
    print_across(&document, output);
    for aside in &document.set_aside {
        output.message(&format!(
            "{} takes no part: {}. {}",
            aside.run, aside.reason, aside.mend
        ));
    }
    if args.adopt {
        all_made &= adopt(args, global, context, output)?;
    }
    super::faults::say_faults(&document.faults, output);
    output.document(&document)?;
    Ok(exit::after(
        summary.has_fault() || !document.faults.is_empty(),
        all_made && summary.changing.is_empty() && !ingest.left_out_inputs(),
    ))
}

/// Fits what has no current fit, without which the study has no answer. Tells whether none was left.
fn fit_what_is_due(global: &Global, context: &mut Context, output: &Output) -> Result<bool, CliError> {
    let choice = FitChoice {
        seed: global.seed,
        ..FitChoice::default()
    };
    let fits = FitRuns { choice, again: false }.run(context, output)?;
    if fits.fitted + fits.failed.len() + fits.changing.len() > 0 {
        super::fit::say(&fits, output);
    }
    Ok(fits.changing.is_empty())
}

/// Adopts what the findings name and fits it.
fn adopt(
    args: &DiagnoseArgs,
    global: &Global,
    context: &mut Context,
    output: &Output,
) -> Result<bool, CliError> {
    let group = args.group.clone();
    let summary = Adopt { group }.run(context)?;
    for entry in &summary.adopted {
        output.message(&format!(
            "{}: {} adopted in campaign.toml",
            entry.group, entry.model
        ));
    }
    if summary.adopted.is_empty() {
        let why = if summary.unchanged.is_empty() {
            "no group's finding tells a missing law"
        } else {
            "every group of which a law is missing has its model already"
        };
        output.message(&format!("nothing adopted: {why}"));
    }
    fit_what_is_due(global, context, output)
}

/// What went wrong on the way.
pub fn say(summary: &DiagnoseSummary, output: &Output) {
    for key in &summary.unknown_keys {
        output.message(&format!(
            "campaign.toml, group_by: no run carries the tag \"{key}\"; check its spelling"
        ));
    }
    for name in &summary.failed {
        output.message(&format!(
            "  {name}: the diagnosis stopped on an internal fault; report it with the runs' files"
        ));
    }
    super::fit::say_changing(&summary.changing, output);
}

fn print(group: &GroupEntry, draws: usize, output: &Output) {
    let lines = lines(group, draws);
    let mut lines = lines.iter();
    lines.next().into_iter().for_each(|line| output.heading(line));
    lines.for_each(|line| output.result(line));
}

/// Fits in doubt, and where to go on.
fn print_across(document: &DiagnosisDocument, output: &Output) {
    for doubted in &document.campaign_doubted {
        output.result(&format!("    {}", doubted.sentence));
    }
    if !document.campaign_next_runs.is_empty() {
        output.result(&format!(
            "    {} to make next: `ieap plan`",
            counted(document.campaign_next_runs.len(), "run")
        ));
    }
    if !document.campaign_contrasts.is_empty() {
        output.result("    what the study asked: `ieap study`");
    }
}
