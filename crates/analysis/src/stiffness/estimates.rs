//! Arithmetic of estimates: products of positive ones, other units.

use ieap_domain::Estimate;
use ieap_domain::quantiles::NORMAL_95;

pub(super) fn of_logarithm(logarithm: f64, error: f64) -> Estimate {
    let value = logarithm.exp();
    let width = (NORMAL_95 * error).exp();
    Estimate::determined(value, value * error, value / width, value * width)
}

/// The product of independent positive numbers, each with its power; what one of them lacks, it lacks.
pub fn product(factors: &[(&Estimate, f64)]) -> Estimate {
    let (mut logarithm, mut variance) = (0.0, 0.0);
    for (factor, power) in factors {
        let known = factor
            .value
            .filter(|value| *value > 0.0)
            .zip(factor.standard_error);
        let Some((value, error)) = known else {
            let reason = factor.reason.clone();
            return Estimate::not_determined(
                reason.unwrap_or_else(|| "a part of it is not determined".to_owned()),
            );
        };
        logarithm += power * value.ln();
        variance += (power * error / value).powi(2);
    }
    of_logarithm(logarithm, variance.sqrt())
}

/// A coupling may bend the other way: its size is what is split.
pub(crate) fn size(alpha: &Estimate) -> Estimate {
    alpha.scaled(alpha.value.map_or(1.0, f64::signum))
}
