//! From least-squares results to estimates: values with intervals where the data determine them, bounds or
//! reasons where they do not.

use ieap_domain::{Drive, Estimate, Level};
use ieap_numerics::gram::CAPACITY;

use super::bending::Bending;
use super::electrical::{Bound, Electrical, Unseen};
use super::joint::feature::Feature;
use crate::interval_rule;
use crate::policy::NARROW_PART;

/// Estimates of the electrical parameters.
pub(super) fn electrical_estimate(
    feature: Feature,
    electrical: &Electrical,
    drive: &Drive,
) -> Option<Estimate> {
    if electrical.hides_branch && !matches!(feature, Feature::Coupling | Feature::Rate) {
        return Some(Estimate::not_determined(HIDES_BRANCH));
    }
    match feature {
        Feature::Resistance(k) | Feature::Capacitance(k) | Feature::TimeConstant(k) => {
            Some(branch_part(feature, k, electrical))
        }
        Feature::Steady => Some(steady(electrical, drive)),
        Feature::TotalCapacitance => Some(total_capacitance(electrical)),
        Feature::ParallelResistance => Some(parallel_resistance(electrical)),
        Feature::Coupling | Feature::Rate => None,
    }
}

/// Why a voltage that moves with one period leaves a circuit open.
pub(super) const HIDES_BRANCH: &str = "the voltage moves too much alike all the time to tell one branch from two: a sine gives two numbers of \
                            an impedance; drive steps or a chirp, or fit a model with one branch";
const BENDS: &str = "the movement of the voltage does not separate it from the other electrical parameters: the sum of squares is \
                     no parabola over its interval";

fn branch_part(part: Feature, k: usize, electrical: &Electrical) -> Estimate {
    let n = electrical.conductances_a_per_v.len();
    if k >= n {
        return Estimate::not_determined(absent(n));
    }
    if electrical.in_doubt {
        return Estimate::not_determined(in_doubt(n));
    }
    if let Some(bound) = electrical.at_bound[k] {
        let mut estimate = Estimate::not_determined(beyond(bound));
        estimate.at_bound = true;
        return estimate;
    }
    if electrical.bends {
        return Estimate::not_determined(BENDS);
    }
    let mut weights = [0.0; CAPACITY];
    let conductance = electrical.conductances_a_per_v[k];
    match part {
        Feature::Resistance(_) => {
            weights[k] = -1.0;
            logarithmic(part, electrical.area_cm2 / conductance, &weights, electrical)
        }
        Feature::Capacitance(_) => {
            weights[k] = 1.0;
            weights[n + 1 + k] = 1.0;
            let capacitance = conductance * electrical.time_constants_s[k] / electrical.area_cm2;
            logarithmic(part, capacitance, &weights, electrical)
        }
        _ => {
            weights[n + 1 + k] = 1.0;
            logarithmic(part, electrical.time_constants_s[k], &weights, electrical)
        }
    }
}

/// What the parts of the branches are worth where the last of `n` is in doubt.
pub(super) fn in_doubt(n: usize) -> String {
    match n {
        2 => {
            "a second branch may be there or may be chance, so that the parts of neither are known".to_owned()
        }
        _ => format!(
            "a {} branch may be there or may be chance, so that the parts of none are known",
            ordinal(n)
        ),
    }
}

/// Why branch `k` is missing where the current shows `n`.
fn absent(n: usize) -> String {
    match n {
        0 => "no branch with a positive resistance and capacitance describes the current better than noise would"
            .to_owned(),
        _ => format!(
            "no {} branch with a positive resistance and capacitance describes the current better than noise \
             would: {} enough",
            ordinal(n + 1),
            counted(n)
        ),
    }
}

/// `second` for 2.
pub(super) fn ordinal(n: usize) -> &'static str {
    match n {
        1 => "first",
        2 => "second",
        3 => "third",
        4 => "fourth",
        _ => "further",
    }
}

/// `one branch is`, `two branches are`.
pub(super) fn counted(n: usize) -> &'static str {
    match n {
        1 => "one branch is",
        2 => "two branches are",
        3 => "three branches are",
        _ => "that many branches are",
    }
}

fn beyond(bound: Bound) -> String {
    match bound {
        Bound::Low => "the branch charges faster than the readings follow each other".to_owned(),
        Bound::High => {
            "the branch charges so slowly that the record shows only a constant current of it".to_owned()
        }
    }
}

/// C1 + C2: weights of the logarithms are the shares of the branches.
fn total_capacitance(electrical: &Electrical) -> Estimate {
    if electrical.bends {
        return Estimate::not_determined(BENDS);
    }
    let n = electrical.conductances_a_per_v.len();
    let branches = electrical
        .conductances_a_per_v
        .iter()
        .zip(&electrical.time_constants_s);
    let parts: Vec<f64> = branches.map(|(c, tau)| c * tau / electrical.area_cm2).collect();
    let total: f64 = parts.iter().sum();
    let mut weights = [0.0; CAPACITY];
    for (k, part) in parts.iter().enumerate() {
        weights[k] = part / total;
        weights[n + 1 + k] = part / total;
    }
    // What charges within a reading took a charge that no reading tells; the curvature may.
    let fatal = match electrical.unseen {
        Some(Unseen::Told { .. }) => &[Bound::High][..],
        _ => &[Bound::High, Bound::Low],
    };
    let mut estimate = derived(Feature::TotalCapacitance, total, &weights, electrical, fatal);
    match electrical.unseen {
        Some(Unseen::AtMost(share)) => {
            estimate.high_95 = estimate.high_95.map(|high| high * (1.0 + share));
            estimate
        }
        Some(Unseen::NotKnown) => match estimate.low_95 {
            Some(low) => Estimate::above(low, MAY_HIDE),
            None => estimate,
        },
        _ => estimate,
    }
}

/// R1 || R2 = A / (c1 + c2).
fn parallel_resistance(electrical: &Electrical) -> Estimate {
    if matches!(electrical.unseen, Some(Unseen::Told { .. })) {
        let seen = parallel_resistance(&Electrical {
            unseen: None,
            ..electrical.without_too_fast()
        });
        return match seen.high_95 {
            Some(high) => Estimate::below(high, beyond(Bound::Low)),
            None => seen,
        };
    }
    let total: f64 = electrical.conductances_a_per_v.iter().sum();
    let mut weights = [0.0; CAPACITY];
    for (weight, conductance) in weights.iter_mut().zip(&electrical.conductances_a_per_v) {
        *weight = -conductance / total;
    }
    let resistance = electrical.area_cm2 / total;
    let found = derived(
        Feature::ParallelResistance,
        resistance,
        &weights,
        electrical,
        &[Bound::Low],
    );
    match (electrical.unseen, found.high_95) {
        (Some(Unseen::NotKnown), Some(high)) => Estimate::below(high, MAY_HIDE),
        _ => found,
    }
}

/// A sum over the branches; lost where a branch lies at a bound that such a sum does not survive.
fn derived(
    part: Feature,
    value: f64,
    weights: &[f64; CAPACITY],
    electrical: &Electrical,
    fatal: &[Bound],
) -> Estimate {
    if electrical.conductances_a_per_v.is_empty() {
        return Estimate::not_determined(absent(0));
    }
    let lost = electrical
        .at_bound
        .iter()
        .flatten()
        .find(|bound| fatal.contains(bound));
    if let Some(bound) = lost {
        return Estimate::not_determined(beyond(*bound));
    }
    logarithmic(part, value, weights, electrical)
}

/// An estimate whose logarithm has the standard error that the weights give.
fn logarithmic(part: Feature, value: f64, weights: &[f64; CAPACITY], electrical: &Electrical) -> Estimate {
    let relative = electrical.covariance.error_along(weights);
    let half = electrical.residuals.quantile * relative;
    if electrical.bends && half > NARROW_PART {
        return Estimate::not_determined(BENDS);
    }
    let ends = electrical.ends.iter().find(|ends| ends.feature == part);
    let parts = ends.map_or([1.0, 1.0], |ends| [ends.low, ends.high]);
    interval_rule::positive(value, relative, half, parts).unwrap_or_else(|| {
        Estimate::not_determined(format!(
            "the current does not separate it from the other electrical parameters: {}",
            interval_rule::TOO_WIDE
        ))
    })
}

/// R_ss from its conductance, in which the current is linear: where the interval of the conductance reaches
/// (nearly) to zero only a lower bound of the resistance is known.
fn steady(electrical: &Electrical, drive: &Drive) -> Estimate {
    if !electrical.steady_visible {
        let held = drive
            .segments
            .iter()
            .any(|segment| matches!(segment.level, Level::Voltage(v) if v != 0.0));
        return Estimate::not_determined(if held {
            "no current was read while a voltage was held"
        } else {
            interval_rule::NO_HELD_VOLTAGE
        });
    }
    let index = electrical.conductances_a_per_v.len();
    let error = electrical.covariance.error(index);
    let half = electrical.residuals.quantile * error;
    let area = electrical.area_cm2;
    let (low, high) = (electrical.steady_a_per_v - half, electrical.steady_a_per_v + half);
    if !high.is_finite() || high <= 0.0 {
        return Estimate::not_determined("the current leaves the steady part open");
    }
    if electrical.at_bound.contains(&Some(Bound::High)) {
        let slow: f64 = electrical.conductances_a_per_v.iter().sum();
        return Estimate::above(
            area / (electrical.steady_a_per_v + slow),
            "a branch that hardly decays within the record carries a part of the lasting current, and the two cannot be told apart",
        );
    }
    let conductance = electrical.steady_a_per_v;
    interval_rule::resistance(
        area,
        conductance,
        error,
        low,
        high,
        interval_rule::NO_STEADY_CURRENT,
    )
}

/// Why the bending is open where a voltage that moves leaves the capacitance open.
pub(super) const CHARGE_OPEN: &str =
    "the voltage moves, and the capacitance is open: the charge that bends the strip is not known";

/// Why the coupling is open where a branch charges faster than the readings follow each other.
pub(super) const CHARGE_UNSEEN: &str = "a branch charges faster than the readings follow each other, so that the charge that bends the strip is not known";

/// Why sums over the branches have one bound.
const MAY_HIDE: &str =
    "the voltage changed between two readings, and a branch that charged before the later one was not seen";

impl Electrical {
    /// Whether a branch charges faster than the readings follow each other.
    pub(super) fn is_too_fast(&self) -> bool {
        !matches!(self.unseen, Some(Unseen::Told { .. })) && self.at_bound.contains(&Some(Bound::Low))
    }
}

/// Estimates of coupling and relaxation rate, or why there are none.
pub(super) fn bending_estimate(feature: Feature, bending: Result<&Bending, &str>) -> Option<Estimate> {
    let index = match feature {
        Feature::Coupling => 0,
        Feature::Rate => 1,
        _ => return None,
    };
    let bending = match bending {
        Ok(bending) => bending,
        Err(reason) => return Some(Estimate::not_determined(reason)),
    };
    if let Some(why) = bending.shown.why_open() {
        // A coupling near zero leaves the rate open, and its own size depends on that rate.
        return Some(Estimate::not_determined(why));
    }
    let error = bending.covariance.error(index);
    let half = bending.residuals.quantile * error;
    Some(if index == 0 {
        coupling(bending, error, half)
    } else {
        rate(bending, error, half)
    })
}

fn coupling(bending: &Bending, error: f64, half: f64) -> Estimate {
    let stated = interval_rule::signed(bending.coupling_per_c_cm, error, half);
    stated
        .filter(|_| !bending.at_upper_bound)
        .unwrap_or_else(|| Estimate::not_determined(OPEN_COUPLING))
}

const OPEN_COUPLING: &str = "coupling and rate cannot be told apart, or the charge is not known well enough: \
                             the 95 % interval of the coupling would contain zero although the strip bends";

/// Whether the interval of the coupling reaches zero; without a coupling the rate means nothing either.
fn coupling_is_open(bending: &Bending) -> bool {
    let error = bending.covariance.error(0);
    let half = bending.residuals.quantile * error;
    bending.at_upper_bound || half.is_nan() || half >= bending.coupling_per_c_cm.abs()
}

fn rate(bending: &Bending, error: f64, half: f64) -> Estimate {
    let value = bending.rate_per_s;
    if bending.at_upper_bound {
        let mut estimate =
            Estimate::not_determined("relaxation is faster than the readings follow each other");
        estimate.at_bound = true;
        return estimate;
    }
    if coupling_is_open(bending) || !half.is_finite() {
        return Estimate::not_determined(OPEN_COUPLING);
    }
    interval_rule::from_zero(value, error, value - half, value + half, interval_rule::TOO_SLOW)
}
