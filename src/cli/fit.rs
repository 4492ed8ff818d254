//! `ieap run --only fit`.

use crate::domain::words::counted;

use clap::Args;

use super::campaign::CampaignArg;
use super::exit::{self, CliError};
use super::fit_choice::FitChoiceArgs;
use super::fit_group::{self, GroupArgs};
use super::global::Global;
use super::ingest;
use super::interrupted::{GoesOn, interrupted};
use super::output::Output;
use super::signals;
use crate::domain::number::estimates::in_words;
use crate::pipeline::documents::fits::{FitEntry, fits_document};
use crate::pipeline::documents::groups::entry;
use crate::pipeline::{Context, FitRuns, FitSummary, Ingest, PipelineError, files_due, left_words};

/// A step of `run`: fit what is new or changed
///
/// New files are taken in before. A run is fitted again where its data, its tags or its model changed.
#[derive(Debug, Args)]
#[command(override_usage = "ieap run --only fit [OPTIONS] [CAMPAIGN]")]
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
    let fits = FitRuns {
        choice: args.fit.choice(global),
        again: args.again,
    };
    let interrupt = signals::listen(global.quiet, None, CUT_OFF)?;
    let due = |context: &Context| due(context, &fits);
    let (mut context, is_to_work) = args.campaign.open_or_read(global, output, due)?;
    if !is_to_work {
        return as_stored(args, global, &context, output);
    }
    let done = interrupt.run(|| fitted(args, &fits, global, &mut context, output));
    if let Some(Err(refused)) = done {
        // A database that cannot be written is noticed by what would be written first.
        return if refused.cannot_write() {
            let context = args.campaign.read_when_done(output, due, refused)?;
            as_stored(args, global, &context, output)
        } else {
            Err(refused)
        };
    }
    done.unwrap_or_else(|| {
        let goes_on = GoesOn {
            verb: "run --only fit",
            diagnoses: false,
            reports: false,
        };
        interrupted(&context, &goes_on, output)
    })
}

/// Said where the work under way did not end by itself in time.
const CUT_OFF: &str = "Interrupted. What was made so far is kept; `ieap run --only fit` goes on from there.";

fn fitted(
    args: &FitArgs,
    fits: &FitRuns,
    global: &Global,
    context: &mut Context,
    output: &Output,
) -> Result<u8, CliError> {
    let ingest = Ingest { ready: &mut |_| true }.run(context, output)?;
    ingest::left_out(&ingest, output);
    let summary = fits.run(context, output)?;
    say(&summary, output);
    tell(args, global, context, output)?;
    let all_made = summary.changing.is_empty();
    Ok(exit::after(
        summary.has_fault(),
        all_made && !ingest.left_out_inputs(),
    ))
}

/// What is to be done before the results are current; none where nothing is.
fn due(context: &Context, fits: &FitRuns) -> Result<Option<String>, CliError> {
    let (files, runs) = (files_due(context)?, fits.due(context)?);
    let due = format!(
        "{} to take in and {} to fit",
        counted(files, "file"),
        counted(runs, "run")
    );
    Ok((files + runs > 0).then_some(due))
}

/// The results as they are stored, where nothing can be written and nothing is to be done.
fn as_stored(args: &FitArgs, global: &Global, context: &Context, output: &Output) -> Result<u8, CliError> {
    tell(args, global, context, output)?;
    Ok(if left_out_inputs(context)? {
        exit::SOME_REFUSED
    } else {
        exit::DONE
    })
}

/// Whether some inputs are not used, as far as is stored.
fn left_out_inputs(context: &Context) -> Result<bool, PipelineError> {
    Ok(!context.store.unsettled_files()?.is_empty()
        || !context.store.unread_files()?.is_empty()
        || !context.store.unreadable_tag_files()?.is_empty())
}

/// The results for people or machines.
fn tell(args: &FitArgs, global: &Global, context: &Context, output: &Output) -> Result<(), CliError> {
    let mut document = fits_document(context)?;
    match args.group.groups(args.fit.choice(global))? {
        None => document.fits.iter().for_each(|fit| print(fit, output)),
        Some(groups) => {
            if !context.campaign.fit.known.is_empty() {
                output.message("what [[fit.known]] in campaign.toml says is not used in these fits");
            }
            let fitted = groups.run(context, output)?.into_iter();
            let groups: Vec<_> = fitted.map(entry).collect();
            groups.iter().for_each(|group| fit_group::print(group, output));
            document.groups = Some(groups);
        }
    }
    output.document(&document)
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
    say_changing(&summary.changing, output);
}

/// What is left because what it depends on changed whenever it was made.
pub(super) fn say_changing(names: &[String], output: &Output) {
    names.iter().for_each(|name| output.message(&left_words(name)));
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
    output.heading(&format!("{}  {}  {}", fit.run, fit.model, fit.why_stopped));
    for (key, parameter) in &fit.parameters {
        output.result(&format!("    {key:<22} {}", in_words(parameter)));
    }
}
