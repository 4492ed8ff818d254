//! Intervals of a circuit's parameters, by the profile of the sum of squares: an end lies where the best of all
//! other parameters raises it by t^2 times the mean square that is left.

use ieap_domain::{Estimate, Parameter};
use ieap_model::impedance::Scale;
use ieap_numerics::least_squares::Minimum;
use ieap_numerics::slopes::gradient;
use ieap_numerics::student::quantile_95;

use super::search::Simulated;

/// Widest first step of the search for an end.
const WIDEST_STEP: f64 = 1.0;
/// Halvings of the stretch in which an end lies.
const HALVINGS: usize = 14;
/// A place this near to a bound is at it.
const AT_BOUND: f64 = 1e-6;
/// Relative pivot at which directions without information are held.
const FLOOR: f64 = 1e-14;

const OPEN_HIGH: &str = "the spectrum only says that it is larger: more does not change it within its noise";
const OPEN_LOW: &str = "the spectrum only says that it is smaller: less does not change it within its noise";
const OPEN_BOTH: &str = "the spectrum does not determine it";

/// Every parameter of the circuit.
pub(super) fn of_parameters(problem: &Simulated<'_>, found: &Minimum) -> Vec<Parameter> {
    let parameters = problem.circuit.parameters.iter().enumerate();
    parameters
        .map(|(k, parameter)| {
            let ends = [-1.0, 1.0].map(|direction| end(problem, found, k, direction));
            let value = |x: f64| match parameter.scale {
                Scale::Exponent => x,
                _ => x.exp(),
            };
            let error = standard_error(problem, found, k);
            let error = match parameter.scale {
                Scale::Exponent => error,
                _ => error * found.at[k].exp(),
            };
            Parameter {
                key: parameter.key.to_owned(),
                estimate: estimate(
                    value(found.at[k]),
                    error,
                    ends.map(|end| end.map(value)),
                    parameter.scale == Scale::Exponent,
                ),
            }
        })
        .collect()
}

fn estimate(value: f64, error: f64, ends: [Option<f64>; 2], has_limits: bool) -> Estimate {
    match ends {
        [Some(low), Some(high)] => Estimate::determined(value, error, low, high),
        // An exponent of 1 is a capacitor: a limit that means something.
        [low, high] if has_limits => Estimate {
            at_bound: low.is_none() && high.is_none(),
            ..Estimate::determined(
                value,
                error,
                low.unwrap_or(ieap_model::impedance::LEAST_EXPONENT),
                high.unwrap_or(1.0),
            )
        },
        [Some(low), None] => Estimate::above(low, OPEN_HIGH),
        [None, Some(high)] => Estimate::below(high, OPEN_LOW),
        [None, None] => Estimate::not_determined(OPEN_BOTH),
    }
}

/// Degrees of freedom that are left.
fn freedom(problem: &Simulated<'_>) -> f64 {
    (problem.readings() as f64 - problem.circuit.parameters.len() as f64).max(1.0)
}

fn standard_error(problem: &Simulated<'_>, found: &Minimum, k: usize) -> f64 {
    let variance = found.local.normal.floored_inverse(FLOOR).get(k, k);
    (variance * found.local.square / freedom(problem)).sqrt()
}

/// The end of the interval of coordinate `k` in a direction; none where the bound of the search comes first.
fn end(problem: &Simulated<'_>, found: &Minimum, k: usize, direction: f64) -> Option<f64> {
    let quantile = quantile_95(freedom(problem));
    let limit = found.local.square * (1.0 + quantile * quantile / freedom(problem));
    let bounds = &problem.bounds;
    let bound = if direction > 0.0 {
        bounds.high[k]
    } else {
        bounds.low[k]
    };
    let room = (bound - found.at[k]).abs();
    let mut at = found.at.clone();
    let mut step = (quantile * standard_error(problem, found, k)).clamp(1e-9, WIDEST_STEP);
    let (mut inside, mut outside) = (0.0, None);
    while outside.is_none() {
        if inside >= room - AT_BOUND {
            return None;
        }
        let far = (inside + step).min(room);
        let there = problem.lowest_with(&at, k, found.at[k] + direction * far);
        if there.local.square > limit {
            outside = Some(far);
        } else {
            (inside, at) = (far, there.at);
            step *= 2.0;
        }
    }
    let mut outside = outside.unwrap_or(room);
    for _ in 0..HALVINGS {
        if outside - inside <= 1e-4 * outside {
            break;
        }
        let middle = 0.5 * (inside + outside);
        let there = problem.lowest_with(&at, k, found.at[k] + direction * middle);
        if there.local.square > limit {
            outside = middle;
        } else {
            (inside, at) = (middle, there.at);
        }
    }
    Some(found.at[k] + direction * 0.5 * (inside + outside))
}

/// A positive function of the parameters: its interval follows from the slopes of its logarithm.
pub(super) fn of_function(
    problem: &Simulated<'_>,
    found: &Minimum,
    key: &str,
    function: &dyn Fn(&[f64]) -> f64,
) -> Parameter {
    const STEP: f64 = 1e-5;
    let value = function(&found.at);
    let slopes = gradient(&found.at, |_| STEP, |at| function(at).ln());
    let inverse = found.local.normal.floored_inverse(FLOOR);
    let variance = inverse.form(&slopes, &slopes) * found.local.square / freedom(problem);
    let width = variance.sqrt() * quantile_95(freedom(problem));
    Parameter {
        key: key.to_owned(),
        estimate: Estimate::determined(
            value,
            value * variance.sqrt(),
            value * (-width).exp(),
            value * width.exp(),
        ),
    }
}
