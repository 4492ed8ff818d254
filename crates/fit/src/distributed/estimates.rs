//! Parameters per area and per square with their intervals, and the reasons where there are none.

use ieap_domain::quantiles::CHI_SQUARE_95;
use ieap_domain::{Estimate, Parameter};
use ieap_numerics::student::quantile_95;

use super::contact_break::ContactBreak;
use super::described::electrical_parameters;
use super::electrical;
use super::given_error::given_resistance;
use super::identified::Identified;
use super::input::DistributedInput;
use super::mechanical::Mechanical;
use super::policy::UNEVEN_BELOW;
use super::squares::Fitted;
use super::unevenness::unevenness;
use crate::interval_rule;

const NO_SCALE: &str = "without a current and without the electrodes' resistance only products and ratios are known: tau_s, re_l2_per_rc, re_l2_per_rss";
const NO_BENDING: &str = "the run has no curvature along the strip";

/// All parameters in the order of the registry.
pub(super) fn parameters(found: &Identified) -> Vec<Parameter> {
    let (width_cm, length_cm) = (found.input.strip.width_cm, found.input.strip.length_cm);
    let electrical = &found.electrical;
    // With R_e set to what any other would do for, nothing but ratios is said.
    let absolute = |estimate: Estimate| {
        if found.is_relative {
            Estimate::not_determined(NO_SCALE)
        } else {
            estimate
        }
    };
    let of = |index: usize, factor: f64| absolute(positive(electrical, index, factor));
    let (mu, rate, alpha) = mechanical_estimates(found.mechanical.as_ref(), length_cm);
    let mut tau = vec![0.0; electrical.at.len()];
    (tau[0], tau[1]) = (1.0, 1.0);
    [
        ("re_ohm_per_sq", electrode_resistance(found)),
        ("rc_ohm_cm2", of(0, width_cm)),
        ("c_f_per_cm2", of(1, 1.0 / width_cm)),
        (
            "rss_ohm_cm2",
            absolute(steady(positive(electrical, 2, width_cm), electrical, width_cm)),
        ),
        ("mu_per_c", absolute(mu)),
        ("lambda_per_s", rate),
        ("alpha_per_c_cm", absolute(alpha)),
        ("tau_s", product(electrical, &tau, 0.0)),
        ("re_l2_per_rc", reach(found, 0)),
        ("re_l2_per_rss", reach(found, 2)),
    ]
    .into_iter()
    .map(|(key, estimate)| Parameter {
        key: key.to_owned(),
        estimate,
    })
    .chain(found.contact_break.iter().flat_map(ContactBreak::parameters))
    .collect()
}

/// `R_e L^2` over the resistance across the laminate of that index: R_c, or R_ss.
fn reach(found: &Identified, across: usize) -> Estimate {
    let strip = &found.input.strip;
    let given = strip.held_ohm_per_cm();
    let mut weights = vec![0.0; found.electrical.at.len()];
    weights[across] = -1.0;
    if electrical_parameters(strip) > 3 {
        weights[3] = 1.0;
    }
    let log_factor = given.map_or(0.0, f64::ln) + 2.0 * strip.length_cm.ln();
    product(&found.electrical, &weights, log_factor)
}

/// Whether the readings would tell the electrodes' resistance from none if nothing but noise were left: a break that is
/// not described yet makes all intervals wide.
pub(super) fn tells_electrodes(found: &Identified) -> bool {
    let fitted = &found.electrical;
    let mut weights = vec![0.0; fitted.at.len()];
    weights[0] = -1.0;
    if electrical_parameters(&found.input.strip) > 3 {
        weights[3] = 1.0;
    }
    let alone = weights.iter().zip(&fitted.inflation);
    let alone: Vec<f64> = alone
        .map(|(w, inflation)| w / inflation.max(1.0).sqrt())
        .collect();
    let error = fitted.covariance.error_along(&alone);
    interval_rule::is_narrow_enough(quantile_95(fitted.freedom) * error)
}

/// A parameter whose logarithm was fitted, times `factor`.
fn positive(fitted: &Fitted, index: usize, factor: f64) -> Estimate {
    let mut weights = vec![0.0; fitted.at.len()];
    weights[index] = 1.0;
    product(fitted, &weights, factor.ln())
}

/// A product of powers of parameters whose logarithms were fitted, and of `e^log_factor`.
fn product(fitted: &Fitted, weights: &[f64], log_factor: f64) -> Estimate {
    let log: f64 = weights.iter().zip(&fitted.at).map(|(w, at)| w * at).sum();
    let error = fitted.covariance.error_along(weights);
    let half = quantile_95(fitted.freedom) * error;
    let value = (log + log_factor).exp();
    interval_rule::positive(value, error, half, [1.0, 1.0]).unwrap_or_else(|| {
        Estimate::not_determined(format!(
            "what was measured does not separate it: {}",
            interval_rule::TOO_WIDE
        ))
    })
}

/// R_ss has a lower bound where no steady current is seen.
fn steady(estimate: Estimate, fitted: &Fitted, width_cm: f64) -> Estimate {
    if estimate.value.is_some() {
        return estimate;
    }
    let error = fitted.covariance.error(2);
    let low = (fitted.at[2] - quantile_95(fitted.freedom) * error).exp() * width_cm;
    if low.is_finite() && low > 0.0 {
        Estimate::above(low, interval_rule::NO_STEADY_CURRENT)
    } else {
        estimate
    }
}

/// R_e as it was given, or as it was found.
pub(super) fn electrode_resistance(found: &Identified) -> Estimate {
    let strip = &found.input.strip;
    match strip.electrode_resistance_ohm_per_sq {
        _ if found.is_relative => Estimate::not_determined(NO_SCALE),
        Some(_) if strip.probed().is_some() => positive(&found.electrical, 3, strip.width_cm),
        Some(given) => given_resistance(given, None),
        None => along(found, positive(&found.electrical, 3, found.input.strip.width_cm)),
    }
}

/// R_e has an upper bound where the strip cannot be told from one whose electrodes conduct perfectly: where the current
/// does not tell, or where places along the strip do not differ, which is the surer sign.
fn along(found: &Identified, estimate: Estimate) -> Estimate {
    let is_even = || unevenness(found).is_some_and(|uneven| uneven.p >= UNEVEN_BELOW);
    if estimate.value.is_some() && !is_even() {
        return estimate;
    }
    match along_below_ohm_per_sq(&found.input, found) {
        Some(bound) => Estimate::below(
            bound,
            "the strip cannot be told from one whose electrodes conduct perfectly along it",
        ),
        None => estimate,
    }
}

/// The resistance at which the sum of squares has risen by what 95 % asks for, the others fitted anew; none where the
/// readings hold against no resistance.
fn along_below_ohm_per_sq(input: &DistributedInput, found: &Identified) -> Option<f64> {
    let fitted = &found.electrical;
    let error = fitted.covariance.error(3);
    let mut tried = fitted.at[3].exp() * (1.0 + quantile_95(fitted.freedom) * error);
    let best = electrical::problem(input, &found.readings).square(&fitted.at);
    for _ in 0..6 {
        let mut held = *input;
        held.strip.electrode_resistance_ohm_per_sq = Some(tried * input.strip.width_cm);
        let problem = electrical::problem(&held, &found.readings);
        let rise = problem.search(&fitted.at[..3]).square - best;
        if rise >= CHI_SQUARE_95[0] * fitted.inflation[3] {
            return Some(tried * input.strip.width_cm);
        }
        tried *= 2.0;
        if !tried.is_finite() {
            break;
        }
    }
    None
}

/// mu, lambda, and alpha = mu / L.
fn mechanical_estimates(mechanical: Option<&Mechanical>, length_cm: f64) -> (Estimate, Estimate, Estimate) {
    let Some(found) = mechanical else {
        let none = || Estimate::not_determined(NO_BENDING);
        return (none(), none(), none());
    };
    let quantile = quantile_95(found.fitted.freedom);
    let error = found.fitted.covariance.error(0) * found.scale.abs();
    let signed = |factor: f64| {
        let (value, error) = (found.mu_per_c * factor, error * factor);
        interval_rule::signed(value, error, quantile * error).unwrap_or_else(|| {
            Estimate::not_determined("the curvature cannot be told from noise, or not what drives it")
        })
    };
    let rate = match found.rate_below_per_s {
        Some(bound) => Estimate::below(bound, interval_rule::TOO_SLOW),
        None => positive(&found.fitted, 1, 1.0),
    };
    (signed(1.0), rate, signed(1.0 / length_cm))
}
