//! What a study is made from, and the numbers of a parameter that fits and curves give before any model.

use std::collections::BTreeMap;

use ieap_domain::{Campaign, RunRecord};

use super::measured::{Bound, Cell, Measured};
use super::measures::{BENDING_LOST, BENDING_PER_VOLT, MEASURES};
use super::placed::Placed;
use super::policy::LOSS_AFTER_S;
use crate::conditions::Conditions;
use crate::laws;
use crate::laws::doubt::Doubts;
use crate::laws::facts::RunFacts;
use crate::laws::values::{Values, values};
use crate::model_free::curves::StepCurves;
use crate::parameters::{COMPARED, usable};

/// What a study is made from.
#[derive(Debug, Clone, Copy)]
pub struct Evidence<'a> {
    /// Runs that speak, with their fits.
    pub runs: &'a [RunRecord],
    /// The campaign.
    pub campaign: &'a Campaign,
    /// What findings say against fits.
    pub doubts: &'a Doubts,
    /// Current and bending of each of the runs, in their order; empty where nobody read them.
    pub curves: &'a [StepCurves],
}

/// Numbers of one parameter of one material.
pub(super) struct Numbers {
    /// Values with their variances, by the place of their run.
    pub found: BTreeMap<usize, (f64, f64)>,
    /// Conditions with a bound and no value.
    pub bounds: BTreeMap<Cell, Bound>,
    /// The variance from run to run that campaign.toml states.
    pub stated: Option<f64>,
}

impl Numbers {
    /// With the scatter that the design tells.
    pub fn measured(&self, placed: &Placed) -> Measured {
        placed.measured(&self.found, self.bounds.clone(), self.stated)
    }
}

/// By material and parameter: the values, or why they cannot be compared.
pub(super) fn measured_of(
    evidence: &Evidence,
    conditions: &Conditions,
    facts: &[RunFacts],
) -> BTreeMap<(usize, &'static str), Result<Measured, &'static str>> {
    let of_material = |material: usize| {
        let placed = Placed::new(conditions, facts, material);
        MEASURES
            .into_iter()
            .filter_map(move |key| Some(((material, key), measure(evidence, &placed, key)?)))
    };
    (0..conditions.materials.len()).flat_map(of_material).collect()
}

/// The values of a parameter of a material, or why they cannot be compared; none where no run has one.
pub(super) fn measure(
    evidence: &Evidence,
    placed: &Placed,
    key: &str,
) -> Option<Result<Measured, &'static str>> {
    let numbers = numbers(evidence, placed, key)?;
    Some(numbers.map(|own| own.measured(placed)))
}

/// A value and its variance, by the place of its run.
type ByPlace = Vec<(usize, (f64, f64))>;

/// Logarithms of values by place, with their variances. Where a laboratory counts bending the other way round all of them are
/// negative, and their sizes are compared.
///
/// # Errors
/// Some are positive and some are not.
fn logarithms(own: &Values) -> Result<ByPlace, &'static str> {
    let of = own.values.iter();
    if own.is_log {
        Ok(of.map(|own| (own.place, (own.y, own.variance))).collect())
    } else if own.values.iter().all(|own| own.y < 0.0) {
        let size = |own: &laws::values::Value| (own.place, ((-own.y).ln(), own.variance / (own.y * own.y)));
        Ok(of.map(size).collect())
    } else {
        Err("its values are positive in some runs and not in others, so that they have no ratio")
    }
}

/// The numbers of a parameter of a material, or why they cannot be compared; none where no run has one.
pub(super) fn numbers(
    evidence: &Evidence,
    placed: &Placed,
    key: &str,
) -> Option<Result<Numbers, &'static str>> {
    let facts = placed.facts;
    let places: Vec<usize> = placed.cells.keys().copied().collect();
    let of = |key: &str| {
        values(evidence.runs, facts, &places, key).in_doubt(evidence.doubts, evidence.runs, facts)
    };
    let mut found = BTreeMap::new();
    let mut bounds: BTreeMap<Cell, Bound> = BTreeMap::new();
    match key {
        BENDING_PER_VOLT => {
            let (alpha, capacitance) = match (logarithms(&of(COMPARED[0])), logarithms(&of(COMPARED[2]))) {
                (Ok(alpha), Ok(capacitance)) => (alpha, capacitance),
                (Err(why), _) | (_, Err(why)) => return Some(Err(why)),
            };
            let capacitances: BTreeMap<usize, (f64, f64)> = capacitance.into_iter().collect();
            for (place, own) in alpha {
                if let Some((y, variance)) = capacitances.get(&place) {
                    found.insert(place, (own.0 + y, own.1 + variance));
                }
            }
        }
        BENDING_LOST => {
            let lambda = of(COMPARED[1]);
            for own in &lambda.values {
                let (rate, variance) = if lambda.is_log {
                    (own.y.exp(), own.variance * (2.0 * own.y).exp())
                } else {
                    (own.y, own.variance)
                };
                let kept = (-LOSS_AFTER_S * rate).exp();
                let slope = 100.0 * LOSS_AFTER_S * kept;
                found.insert(own.place, (100.0 * (1.0 - kept), slope * slope * variance));
            }
            // A bound on lambda is a range of what is lost, evenly likely.
            for place in lambda.left_out {
                if let Some(below) = bound(evidence, facts, place, COMPARED[1]).below {
                    let most = 100.0 * (1.0 - (-LOSS_AFTER_S * below.exp()).exp());
                    found.insert(place, (0.5 * most, most * most / 12.0));
                }
            }
        }
        _ => {
            let own = of(key);
            match logarithms(&own) {
                Ok(values) => found.extend(values),
                Err(why) => return Some(Err(why)),
            }
            for place in own.left_out {
                let own = bound(evidence, facts, place, key);
                let entry = bounds.entry(placed.cells[&place]).or_default();
                entry.below = own.below.or(entry.below);
                entry.above = own.above.or(entry.above);
            }
        }
    }
    bounds.retain(|cell, _| found.keys().all(|place| placed.cells[place] != *cell));
    let stated = (evidence.campaign.study.scatter_percent).filter(|_| key != BENDING_LOST);
    let stated = stated.map(|percent| (percent / 100.0).powi(2));
    let has_any = !found.is_empty() || !bounds.is_empty();
    has_any.then_some(Ok(Numbers {
        found,
        bounds,
        stated,
    }))
}

/// What a fit that gives no value leaves: logarithms.
fn bound(evidence: &Evidence, facts: &[RunFacts], place: usize, key: &str) -> Bound {
    let run = &evidence.runs[facts[place].run];
    let end = |of: Option<f64>| of.filter(|end| *end > 0.0).map(f64::ln);
    // Of a value whose error is not known the ends say nothing.
    let estimate = usable(run, key).filter(|own| own.value.is_none() || own.at_bound);
    let estimate = estimate.and_then(|own| evidence.doubts.widened(&run.path, key, own));
    Bound {
        below: estimate.as_ref().and_then(|own| end(own.high_95)),
        above: estimate.as_ref().and_then(|own| end(own.low_95)),
    }
}
