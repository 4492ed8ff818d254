//! The value of a channel at the end of a stretch, with drift and with noise that remembers allowed for.

use super::policy::{FEWEST_FOR_LEVEL, LEVEL_WINDOW};

use ieap_domain::Estimate;
use ieap_domain::number::seconds::span;
use ieap_numerics::linear::{LeastSquares, variance_of_sum};
use ieap_numerics::student::quantile_95;

/// Terms of the cubic.
const TERMS: i32 = 4;

/// A value at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Degrees of freedom: independent readings less the terms of the cubic.
    pub freedom: f64,
}

impl Level {
    /// Half-width of the 95 % interval.
    pub fn half_width(&self) -> f64 {
        self.standard_error * quantile_95(self.freedom)
    }

    /// As an estimate.
    pub fn estimate(&self) -> Estimate {
        let half = self.half_width();
        Estimate::determined(
            self.value,
            self.standard_error,
            self.value - half,
            self.value + half,
        )
    }
}

/// The value at `until_s`, or at the last reading before it, of readings in `from_s..=until_s`, from a cubic in time
/// over the last half of them.
///
/// A cubic follows a drift and the tail of a relaxation, so that the value is that at the end and no mean over it.
/// Its standard error is that of least squares under a first-order autoregression found in the residuals.
///
/// # Errors
/// Why there is none: too few readings.
pub fn at_end(time_s: &[f64], values: &[f64], from_s: f64, until_s: f64) -> Result<Level, String> {
    let first = time_s.partition_point(|&t| t < from_s);
    let end = time_s.partition_point(|&t| t <= until_s);
    let count = end.saturating_sub(first);
    if count < FEWEST_FOR_LEVEL {
        return Err(format!(
            "{count} readings from {}; {FEWEST_FOR_LEVEL} are needed",
            span(from_s, until_s)
        ));
    }
    let until_s = time_s[end - 1];
    let middle_s = until_s - LEVEL_WINDOW * (until_s - from_s);
    let start = time_s
        .partition_point(|&t| t < middle_s)
        .min(end - FEWEST_FOR_LEVEL)
        .max(first);
    let (time_s, values) = (&time_s[start..end], &values[start..end]);
    let span_s = until_s - time_s[0];
    let power = |power: i32| {
        time_s
            .iter()
            .map(|t| ((t - until_s) / span_s).powi(power))
            .collect()
    };
    let columns: Vec<Vec<f64>> = (0..TERMS).map(power).collect();
    // The mean is taken off so that a large offset costs no digits.
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let centred: Vec<f64> = values.iter().map(|v| v - mean).collect();
    let Some(fit) = LeastSquares::of(columns, &centred) else {
        return Err("the readings are too unevenly spread in time".to_owned());
    };
    let noise = fit.noise();
    let variance = variance_of_sum(&fit.weights(&[1.0, 0.0, 0.0, 0.0]), &noise);
    Ok(Level {
        value: fit.coefficients[0] + mean,
        standard_error: variance.sqrt().max(rounding(values)),
        freedom: (noise.effective_readings(values.len() as f64) - f64::from(TERMS)).max(1.0),
    })
}

/// What the rounding of printed readings leaves uncertain where they scatter less than their last digit.
fn rounding(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    // Where readings differ in many places, the noise has rounded them already.
    if sorted.len() > FEWEST_FOR_LEVEL / 2 {
        return 0.0;
    }
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    let step = steps.fold(f64::INFINITY, f64::min);
    if step.is_finite() {
        step / 12f64.sqrt()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(n: usize) -> Vec<f64> {
        (0..n).map(|k| 30.0 * k as f64).collect()
    }

    #[test]
    fn a_drift_is_followed_to_its_end() {
        let time_s = times(100);
        let values: Vec<f64> = time_s.iter().map(|t| 400.0 - 0.01 * t + 1e-7 * t * t).collect();
        let found = at_end(&time_s, &values, 0.0, 2970.0).unwrap();
        assert!((found.value - values[99]).abs() < 1e-9, "{found:?}");
        assert!(found.standard_error < 1e-9);
    }

    #[test]
    fn too_few_readings_are_said() {
        let time_s = times(11);
        let reason = at_end(&time_s, &[1.0; 11], 0.0, 300.0).unwrap_err();
        assert!(
            reason.contains("11 readings") && reason.contains("12 are needed"),
            "{reason}"
        );
        assert!(at_end(&[], &[], 0.0, 1.0).is_err());
    }

    #[test]
    fn coarse_readings_keep_the_uncertainty_of_their_last_digit() {
        let time_s = times(40);
        let values: Vec<f64> = (0..40).map(|k| if k == 25 { 461.0 } else { 460.0 }).collect();
        let found = at_end(&time_s, &values, 0.0, 1170.0).unwrap();
        assert!(found.standard_error >= 0.28, "{found:?}");
    }
}
