//! The memory of a channel's noise as a number with an interval: what is integrated over all correlations that were tried.

use ieap_domain::Estimate;

use super::tried::{correlation_at, posterior};
use crate::joint::whitening::Autocorrelation;
use crate::uncertainty::NOT_ONE_NUMBER;

const BY_TIME: &str = "the readings are uneven and the noise remembers by time: see its correlation time";
const TOO_FEW: &str = "too few readings tell it: the noise is taken to be white";
/// Half of what lies outside a 95 % interval.
const TAIL: f64 = 0.025;

/// Correlation of the noise of neighbouring readings. The value is the one that weighs the fit; the interval is that of the
/// likelihood with its prior, over the correlations that were tried.
pub(super) fn estimate(autocorrelation: &Autocorrelation, by_correlation: &[f64]) -> Estimate {
    let value = match autocorrelation {
        Autocorrelation::Order(coefficients) if coefficients.len() <= 1 => {
            coefficients.first().copied().unwrap_or(0.0)
        }
        Autocorrelation::Order(_) | Autocorrelation::Slow(_) => {
            return Estimate::not_determined(NOT_ONE_NUMBER);
        }
        Autocorrelation::Time { .. } => return Estimate::not_determined(BY_TIME),
    };
    let weights = posterior(by_correlation);
    if weights.is_empty() {
        return Estimate {
            value: Some(value),
            ..Estimate::not_determined(TOO_FEW)
        };
    }
    let square = |(place, weight): (usize, &f64)| weight * (correlation_at(place as f64) - value).powi(2);
    let variance: f64 = weights.iter().enumerate().map(square).sum();
    let low = correlation_at(quantile(&weights, TAIL)).min(value);
    let high = correlation_at(quantile(&weights, 1.0 - TAIL)).max(value);
    Estimate::determined(value, variance.sqrt(), low, high)
}

/// The index below which so much of the weight lies, between neighbouring places.
fn quantile(weights: &[f64], part: f64) -> f64 {
    let mut below = 0.0;
    for (place, weight) in weights.iter().enumerate() {
        if below + weight >= part {
            let within = (part - below) / weight.max(f64::MIN_POSITIVE) - 0.5;
            return (place as f64 + within).clamp(0.0, (weights.len() - 1) as f64);
        }
        below += weight;
    }
    (weights.len() - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::noise::tried::CORRELATIONS;

    fn order(rho: f64) -> Autocorrelation {
        Autocorrelation::Order(vec![rho])
    }

    /// The curve of a normal estimate at an index.
    fn curve(at: f64, error: f64) -> Vec<f64> {
        (0..=CORRELATIONS)
            .map(|k| ((k as f64 - at) / error).powi(2))
            .collect()
    }

    #[test]
    fn the_interval_is_that_of_the_likelihood() {
        let found = estimate(&order(correlation_at(30.0)), &curve(30.0, 4.0));
        let end = |index: f64| correlation_at(index);
        assert!(
            (found.low_95.unwrap() - end(30.0 - 7.84)).abs() < 0.01,
            "{found:?}"
        );
        assert!(
            (found.high_95.unwrap() - end(30.0 + 7.84)).abs() < 0.01,
            "{found:?}"
        );
        assert!((found.value.unwrap() - end(30.0)).abs() < 1e-12);
    }

    #[test]
    fn what_no_likelihood_tells_is_said_to_be_open() {
        assert!(estimate(&order(0.0), &[]).standard_error.is_none());
    }
}
