//! Every claim with its runs: those that it is made from, and those that were left out of it with the reason.

use std::collections::{BTreeMap, BTreeSet};

use super::TableInput;
use super::extended::identity;
use super::of_several::contribution;
use crate::conditions::material;
use crate::laws::facts::{RunFacts, facts};
use crate::one_fit::SharedEstimate;
use crate::parameters::COMPARED;
use crate::study::{Answer, Kind, Verdict, about};
use ieap_domain::tag::keys;
use ieap_domain::{GroupDiagnosis, RunRecord};
use ieap_show::quantities::{Quantity, RUN};
use ieap_show::{Sheet, Source, SourceOrigin, Table};

const KIND: Quantity = Quantity::plain("kind", "Kind", "kind of the claim");
const CLAIM: Quantity = Quantity::plain("claim", "Claim", "what is claimed");
const USED: Quantity = Quantity::plain("used", "Used", "whether the claim is made from the run");
const REASON: Quantity = Quantity::plain("reason", "Left out because", "why the run was left out");

/// A run of a claim, and why it was left out of it; none where it is used.
struct Part<'a> {
    kind: &'static str,
    claim: String,
    run: &'a RunRecord,
    left_out: Option<String>,
}

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let parts = of_study(input)
        .into_iter()
        .chain(of_group_fits(input))
        .chain(of_diagnoses(input));
    Sheet::<Part>::new("runs-used", "Claims and their runs", 3)
        .remarks(
            "Of a law and a contrast every run of the material that might be part of it; of a diagnosis and a fit of a group the runs of the group.",
            "Nothing is claimed.",
        )
        .called(|part| format!("{}, {}, {}", part.kind, part.claim, part.run.path))
        .made_from(|part| vec![Source::of(SourceOrigin::Run(part.run.id), &part.run.path)])
        .column(KIND, |part| part.kind)
        .column(CLAIM, |part| part.claim.clone())
        .column(RUN, |part| part.run.path.as_str())
        .column(USED, |part| part.left_out.is_none())
        .column(REASON, |part| part.left_out.clone())
        .over(parts)
}

/// Every run, also those of which nothing is made.
fn every<'a>(input: &TableInput<'a>) -> impl Iterator<Item = &'a RunRecord> {
    input.runs.iter().chain(input.set_aside)
}

fn of_study<'a>(input: &TableInput<'a>) -> Vec<Part<'a>> {
    let study = input.study();
    let facts = facts(input.runs, input.campaign);
    let facts: FactsByRun = (facts.iter())
        .map(|facts| (input.runs[facts.run].path.as_str(), facts))
        .collect();
    let is_told = |own: &&Answer| match own.kind {
        Kind::Environment => own.is_of_study && own.value.is_some(),
        kind => kind.is_law() && !kind.is_by_material() && own.verdict == Verdict::Differs,
    };
    let mut parts = Vec::new();
    let of_parameter = |own: &&Answer| COMPARED.contains(&own.parameter);
    for found in study.answers.iter().filter(of_parameter).filter(is_told) {
        let used = paths(input, &found.of_runs);
        let kind = if found.kind.is_law() { "law" } else { "contrast" };
        for run in every(input).filter(|run| is_compared(input, found, run)) {
            let left_out = || why_not(input, &facts, run, found);
            parts.push(part(kind, &about(found), run, &used, left_out));
        }
    }
    parts
}

fn paths<'a>(input: &TableInput<'a>, runs: &[usize]) -> BTreeSet<&'a str> {
    runs.iter().map(|&run| input.runs[run].path.as_str()).collect()
}

fn part<'a>(
    kind: &'static str,
    claim: &str,
    run: &'a RunRecord,
    used: &BTreeSet<&str>,
    left_out: impl FnOnce() -> String,
) -> Part<'a> {
    Part {
        kind,
        claim: claim.to_owned(),
        run,
        left_out: (!used.contains(run.path.as_str())).then(left_out),
    }
}

/// Whether a run is of the material of a law, or of either side of an answer about environments.
fn is_compared(input: &TableInput, found: &Answer, run: &RunRecord) -> bool {
    if found.kind.is_law() {
        return material(run, input.campaign) == Some(&found.material);
    }
    let is_side = |environment: &str| {
        [&found.upper, &found.lower]
            .iter()
            .any(|side| side.contains(environment))
    };
    run.tag(keys::ENVIRONMENT).is_some_and(is_side) && material(run, input.campaign) == Some(&found.material)
}

/// What is known of runs, by name.
type FactsByRun<'a> = BTreeMap<&'a str, &'a RunFacts>;

/// Why a run is no part of what is said of a parameter.
fn why_not(input: &TableInput, facts: &FactsByRun, run: &RunRecord, found: &Answer) -> String {
    if !run.standing.speaks() {
        return format!("set aside: {}", run.standing.reason());
    }
    if input.doubts.leaves_out(&run.path) {
        return "the model does not describe its group, and no cause is known".to_owned();
    }
    let estimate = match contribution(input.doubts, run, found.parameter).estimate {
        Err(why) => return why,
        Ok(estimate) => estimate,
    };
    let states = |key: &str| {
        facts.get(run.path.as_str()).is_some_and(|own| {
            let mut stated = own.numbers.keys().chain(own.names.keys());
            stated.any(|covariate| covariate.key() == key)
        })
    };
    match found.covariate {
        _ if estimate.value.is_none() => {
            let why = estimate.reason.clone();
            why.unwrap_or_else(|| "it gives a bound".to_owned())
        }
        _ if estimate.at_bound => "the value lies at a limit of the search".to_owned(),
        Some(key) if !states(key) => format!("it states no {}", found.upper),
        _ if SharedEstimate::of(run, &estimate).is_some() => {
            "its fit is one with that of a run that is used".to_owned()
        }
        _ => "nothing stands against it in the other condition, or in its sample".to_owned(),
    }
}

fn of_group_fits<'a>(input: &TableInput<'a>) -> Vec<Part<'a>> {
    let mut shared: BTreeMap<SharedEstimate, BTreeSet<&str>> = BTreeMap::new();
    for run in input.runs {
        if let Some(own) = identity(run) {
            shared.entry(own).or_default().insert(&run.path);
        }
    }
    let mut parts = Vec::new();
    for used in shared.into_values() {
        let Some(first) = input.runs.iter().find(|run| used.contains(run.path.as_str())) else {
            continue;
        };
        let model = first.fit.as_ref().map_or("", |fit| fit.model.as_str());
        let claim = format!("{model} of {}", first.tag(keys::SAMPLE).unwrap_or("one sample"));
        let group = input.groups.iter().find(|group| group.runs.contains(&first.path));
        let of_group = |run: &&RunRecord| {
            used.contains(run.path.as_str()) || group.is_some_and(|group| group.runs.contains(&run.path))
        };
        for run in every(input).filter(of_group) {
            let alone = || "it is fitted by itself".to_owned();
            parts.push(part("fit of a group", &claim, run, &used, alone));
        }
    }
    parts
}

fn of_diagnoses<'a>(input: &TableInput<'a>) -> Vec<Part<'a>> {
    let of_group = |found: &'a GroupDiagnosis| {
        let condemned = |run: &RunRecord| found.condemned.iter().find(|own| own.run == run.path);
        let claim = format!("{}: {}", crate::groups::title(&found.group), found.verdict.key());
        let runs = every(input).filter(|run| found.runs.contains(&run.path) || condemned(run).is_some());
        let parts = runs.map(move |run| Part {
            kind: "diagnosis",
            claim: claim.clone(),
            run,
            left_out: condemned(run).map(|own| own.reason.clone()),
        });
        parts.collect::<Vec<_>>()
    };
    input.groups.iter().flat_map(of_group).collect()
}
