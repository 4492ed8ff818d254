//! What else differs between two sets of runs, so that it may be the cause.

use std::collections::BTreeSet;

use ieap_domain::number::plain;
use ieap_domain::words::in_a_row;
use ieap_numerics::grouped::Grouped;

use super::measured::{Value, distinct};
use crate::laws::Covariate;
use crate::laws::facts::RunFacts;
use crate::laws::policy::INFLATION_LIMIT;

/// Numbers that may stand behind a difference; of those that say the same (how long a strip was used) the first that is known
/// is told.
const NUMBERS: [&[Covariate]; 2] = [&USE, &[Covariate::Temperature]];
/// How long a strip was used: the first that is known.
pub const USE: [Covariate; 3] = [Covariate::Cycle, Covariate::Age, Covariate::RunOrder];
const NAMES: [Covariate; 4] = [
    Covariate::Instrument,
    Covariate::Calibration,
    Covariate::Operator,
    Covariate::Batch,
];

/// What of use changed with a number within each strip and its surroundings, so that the design cannot tell them apart.
pub(super) fn changed_with(facts: &[RunFacts], values: &[Value], x: &[f64]) -> Vec<String> {
    let number = |own: &Value, of: &Covariate| Some(facts[own.place].numbers.get(of)?.value);
    let column = |of: &Covariate| {
        values
            .iter()
            .map(|own| number(own, of))
            .collect::<Option<Vec<f64>>>()
    };
    let Some((of, column)) = USE.iter().find_map(|of| Some((of, column(of)?))) else {
        return Vec::new();
    };
    let part = |own: &Value| (own.sample, own.cell.0);
    let parts = distinct(values.iter().map(part));
    let group: Vec<usize> = (values.iter())
        .map(|own| parts.binary_search(&part(own)).unwrap_or(0))
        .collect();
    let square = |beside: &[Vec<f64>]| -> f64 {
        let grouped = Grouped::new(&vec![1.0; x.len()], &group, beside);
        grouped.residual(x).iter().map(|x| x * x).sum()
    };
    let is_tied = square(&[]) > INFLATION_LIMIT * square(&[column]);
    is_tied
        .then(|| format!("the {}", of.label()))
        .into_iter()
        .collect()
}

/// Each in a few words: `the cycle (7 to 9 against 1 to 6)`. What shares a value on both sides is not among them, nor what
/// some runs do not state.
pub fn also_changed(facts: &[RunFacts], upper: &[usize], lower: &[usize]) -> Vec<String> {
    let mut found = Vec::new();
    let samples =
        |places: &[usize]| -> BTreeSet<&str> { places.iter().map(|&at| facts[at].sample.as_str()).collect() };
    if samples(upper).is_disjoint(&samples(lower)) {
        let row = |places| in_a_row(&samples(places).into_iter().collect::<Vec<_>>());
        found.push(format!("the sample ({} against {})", row(upper), row(lower)));
    }
    for same in NUMBERS {
        found.extend(
            same.iter()
                .find_map(|&covariate| number(facts, upper, lower, covariate)),
        );
    }
    found.extend(
        NAMES
            .iter()
            .filter_map(|&covariate| name(facts, upper, lower, covariate)),
    );
    found
}

fn number(facts: &[RunFacts], upper: &[usize], lower: &[usize], covariate: Covariate) -> Option<String> {
    let range = |places: &[usize]| {
        let all: Option<Vec<f64>> = places
            .iter()
            .map(|&at| facts[at].numbers.get(&covariate).map(|own| own.value))
            .collect();
        let all = all.filter(|all| !all.is_empty())?;
        Some((
            all.iter().copied().fold(f64::INFINITY, f64::min),
            all.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ))
    };
    let (above, below) = (range(upper)?, range(lower)?);
    let words = |(low, high): (f64, f64)| {
        if low == high {
            plain(low)
        } else {
            format!("{} to {}", plain(low), plain(high))
        }
    };
    let is_apart = above.0 > below.1 || below.0 > above.1;
    let (unit, gap) = match covariate.unit() {
        "" => ("", ""),
        unit => (unit, "\u{a0}"),
    };
    is_apart.then(|| {
        format!(
            "the {} ({} against {}{gap}{unit})",
            covariate.label(),
            words(above),
            words(below)
        )
    })
}

fn name(facts: &[RunFacts], upper: &[usize], lower: &[usize], covariate: Covariate) -> Option<String> {
    let names = |places: &[usize]| -> Option<BTreeSet<&str>> {
        places
            .iter()
            .map(|&at| facts[at].names.get(&covariate).map(String::as_str))
            .collect()
    };
    let (above, below) = (names(upper)?, names(lower)?);
    let row = |names: BTreeSet<&str>| in_a_row(&names.into_iter().collect::<Vec<_>>());
    (above.is_disjoint(&below) && !above.is_empty() && !below.is_empty()).then(|| {
        format!(
            "the {} ({} against {})",
            covariate.label(),
            row(above),
            row(below)
        )
    })
}
