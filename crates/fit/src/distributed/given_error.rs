//! The uncertainty of a resistance that was given: what a probe measured with an error moves every parameter that is
//! fitted with it.
//!
//! The fit is made again with the resistance a standard error higher and lower. Half of the difference is the error that
//! the probe adds to a parameter, independent of that of the readings (the delta method, with the fit's own derivative).

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Estimate, Fit, Issue};

/// Key of the resistance.
const RESISTANCE: &str = "re_ohm_per_sq";

/// The fit with its intervals as wide as the error of the resistance makes them, from those with it higher and lower.
pub(super) fn widened(mut fit: Fit, given: f64, error: f64, [lower, higher]: [&Fit; 2]) -> Fit {
    for parameter in &mut fit.parameters {
        let own = &mut parameter.estimate;
        if parameter.key == RESISTANCE {
            *own = resistance(given, error);
            continue;
        }
        let of = |fit: &Fit| fit.parameter(&parameter.key).cloned();
        if let (Some(lower), Some(higher)) = (of(lower), of(higher)) {
            *own = with_both(own, &lower, &higher);
        }
    }
    let message = format!("R_e was measured as {given} ± {error} Ohm/sq; the intervals hold its error");
    fit.issues
        .push(Issue::note("given-uncertainty", message).at(RESISTANCE));
    fit
}

/// A resistance that was given, with its error where that is known.
pub fn given_resistance(ohm_per_sq: f64, error_ohm_per_sq: Option<f64>) -> Estimate {
    match error_ohm_per_sq {
        Some(error) => resistance(ohm_per_sq, error),
        None => Estimate {
            value: Some(ohm_per_sq),
            ..Estimate::not_determined("given with the sample, not fitted")
        },
    }
}

/// The resistance as it was given, never below zero.
fn resistance(given: f64, error: f64) -> Estimate {
    let width = (NORMAL_95 * error / given).exp();
    Estimate {
        reason: Some("given with the sample, not fitted".to_owned()),
        ..Estimate::determined(given, error, given / width, given * width)
    }
}

fn with_both(own: &Estimate, lower: &Estimate, higher: &Estimate) -> Estimate {
    let (Some(value), Some(a), Some(b)) = (own.value, lower.value, higher.value) else {
        return outermost(own, lower, higher);
    };
    let error = own.standard_error.map(|error| error.hypot(0.5 * (b - a)));
    let is_positive = [Some(value), own.low_95, Some(a), Some(b)]
        .iter()
        .all(|x| x.is_some_and(|x| x > 0.0));
    // Numbers that are positive by definition have their intervals on a log scale.
    let onto = |x: f64| if is_positive { x.ln() } else { x };
    let from = |x: f64| if is_positive { x.exp() } else { x };
    let shift = NORMAL_95 * 0.5 * (onto(b) - onto(a));
    let end = |end: f64, sign: f64| {
        let reach = (onto(end) - onto(value)).hypot(shift);
        from(onto(value) + sign * reach)
    };
    Estimate {
        standard_error: error,
        low_95: own.low_95.map(|low| end(low, -1.0)),
        high_95: own.high_95.map(|high| end(high, 1.0)),
        ..own.clone()
    }
}

/// Of a number that is only bounded: the weakest bound of the three.
fn outermost(own: &Estimate, lower: &Estimate, higher: &Estimate) -> Estimate {
    let weakest = |of: fn(&Estimate) -> Option<f64>, pick: fn(f64, f64) -> f64| {
        Some(pick(of(own)?, pick(of(lower)?, of(higher)?)))
    };
    Estimate {
        low_95: weakest(|e| e.low_95, f64::min),
        high_95: weakest(|e| e.high_95, f64::max),
        ..own.clone()
    }
}
