//! `ieap diagnose`.

use crate::domain::number::probabilities::equation;
use crate::domain::number::{fixed, significant};
use crate::domain::words::counted;
use clap::Args;

use super::campaign::CampaignArg;
use super::exit::{self, CliError, INTERRUPTED};
use super::global::Global;
use super::ingest;
use super::interrupted::{GoesOn, interrupted};
use super::output::Output;
use super::signals;
use crate::domain::number::estimates::{in_words, interval_in_words};
use crate::domain::{Gain, Verdict};
use crate::model::effects;
use crate::pipeline::documents::diagnosis::{
    DiagnosisDocument, EffectEntry, GroupEntry, diagnosis_document, group_title,
};
use crate::pipeline::documents::gain_words::gained;
use crate::pipeline::{
    Adopt, Context, DiagnoseChoice, DiagnoseRuns, DiagnoseSummary, FitChoice, FitRuns, Ingest, stands_in,
};

/// Say what the simulation gets wrong in each group of runs, name the cause, and measure what the extended
/// model gains; after taking in new files and fitting what is due
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
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(99..=100_000))]
    draws: Option<u32>,
    /// Only the group of that name
    #[arg(long, value_name = "NAME")]
    group: Option<String>,
    /// Adopt the extended model of every group whose cause is named (with --group: of that one): written to
    /// campaign.toml, and the group's runs are fitted with it at once and from then on
    #[arg(long)]
    adopt: bool,
}

/// Said where the work under way did not end by itself in time.
const CUT_OFF: &str = "Interrupted. What was made so far is kept; `ieap diagnose` goes on from there.";

pub fn run(args: &DiagnoseArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let interrupt = signals::listen(global.quiet, INTERRUPTED, CUT_OFF)?;
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
        draws: args.draws.map(|draws| draws as usize),
        seed: global.seed,
    };
    // Wrong usage is told before anything is taken in or fitted.
    let instead = stands_in(&choice, &context.campaign)?;
    let ingest = Ingest { ready: &mut |_| true }.run(context, output)?;
    ingest::left_out(&ingest, output);
    fit_what_is_due(global, context, output)?;
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
    document.groups.iter().for_each(|group| print(group, output));
    print_across(&document, output);
    if args.adopt {
        adopt(args, global, context, output)?;
    }
    super::faults::say_faults(&document.faults, output);
    output.document(&document)?;
    Ok(exit::after(
        summary.has_fault() || !document.faults.is_empty(),
        !ingest.left_out_inputs(),
    ))
}

/// Fits what has no current fit, without which nothing is asked across runs.
fn fit_what_is_due(global: &Global, context: &mut Context, output: &Output) -> Result<(), CliError> {
    let choice = FitChoice {
        seed: global.seed,
        ..FitChoice::default()
    };
    let fits = FitRuns { choice, again: false }.run(context, output)?;
    if fits.fitted + fits.failed.len() > 0 {
        super::fit::say(&fits, output);
    }
    Ok(())
}

/// Adopts what the findings name and fits it.
fn adopt(
    args: &DiagnoseArgs,
    global: &Global,
    context: &mut Context,
    output: &Output,
) -> Result<(), CliError> {
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
            "no group's finding names a cause"
        } else {
            "every group whose cause is named has its model already"
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
}

/// The gain on later times, where whole runs were held out.
fn later_words(gain: &Gain) -> String {
    gain.later
        .as_ref()
        .map_or_else(String::new, |later| format!("; on later times {}", gained(later)))
}

fn print(group: &GroupEntry, output: &Output) {
    let count = counted(group.runs.len(), "run");
    let doubt = if group.verdict.names_a_cause() && group.gain_is_clear == Some(false) {
        ", not proved"
    } else {
        ""
    };
    let verdict = group.verdict.key();
    let title = group_title(&group.group);
    output.heading(&format!("{title} ({count}): {verdict}{doubt}"));
    output.result(&format!("    {}", group.sentence));
    for condemned in &group.condemned {
        output.result(&format!(
            "    {} is set aside: {}",
            condemned.run, condemned.reason
        ));
    }
    group
        .effects
        .iter()
        .for_each(|effect| print_effect(effect, output));
    if let Some(node) = &group.node {
        let percent = (100.0 * node.probability).min(99.9);
        output.result(&format!(
            "    tells: {} ({} %)",
            node.path.join(" > "),
            fixed(percent, 1)
        ));
    }
    if group.set.len() > 1 && group.verdict == Verdict::Set {
        output.result(&format!("    may be: {}", group.set.join(", ")));
    }
    if let Some(gain) = &group.gain {
        output.result(&format!(
            "    {}on held-out {} {}{}; what is left falls from {} to {} times the noise",
            match group.verdict {
                Verdict::Unknown => "what was tried and not accepted: ",
                _ => "",
            },
            gain.parts_word(group.runs.len()),
            gained(&gain.proof),
            later_words(gain),
            fixed(gain.residual_rms_sigma_before, 1),
            fixed(gain.residual_rms_sigma_after, 1)
        ));
    }
    if let Some(next) = &group.next_run {
        output.result(&format!(
            "    measure next: {}; tells apart {}",
            next.drive,
            next.splits.join(", ")
        ));
    }
    // The clearest run is among the remarks already.
    for told in &group.lumped_or_distributed {
        let line = format!("{}: {}", told.run, told.sentence);
        if !group.remarks.contains(&line) {
            output.result(&format!("    lumped or distributed: {line}"));
        }
    }
    for remark in &group.remarks {
        output.result(&format!("    note: {remark}"));
    }
}

/// What holds across runs: what the design leaves open first, then what may be claimed.
fn print_across(document: &DiagnosisDocument, output: &Output) {
    if document.campaign_tests.is_empty()
        && document.campaign_confounded.is_empty()
        && document.campaign_doubted.is_empty()
    {
        return;
    }
    output.result(&format!(
        "across runs: {} asked, {} claimed",
        counted(document.campaign_tests.len(), "question"),
        document.campaign.len()
    ));
    for tied in &document.campaign_confounded {
        output.result(&format!("    {}", tied.sentence));
    }
    for doubted in &document.campaign_doubted {
        output.result(&format!("    {}", doubted.sentence));
    }
    for found in &document.campaign {
        output.result(&format!(
            "    {}: {} (p = {}, {})",
            found.effect,
            found.sentence,
            significant(found.p, 3),
            equation("q", found.q)
        ));
    }
    if !document.campaign_next_runs.is_empty() {
        output.result(&format!(
            "    {} to make next: `ieap next`",
            counted(document.campaign_next_runs.len(), "run")
        ));
    }
    if !document.campaign_contrasts.is_empty() {
        output.result("    what the study asked: `ieap study`");
    }
}

fn print_effect(effect: &EffectEntry, output: &Output) {
    let variant = effect
        .variant
        .as_ref()
        .map_or_else(String::new, |variant| format!(" ({variant})"));
    let q = effect
        .q
        .map_or_else(String::new, |q| format!(", {}", equation("q", q)));
    output.result(&format!(
        "    {}{variant}  {}{q}",
        effect.effect,
        equation("p", effect.p)
    ));
    let about = effects::effect(&effect.effect).map(|effect| effect.about());
    for (key, parameter) in &effect.parameters {
        let unit = about
            .and_then(|about| about.parameters.iter().find(|known| known.key == key))
            .map_or("", |known| known.unit);
        let line = format!(
            "{key:<26} {}{}",
            in_words(parameter),
            interval_in_words(parameter)
        );
        output.result(&format!("        {line}  [{unit}]"));
    }
}
