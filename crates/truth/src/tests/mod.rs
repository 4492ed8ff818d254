//! The truth simulator against the closed form, hand-derived limits, and itself without the effect.

mod base;
mod electrical;
mod foreign;
mod listed;
mod mechanical;
mod refusals;

use super::*;
use ieap_domain::Branch;
use ieap_domain::testing::branch;
pub(super) use ieap_domain::testing::drive;
use ieap_model::LumpedModel;

/// A sample of the size of the thesis's: taus of 51 s and 130 s, 1/lambda of 250 s.
pub(super) fn truth() -> Truth {
    Truth {
        branches: vec![branch(521.4, 0.098), branch(1000.0, 0.13)],
        steady_state_resistance_ohm_cm2: 5660.0,
        charge_to_curvature_per_c_cm: 13.88,
        relaxation_rate_per_s: 4e-3,
        area_cm2: 0.1,
        length_cm: Some(0.5),
        width_cm: Some(0.2),
        effects: Vec::new(),
    }
}

pub(super) fn effect(id: &str, variant: Option<&str>, parameters: &[(&str, f64)]) -> HiddenEffect {
    HiddenEffect {
        id: id.to_owned(),
        variant: variant.map(str::to_owned),
        parameters: parameters
            .iter()
            .map(|&(key, value)| (key.to_owned(), value))
            .collect(),
    }
}

pub(super) fn with(effect: HiddenEffect) -> Truth {
    Truth {
        effects: vec![effect],
        ..truth()
    }
}

pub(super) fn model(truth: &Truth) -> LumpedModel {
    LumpedModel {
        branches: truth.branches.clone(),
        steady_state_resistance_ohm_cm2: truth.steady_state_resistance_ohm_cm2,
        charge_to_curvature_per_c_cm: truth.charge_to_curvature_per_c_cm,
        relaxation_rate_per_s: truth.relaxation_rate_per_s,
    }
}

/// Half-second readings that become sparser.
pub(super) fn times() -> Vec<f64> {
    let early = (-10..120).map(|k| 0.5 * f64::from(k));
    early.chain((0..540).map(|k| 60.0 + f64::from(k))).collect()
}

pub(super) fn respond(truth: &Truth, drive: &Drive, time_s: &[f64]) -> TruthResponses {
    simulate(truth, drive, time_s, time_s, 0).unwrap()
}

/// Largest difference, against the largest magnitude of the second (that of a signal that is none: 1e-9).
pub(super) fn apart(one: &[f64], other: &[f64]) -> f64 {
    let size = other.iter().fold(0.0_f64, |size, v| size.max(v.abs()));
    let worst = one
        .iter()
        .zip(other)
        .fold(0.0_f64, |w, (a, b)| w.max((a - b).abs()));
    assert!(worst.is_finite());
    worst / size.max(1e-9)
}
