//! `ieap compare`.

use crate::domain::number::{fixed, significant, with_sign};
use crate::domain::words::counted;
use std::collections::{BTreeMap, BTreeSet};

use clap::Args;

use super::campaign::CampaignArg;
use super::exit::{self, CliError};
use super::global::Global;
use super::ingest;
use super::output::Output;
use crate::pipeline::documents::comparison::comparison_document;
use crate::pipeline::{CompareModels, CompareSummary, ComparedCondition, ComparedModel, Ingest};

/// Hold several models against the same runs
///
/// What each leaves in units of the noise, what it predicts of later times and of other voltages, and which is
/// best for which material in which environment.
///
/// The campaign's fits stay as they are. The report shows what was compared last, as do `ieap table models` and
/// `ieap figure models`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    #[command(flatten)]
    campaign: CampaignArg,
    /// Models, with commas between them [default: lumped-1, lumped-2 and every rival; `ieap list models` lists them]
    #[arg(long, value_name = "MODELS", value_delimiter = ',')]
    models: Vec<String>,
    /// Compare again even where nothing changed
    #[arg(long)]
    again: bool,
}

pub fn run(args: &CompareArgs, global: &Global, output: &Output) -> Result<u8, CliError> {
    let compare = CompareModels {
        models: args.models.iter().map(|id| id.trim().to_owned()).collect(),
        again: args.again,
    };
    let mut context = args.campaign.open(global, output)?;
    let ingest = Ingest { ready: &mut |_| true }.run(&mut context, output)?;
    ingest::left_out(&ingest, output);
    let summary = compare.run(&mut context, output)?;
    say(&summary, output);
    let found = &summary.conditions;
    found.iter().for_each(|condition| print(condition, output));
    if found.is_empty() {
        output.result("no run that models could be compared on: one needs a voltage in steps and a current");
    }
    output.document(&comparison_document(&summary))?;
    let all_taken = summary.changing.is_empty() && !ingest.left_out_inputs();
    Ok(exit::after(!summary.faults.is_empty(), all_taken))
}

fn say(summary: &CompareSummary, output: &Output) {
    output.message(&format!(
        "{} compared, {} up to date, {} on which no model could be fitted",
        counted(summary.compared, "run"),
        summary.up_to_date,
        summary.failed.len()
    ));
    for (run, why) in &summary.failed {
        output.message(&format!("{run}: {why}"));
    }
    say_missing(summary, output);
    super::fit::say_changing(&summary.changing, output);
    for fault in &summary.faults {
        output.error(&format!(
            "{fault}: the comparison stopped on an internal fault; report it with the runs' files"
        ));
    }
}

/// Models that do not describe all of some runs, with the reason: one line a reason.
fn say_missing(summary: &CompareSummary, output: &Output) {
    let mut reasons: BTreeMap<&str, (BTreeSet<&str>, BTreeSet<&str>)> = BTreeMap::new();
    for found in summary
        .comparisons
        .iter()
        .filter(|found| !found.curves.is_empty())
    {
        for score in &found.models {
            if let Some(why) = &score.missing {
                let (models, runs) = reasons.entry(why).or_default();
                models.insert(&score.model);
                runs.insert(&found.run);
            }
        }
    }
    for (why, (models, runs)) in reasons {
        let models: Vec<&str> = models.into_iter().collect();
        output.message(&format!(
            "{}, {}: {why}",
            counted(runs.len(), "run"),
            models.join(", ")
        ));
    }
}

/// The answer, then a line for every model.
fn print(condition: &ComparedCondition, output: &Output) {
    output.result(&condition.sentence);
    output.result(&format!(
        "    {:<22} {:>4} {:>10} {:>8} {:>9} {:>8} {:>8} {:>8} {:>7}",
        "model", "runs", "parameters", "current", "curvature", "later", "voltages", "BIC", "time s"
    ));
    for model in &condition.models {
        output.result(&line(model));
    }
    output.result("");
}

fn line(model: &ComparedModel) -> String {
    let noise = |number: Option<f64>| match number {
        None => "–".to_owned(),
        Some(number) if number < 1e5 => fixed(number, 2),
        Some(number) => significant(number, 1),
    };
    let whole = |number: Option<f64>| number.map_or("–".to_owned(), |number| fixed(number, 0));
    let bic = match model.bic_beyond_best {
        Some(0.0) => "best".to_owned(),
        Some(bic) => with_sign(bic, 0),
        None => "–".to_owned(),
    };
    format!(
        "    {:<22} {:>4} {:>10} {:>8} {:>9} {:>8} {:>8} {:>8} {:>7}",
        model.model,
        model.runs,
        whole(model.parameters),
        noise(model.leaves_current),
        noise(model.leaves_curvature),
        noise(model.later),
        noise(model.other_voltages),
        bic,
        fixed(model.seconds, 2)
    )
}
