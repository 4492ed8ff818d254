//! What was done, as the paragraph of a paper: made from what is stored, so that it says what was done and nothing else.

use std::collections::BTreeMap;

use ieap_domain::number::plain;
use ieap_domain::words::{counted, in_a_row};
use ieap_domain::{RunRecord, Sample, Standing};
use ieap_show::Block;

use crate::conditions::{Conditions, conditions, volts_number};
use crate::study::{Study, view::intervals};
use crate::tables::TableInput;
use ieap_domain::tag::keys;

/// Samples that are named with their sizes; of more, their number is said. Chosen.
const MOST_SAMPLES: usize = 6;

/// Sentences to paste, and what they rest on.
pub fn view(input: &TableInput, study: &Study, program: &str) -> Vec<Block> {
    let paragraphs = [
        // What is said of all pages, as that the data are simulated, is true of the paragraph.
        vec![notice(input), samples(input), runs(input), set_aside(input)],
        vec![fits(input)],
        vec![
            comparison(study),
            diagnoses(input),
            format!("All of this was done by {program}."),
        ],
    ];
    let pasted = paragraphs.into_iter().map(|mut said| {
        said.retain(|sentence| !sentence.is_empty());
        said.join(" ")
    });
    let head = "To paste into a paper; everything in it follows from what is stored.".to_owned();
    let all = std::iter::once(head).chain(pasted.filter(|text| !text.is_empty()));
    all.map(Block::Say).collect()
}

fn notice(input: &TableInput) -> String {
    input.campaign.notice.clone().unwrap_or_default()
}

/// `The samples were CNaf-1 (CNaf, 5 × 2 × 0.22 mm) and CPvf-1 (CPvf, 5 × 2 × 0.4 mm).`
fn samples(input: &TableInput) -> String {
    let measured = |sample: &&Sample| {
        let mut runs = input.runs.iter();
        runs.any(|run| run.tag(keys::SAMPLE) == Some(sample.id.as_str()))
    };
    let own: Vec<&Sample> = input.campaign.samples.iter().filter(measured).collect();
    let sized = |sample: &&Sample| {
        let sides = [sample.length_mm, sample.width_mm, sample.thickness_mm];
        let sides: Vec<String> = sides.into_iter().flatten().map(plain).collect();
        let size = if sides.is_empty() {
            String::new()
        } else {
            format!(", {} mm", sides.join(" × "))
        };
        format!("{} ({}{size})", sample.id, sample.material)
    };
    match own.len() {
        0 => String::new(),
        many if many > MOST_SAMPLES => {
            let mut materials: Vec<&str> = own.iter().map(|sample| sample.material.as_str()).collect();
            materials.sort_unstable();
            materials.dedup();
            format!("{many} samples of {} were measured.", in_a_row(&materials))
        }
        _ => {
            let named: Vec<String> = own.iter().map(sized).collect();
            format!("The samples were {}.", in_a_row(&named))
        }
    }
}

/// What was measured, where, and under which voltages.
fn runs(input: &TableInput) -> String {
    if input.runs.is_empty() {
        return String::new();
    }
    let Conditions {
        surroundings,
        voltages_v,
        ..
    } = conditions(input.runs, input.campaign);
    let mut channels: Vec<String> = Vec::new();
    let measured = input.runs.iter().filter_map(|run| run.fit.as_ref());
    for noise in measured.flat_map(|fit| &fit.noise) {
        let name = noise.quantity.label().to_lowercase();
        if !channels.contains(&name) {
            channels.push(name);
        }
    }
    let were = if channels.len() == 1 { "was" } else { "were" };
    let channels = if channels.is_empty() {
        "Responses".to_owned()
    } else {
        in_a_row(&channels)
    };
    let places: Vec<String> = surroundings
        .iter()
        .map(crate::conditions::Surroundings::said)
        .collect();
    let places = named(" in ", &places, "");
    let voltages: Vec<String> = voltages_v.iter().map(|volts| volts_number(*volts)).collect();
    let voltages = named(" at nominal voltages of ", &voltages, " V");
    let head = channels[..1].to_uppercase() + &channels[1..];
    let count = counted(input.runs.len(), "run");
    let instruments = instruments(input.runs);
    format!("{head} {were} measured in {count}{places}{voltages}{instruments}.")
}

/// These in a row between two words; empty where there are none.
fn named<T: AsRef<str>>(before: &str, all: &[T], after: &str) -> String {
    if all.is_empty() {
        return String::new();
    }
    let all: Vec<&str> = all.iter().map(AsRef::as_ref).collect();
    format!("{before}{}{after}", in_a_row(&all))
}

/// ` with A and B`; empty where no run names an instrument.
fn instruments(runs: &[RunRecord]) -> String {
    let mut named: Vec<&str> = runs.iter().filter_map(|run| run.tag(keys::INSTRUMENT)).collect();
    named.sort_unstable();
    named.dedup();
    self::named(" with ", &named, "")
}

/// Runs that no result is made from, by why.
fn set_aside(input: &TableInput) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for run in input.set_aside {
        let why = match run.standing {
            Standing::Condemned { .. } => "for wrong readings",
            Standing::Contradicted { .. } => "because what is stated of them is contradicted",
            Standing::Copy { .. } => "as copies of another",
            _ => "by hand",
        };
        *counts.entry(why).or_insert(0) += 1;
    }
    let said: Vec<String> = counts
        .iter()
        .map(|(why, count)| format!("{} {why}", counted(*count, "run")))
        .collect();
    named("No result is made from ", &said, ".")
}

/// Models and how they were fitted, the most frequent first.
fn fits(input: &TableInput) -> String {
    let mut counts: BTreeMap<(&str, u32, &str), usize> = BTreeMap::new();
    for fit in input.runs.iter().filter_map(|run| run.fit.as_ref()) {
        *counts
            .entry((&fit.model, fit.model_version, &fit.method))
            .or_insert(0) += 1;
    }
    let mut kinds: Vec<_> = counts.into_iter().collect();
    kinds.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let one = |((model, version, method), count): ((&str, u32, &str), usize)| {
        let each = match count {
            all if all == input.runs.len() => "Each run was".to_owned(),
            1 => "One run was".to_owned(),
            some => format!("{some} runs were"),
        };
        format!(
            "{each} fitted with {} (model {model}, version {version}) by {method}.",
            circuit(model)
        )
    };
    let mut said: Vec<String> = kinds.into_iter().map(one).collect();
    if !said.is_empty() {
        said.push("The noise was estimated from the readings without the model; intervals hold 95 % and allow for residuals that go together.".to_owned());
    }
    said.join(" ")
}

/// A model in words; what is not of the lumped family is told by its name.
fn circuit(model: &str) -> String {
    let base = model.split(" + ").next().unwrap_or(model);
    let lumped = base
        .strip_prefix("lumped-")
        .and_then(|branches| branches.parse::<usize>().ok());
    let text = match lumped {
        Some(branches) => format!(
            "the lumped electromechanical model of Vunder (doctoral thesis, University of Tartu): {} in parallel with a steady-state resistance R_ss, and a curvature of alpha times the charge that has not yet relaxed, which does so at the rate lambda",
            match branches {
                1 => "one R-C branch".to_owned(),
                many => format!("{many} R-C branches"),
            }
        ),
        None => format!("the model {base} of ieap"),
    };
    match model.split_once(" + ") {
        Some((_, added)) => format!("{text}, extended by {added}"),
        None => text,
    }
}

/// How conditions were compared.
fn comparison(study: &Study) -> String {
    let said = intervals(study);
    if said.is_empty() {
        return String::new();
    }
    format!("Conditions were compared at equal voltage. {}", said.join(" "))
}

/// Whether and how the model was tested.
fn diagnoses(input: &TableInput) -> String {
    if input.groups.is_empty() {
        return String::new();
    }
    let held_out = if input.groups.iter().any(|group| group.gain.is_some()) {
        "; extended models were held to runs that had not been used to find them"
    } else {
        ""
    };
    format!(
        "Whether the model describes the readings was asked in {} of runs by the chance of residuals at least as large, false discoveries held over all of them (Benjamini and Hochberg){held_out}.",
        counted(input.groups.len(), "group")
    )
}
