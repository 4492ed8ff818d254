//! Plans in words.

use super::deconfound::Deconfounding;
use crate::laws::covariate::Covariate;
use crate::laws::facts::RunFacts;
use crate::laws::find::TiedSet;
use crate::laws::policy::INFLATION_LIMIT;
use crate::laws::words::{listed, short};
use ieap_domain::number::fixed;
use ieap_domain::number::seconds::seconds;
use ieap_domain::words::counted;
use ieap_domain::{Drive, Level};

/// `38`, `3.1`, or `infinity`.
pub fn inflation(value: f64) -> String {
    match value.is_finite() && value < super::policy::MOST_INFLATION {
        true if value >= 100.0 => fixed(value, 0),
        true => short(value),
        false => "infinity".to_owned(),
    }
}

/// What a run does to what is tied, in words; the inflations are those before and after it.
pub fn brings(before: f64, after: f64) -> &'static str {
    match () {
        () if after <= INFLATION_LIMIT => "then they are told apart",
        () if inflation(before) != inflation(after) => "a start: more runs of this list are needed",
        () => "needed together with the next of this list, alone it tells nothing yet",
    }
}

/// `relative humidity from cycle`.
pub fn pair((one, other): (Covariate, Covariate)) -> String {
    format!("{} from {}", one.label(), other.label())
}

/// What a plan reaches, in a sentence; what it cannot, in others.
pub fn reached(plan: &Deconfounding) -> Vec<String> {
    let mut sentences = Vec::new();
    let names = listed(&plan.covariates);
    let runs = counted(plan.steps.len(), "run");
    let part = if plan.left.is_empty() {
        ""
    } else {
        ", as far as runs in the conditions of the design can"
    };
    if plan.gains() {
        let end = if plan.is_reached() {
            ""
        } else {
            "; that is a start, more of the same kind are needed"
        };
        sentences.push(format!(
            "{}: {runs} more to tell {names} apart{part}{end}.",
            plan.material
        ));
    } else if plan.would.is_empty() {
        let none = match plan.steps.len() {
            0 => "no run in the conditions of the design tells".to_owned(),
            _ => format!("not even {runs} in the conditions of the design tell"),
        };
        sentences.push(format!("{}: {none} {names} apart.", plan.material));
    }
    for would in &plan.would {
        sentences.push(format!("{}: {would}", plan.material));
    }
    sentences
}

/// What would tell pairs apart that no run at hand can, a sentence each.
pub fn would(
    set: &TiedSet,
    facts: &[RunFacts],
    places: &[usize],
    left: &[(Covariate, Covariate)],
) -> Vec<String> {
    if super::ties::ties(&set.covariates).is_empty() {
        return vec![format!(
            "{} grow together with every run. A sample that is left unused for long, or used often within little time, would tell them apart.",
            listed(&set.covariates)
        )];
    }
    left.iter()
        .map(|pair| would_split(*pair, facts, places))
        .collect()
}

fn would_split((one, other): (Covariate, Covariate), facts: &[RunFacts], places: &[usize]) -> String {
    let lead = format!(
        "no run in a condition of the design tells {} from {}",
        one.label(),
        other.label()
    );
    let numbers = [Covariate::RelativeHumidity, Covariate::Temperature];
    let of_environment = match (one, other) {
        (Covariate::Environment, number) | (number, Covariate::Environment) if numbers.contains(&number) => {
            Some(number)
        }
        _ => None,
    };
    if let Some(number) = of_environment {
        let highest = places
            .iter()
            .filter_map(|&place| Some((facts[place].numbers.get(&number)?.value, place)))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((value, place)) = highest {
            let environment = facts[place].names.get(&Covariate::Environment);
            return format!(
                "{lead}: each environment was measured at one {}. A run in {} at another than {} would.",
                number.label(),
                environment.map_or("that environment", String::as_str),
                shown_number(number, value)
            );
        }
    }
    let example = places.iter().find_map(|&a| {
        let (first, second) = (level(&facts[a], one)?, level(&facts[a], other)?);
        let differs = places.iter().rev().find_map(|&b| {
            let (there, beside) = (level(&facts[b], one)?, level(&facts[b], other)?);
            (there != first && beside != second).then_some(beside)
        })?;
        Some((first, differs))
    });
    match example {
        Some((first, second)) if one == Covariate::Batch || other == Covariate::Batch => {
            let (batch, at) = if one == Covariate::Batch {
                (first, second)
            } else {
                (second, first)
            };
            format!("{lead}: another sample of {batch}, measured at {at}, would.")
        }
        Some((first, second)) => format!("{lead}: a run with {first} and {second} would."),
        None => format!("{lead}."),
    }
}

fn shown_number(covariate: Covariate, value: f64) -> String {
    format!("{} {}", short(value), covariate.unit())
        .trim_end()
        .to_owned()
}

/// The level of a run in words: `batch B`, `relative humidity 20 % RH`.
fn level(fact: &RunFacts, covariate: Covariate) -> Option<String> {
    let value = match fact.names.get(&covariate) {
        Some(name) => name.clone(),
        None => shown_number(covariate, fact.numbers.get(&covariate)?.value),
    };
    Some(format!("{} {value}", covariate.label()))
}

/// A drive in words, for one who sets it: `hold 2.00 V for 600 s, then 0.00 V for 300 s`. The first word keeps
/// spreadsheets from taking a negative voltage for a formula.
pub fn drive(drive: &Drive, duration_s: f64) -> String {
    const SHOWN: usize = 4;
    if drive.moves() {
        let nominal_v = drive.nominal_step_v();
        return format!(
            "the moving voltage of up to {} V for {} s again",
            fixed(nominal_v, 2),
            seconds(duration_s)
        );
    }
    let starts = drive.segments.iter().map(|segment| segment.start_s());
    let ends = starts.skip(1).chain([duration_s]);
    let segments = drive.segments.iter().zip(ends).take(SHOWN);
    let parts: Vec<String> = segments
        .map(|(segment, end)| {
            let level = match segment.level {
                Level::Voltage(volts) => format!("{} V", fixed(volts, 2)),
                Level::OpenCircuit => "open circuit".to_owned(),
            };
            format!("{level} for {} s", seconds(end - segment.start_s()))
        })
        .collect();
    let more = if drive.segments.len() > SHOWN {
        format!(", and so on for {} s", seconds(duration_s))
    } else {
        String::new()
    };
    format!("hold {}{more}", parts.join(", then "))
}
