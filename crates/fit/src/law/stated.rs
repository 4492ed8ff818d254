//! From couplings and shapes to estimates: values with intervals where the data determine them, bounds or reasons where
//! they do not.

use ieap_domain::{Estimate, Parameter};
use ieap_model::BendingLaw;
use ieap_model::bending::{Reported, Shape, Stated};
use ieap_numerics::slopes;

use super::identified::Bent;
use crate::interval_rule;

const OPEN: &str = "the law's parameters cannot be told apart, or the charge is not known well enough: \
                    the 95 % interval of its coupling would contain zero although the strip bends";
const IDLE: &str = "the strip does not creep on under its charge, so that nothing is there to be shaped";
const FROM_ZERO: &str = "it cannot be told from zero in this record";
const TOO_SLOW: &str = "it is too slow for this record";
const WIDE: &str = "the curvature leaves it open";

/// Step of a gradient, in standard errors or parts of a value.
const STEP: f64 = 1e-4;

/// A parameter of a law that was not fitted, for `why`.
pub(super) fn not_known(reported: &Reported, why: &str) -> Parameter {
    Parameter {
        key: reported.key.to_owned(),
        estimate: Estimate::not_determined(why),
    }
}

/// Everything that the law reports.
pub(super) fn stated(law: &dyn BendingLaw, bent: &Bent) -> Vec<Parameter> {
    let open = match bent.shown.why_open() {
        None if !is_coupled(law, bent) => Some(OPEN),
        why => why,
    };
    let of = |reported: &Reported| Parameter {
        key: reported.key.to_owned(),
        estimate: match open {
            Some(why) => Estimate::not_determined(why),
            None => estimate(law, reported, bent),
        },
    };
    law.reported().iter().map(of).collect()
}

/// Whether any coupling can be told from zero.
fn is_coupled(law: &dyn BendingLaw, bent: &Bent) -> bool {
    (0..law.couplings()).any(|k| {
        let half = bent.residuals.quantile * bent.covariance.error(k);
        half < bent.natural[k].abs()
    })
}

fn estimate(law: &dyn BendingLaw, reported: &Reported, bent: &Bent) -> Estimate {
    let gradient = gradient(reported, bent);
    if let Some(k) = (0..bent.natural.len()).find(|&k| bent.held[k] && gradient[k] != 0.0) {
        let shape = law.shapes()[k - bent.couplings];
        let mut estimate = Estimate::not_determined(if bent.idle { IDLE } else { beyond(shape) });
        estimate.at_bound = true;
        return estimate;
    }
    let value = (reported.of)(&bent.natural);
    let error = bent.covariance.error_along(&gradient);
    let half = bent.residuals.quantile * error;
    let (low, high) = (value - half, value + half);
    if !(value.is_finite() && half.is_finite()) {
        return Estimate::not_determined(WIDE);
    }
    match reported.stated {
        Stated::Coupling => {
            interval_rule::signed(value, error, half).unwrap_or_else(|| Estimate::not_determined(OPEN))
        }
        Stated::Signed => Estimate::determined(value, error, low, high),
        Stated::FromZero => interval_rule::from_zero(value, error, low, high, FROM_ZERO),
        Stated::Time if high <= 0.0 => Estimate::not_determined(WIDE),
        Stated::Time if low <= 0.0 => {
            let mut estimate = Estimate::above(high.recip(), TOO_SLOW);
            estimate.at_bound = value == 0.0;
            estimate
        }
        Stated::Time => {
            Estimate::determined(value.recip(), error / (value * value), high.recip(), low.recip())
        }
    }
}

/// Why a shape at its upper limit has no value.
fn beyond(shape: Shape) -> &'static str {
    match shape {
        Shape::Rate => "it is faster than the readings follow each other",
        Shape::Part => "it lies at 1, the most that the law allows",
        Shape::Excess => "it lies at the largest ratio that is searched",
    }
}

/// Derivatives of a reported number by the natural parameters.
fn gradient(reported: &Reported, bent: &Bent) -> Vec<f64> {
    let step = |k: usize| {
        let size = bent.natural[k].abs();
        STEP * if size > 0.0 {
            size
        } else {
            bent.covariance.error(k).max(1e-12)
        }
    };
    slopes::gradient(&bent.natural, step, |natural| (reported.of)(natural))
}
