//! Every run: what was measured, when, and how well it is fitted; and its tags.

use super::TableInput;
use super::of_run::{OfRun, Own, of_runs_and_conditions};
use ieap_domain::{Fit, RunFile, RunRecord, Severity, Tag};
use ieap_show::quantities::{Quantity, R_SQUARED_CURRENT, R_SQUARED_CURVATURE};
use ieap_show::{Made, Printed, Sheet, Value};

const OUTCOME: Quantity = Quantity::plain("outcome", "State", "what became of the run");
const MODEL: Quantity = Quantity::plain("model", "Model", "model of its fit");

type Of<'a> = Own<'a, &'a RunRecord>;

/// Makes the table.
pub fn make<M: Made>(input: &TableInput) -> M {
    let joined = |run: &RunRecord, of: fn(&RunFile) -> &str| {
        let files: Vec<&str> = run.files.iter().map(of).collect();
        files.join(" ")
    };
    let score = |own: &OfRun, of: fn(&Fit) -> Option<f64>| {
        let (fit, score) = (own.fit()?, of(own.fit()?)?);
        let printed = fit.converged.then_some(Value::Score(score));
        Some(Printed(score, printed.into()))
    };
    let sheet = of_runs_and_conditions("runs", "Runs", input.campaign.timezone.as_deref())
        .column(OUTCOME, |(_, run): &Of| outcome(run))
        .column(MODEL, |(own, _)| own.fit().map(|fit| fit.model.clone()))
        .column(R_SQUARED_CURRENT, move |(own, _)| {
            score(own, |fit| fit.r_squared_current)
        })
        .column(R_SQUARED_CURVATURE, move |(own, _)| {
            score(own, |fit| fit.r_squared_curvature)
        })
        .in_files(|sheet| {
            sheet
                .plain("state", |(_, run)| run.state.key())
                .plain("standing", |(_, run)| run.standing.key())
                .plain("standing_reason", |(_, run)| {
                    Some(run.standing.reason()).filter(|why| !why.is_empty())
                })
                .plain("status", |(_, run)| run.status.key())
                .plain("technique", |(_, run)| run.technique.clone())
                .plain("format", |(_, run)| run.format.as_str())
                .plain("files", move |(_, run)| joined(run, |file| &file.path))
                .plain("file_hashes_blake3", move |(_, run)| {
                    joined(run, |file| &file.hash)
                })
                .plain("data_hash", |(_, run)| run.data_hash.as_str())
                .plain("ingested_at", |(_, run)| run.ingested_at.as_str())
                .plain("area_cm2", |(_, run)| run.area_cm2)
                .plain("model_version", |(own, _)| Some(own.fit()?.model_version))
                .plain("converged", |(own, _)| Some(own.fit()?.converged))
                .plain("readings_fitted", |(own, _)| Some(own.fit()?.n_samples))
                .plain("warnings", |(_, run)| warnings(run))
        });
    sheet.made(every(input).map(|run| (OfRun::of(input.campaign, run), run)))
}

/// Every run, those that no result is made from last.
fn every<'a>(input: &TableInput<'a>) -> impl Iterator<Item = &'a RunRecord> {
    input.runs.iter().chain(input.set_aside)
}

fn outcome(run: &RunRecord) -> String {
    let words = match &run.fit {
        _ if !run.standing.speaks() => return format!("set aside: {}", run.standing.reason()),
        Some(fit) if fit.converged => "fitted",
        Some(_) => "fit did not converge",
        None => match run.state {
            ieap_domain::RunState::Ready => "not fitted yet",
            ieap_domain::RunState::Untagged => "lacks tags",
            ieap_domain::RunState::NotFitted => "cannot be fitted",
            ieap_domain::RunState::NoSteps => "no steps",
        },
    };
    words.to_owned()
}

/// Issues of a run and its fit that are more than notes.
fn warnings(run: &RunRecord) -> usize {
    let of_fit = run.fit.iter().flat_map(|fit| &fit.issues);
    let issues = run.issues.iter().chain(of_fit);
    issues.filter(|issue| issue.severity >= Severity::Warning).count()
}

/// Makes the table of tags, from every source; `chosen` tells which value of a key holds: the first.
pub fn tags<M: Made>(input: &TableInput) -> M {
    type OfTag<'a> = (&'a RunRecord, usize, &'a Tag);
    fn tags_of(run: &RunRecord) -> impl Iterator<Item = OfTag<'_>> {
        let tags = run.tags.iter().enumerate();
        tags.map(move |(at, tag)| (run, at, tag))
    }
    Sheet::<OfTag>::new("tags", "Tags of the runs", 2)
        .called(|(run, at, tag)| format!("{}, {} {}", run.path, at + 1, tag.key))
        .plain("run", |(run, ..)| run.path.as_str())
        .plain("key", |(.., tag)| tag.key.as_str())
        .plain("value", |(.., tag)| tag.value.as_str())
        .plain("source", |(.., tag)| tag.source.key())
        .plain("detail", |(.., tag)| tag.detail.as_str())
        .plain("chosen", |(run, at, tag)| {
            !run.tags[..*at].iter().any(|earlier| earlier.key == tag.key)
        })
        .made(every(input).flat_map(tags_of))
}
