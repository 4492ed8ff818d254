//! Which conditions are measured how often, and what to measure next.

use std::collections::BTreeSet;

use super::ratios::Reference;
use crate::conditions::Conditions;
use crate::design::confounding;
use ieap_domain::RunRecord;
use ieap_domain::tag::keys;

/// Runs of the reference condition that every material should have: its spread is in every ratio.
const REFERENCE_RUNS: usize = 3;

/// One combination of material, surroundings and voltage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cell {
    /// Runs.
    pub runs: usize,
    /// Runs with a converged fit.
    pub fitted: usize,
    /// Samples.
    pub samples: usize,
}

/// A condition by its indices in [`Conditions`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Material.
    pub material: usize,
    /// Surroundings.
    pub surroundings: usize,
    /// Voltage.
    pub voltage: usize,
}

/// Why a condition should be measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Why {
    /// It is what others are compared with, and has so many runs.
    Reference(usize),
    /// A sample's environments came one after the other: a return to the first tells the environment from age.
    Return(String),
    /// It is missing among conditions that are measured: so many of the same surroundings or voltage.
    Missing(usize),
    /// It was measured once, and nothing of its material twice: the spread between runs is not known.
    Repeat,
}

/// A condition to measure next.
#[derive(Debug, Clone, PartialEq)]
pub struct Next {
    /// Which.
    pub place: Place,
    /// Why.
    pub why: Why,
}

/// The cell of a place.
pub fn cell(runs: &[RunRecord], conditions: &Conditions, place: Place) -> Cell {
    let Some(condition) = conditions.at(place.material, place.surroundings, place.voltage) else {
        return Cell::default();
    };
    let of = || condition.runs.iter().map(|&run| &runs[run]);
    let samples: BTreeSet<&str> = of().filter_map(|run| run.tag(keys::SAMPLE)).collect();
    Cell {
        runs: condition.runs.len(),
        fitted: of()
            .filter(|run| run.fit.as_ref().is_some_and(|fit| fit.converged))
            .count(),
        samples: samples.len(),
    }
}

/// What to measure next, the most telling first: repeats of the reference, a return that tells age from environment,
/// gaps with the most measured neighbours, a first repeat. A condition is named once.
pub fn next(runs: &[RunRecord], conditions: &Conditions, reference: Option<&Reference>) -> Vec<Next> {
    let mut found: Vec<Next> = Vec::new();
    let mut add = |place: Place, why: Why| {
        if found.iter().all(|known| known.place != place) {
            found.push(Next { place, why });
        }
    };
    for (place, count) in of_reference(conditions, reference) {
        if count < REFERENCE_RUNS {
            add(place, Why::Reference(count));
        }
    }
    for (place, sample) in returns(runs, conditions) {
        add(place, Why::Return(sample));
    }
    let mut gaps = gaps(conditions);
    gaps.sort_by_key(|(place, neighbours)| (std::cmp::Reverse(*neighbours), *place));
    for (place, neighbours) in gaps {
        add(place, Why::Missing(neighbours));
    }
    for material in 0..conditions.materials.len() {
        let of_material = || {
            conditions
                .measured
                .iter()
                .filter(|condition| condition.material == material)
        };
        if of_material().all(|condition| condition.runs.len() == 1)
            && let Some(first) = of_material().next()
        {
            add(place_of(first), Why::Repeat);
        }
    }
    found
}

fn place_of(condition: &crate::Condition) -> Place {
    Place {
        material: condition.material,
        surroundings: condition.surroundings,
        voltage: condition.voltage,
    }
}

/// The reference conditions with their numbers of runs.
fn of_reference(conditions: &Conditions, reference: Option<&Reference>) -> Vec<(Place, usize)> {
    let Some(reference) = reference else {
        return Vec::new();
    };
    let referred = conditions
        .measured
        .iter()
        .filter_map(|condition| reference.of(conditions, condition));
    let distinct: BTreeSet<usize> = referred.collect();
    let of = |index: usize| {
        let condition = &conditions.measured[index];
        (place_of(condition), condition.runs.len())
    };
    distinct.into_iter().map(of).collect()
}

/// The first condition of every sample whose environments came one after the other.
fn returns(runs: &[RunRecord], conditions: &Conditions) -> Vec<(Place, String)> {
    let first_of = |sample: &String| {
        let of_sample = conditions.measured.iter().flat_map(|condition| {
            let runs = condition
                .runs
                .iter()
                .filter(|&&run| runs[run].tag(keys::SAMPLE) == Some(sample));
            runs.map(move |&run| (run, condition))
        });
        let first = of_sample.min_by_key(|(run, _)| runs[*run].tag(keys::STARTED_AT))?;
        Some((place_of(first.1), sample.clone()))
    };
    confounding(runs)
        .environment_with_age
        .iter()
        .filter_map(first_of)
        .collect()
}

/// Conditions that are not measured, with how many of the same surroundings or the same voltage are.
fn gaps(conditions: &Conditions) -> Vec<(Place, usize)> {
    let mut gaps = Vec::new();
    for material in 0..conditions.materials.len() {
        for surroundings in 0..conditions.surroundings.len() {
            for voltage in 0..conditions.voltages_v.len() {
                if conditions.at(material, surroundings, voltage).is_some() {
                    continue;
                }
                let beside = conditions.measured.iter().filter(|condition| {
                    condition.material == material
                        && (condition.surroundings == surroundings || condition.voltage == voltage)
                });
                let place = Place {
                    material,
                    surroundings,
                    voltage,
                };
                gaps.push((place, beside.count()));
            }
        }
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::ratios::reference;
    use crate::conditions::conditions;
    use ieap_domain::CompareRules;
    use ieap_domain::testing::{campaign, run, tag};

    fn runs(order: &[(&str, f64)]) -> Vec<RunRecord> {
        let started = |(hour, &(environment, voltage_v)): (usize, &(&str, f64))| {
            let mut run = run("r", "CNaf-01", environment, None, voltage_v);
            run.tags
                .push(tag(keys::STARTED_AT, &format!("2026-11-20T{hour:02}:00:00Z")));
            run
        };
        order.iter().enumerate().map(started).collect()
    }

    #[test]
    fn gaps_among_measured_conditions_and_a_return_are_named() {
        let runs = runs(&[("vacuum", 1.2), ("vacuum", 2.0), ("air", 1.2)]);
        let table = conditions(&runs, &campaign());
        let chosen = reference(&table, &CompareRules::default()).unwrap();
        let next = next(&runs, &table, Some(&chosen));
        assert_eq!(next[0].why, Why::Reference(1));
        assert_eq!(next[0].place.surroundings, 0);
        // The first condition is the reference already; the gap is air at 2 V, beside one of air and one of 2 V.
        let missing: Vec<&Next> = next.iter().filter(|one| one.why == Why::Missing(2)).collect();
        assert_eq!(missing.len(), 1);
        assert_eq!((missing[0].place.surroundings, missing[0].place.voltage), (1, 1));
    }

    #[test]
    fn cells_count_runs_samples_and_fits() {
        let runs = runs(&[("vacuum", 1.2), ("vacuum", 1.2)]);
        let table = conditions(&runs, &campaign());
        let place = Place {
            material: 0,
            surroundings: 0,
            voltage: 0,
        };
        let found = cell(&runs, &table, place);
        assert_eq!((found.runs, found.fitted, found.samples), (2, 0, 1));
    }
}
