//! From which change on a voltage makes a step.

use crate::drive::policy::{LEAST_STEP_NOISE, LEAST_STEP_SHARE, LEAST_STEP_V};
use ieap_domain::range_of;

/// Least change of the voltage that counts as a step, V.
pub(super) fn step_threshold(values: &[f64], closed: &[usize], noise_v: f64) -> f64 {
    let (low, high) = range_of(closed.iter().map(|&i| values[i]));
    LEAST_STEP_V
        .max(LEAST_STEP_SHARE * (high - low))
        .max(LEAST_STEP_NOISE * noise_v)
}
