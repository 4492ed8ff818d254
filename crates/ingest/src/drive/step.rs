//! From which change on a voltage makes a step.

use ieap_domain::range_of;

/// Changes of the voltage below this are never a step, V: potentiostats hold a potential to about 1 mV.
pub(super) const LEAST_STEP_V: f64 = 2e-3;
/// A step must also exceed this share of the voltage's range.
const LEAST_STEP_SHARE: f64 = 0.02;
/// A step must also exceed this many times the reading noise.
pub(super) const LEAST_STEP_NOISE: f64 = 8.0;

/// Least change of the voltage that counts as a step, V.
pub(super) fn step_threshold(values: &[f64], closed: &[usize], noise_v: f64) -> f64 {
    let (low, high) = range_of(closed.iter().map(|&i| values[i]));
    LEAST_STEP_V
        .max(LEAST_STEP_SHARE * (high - low))
        .max(LEAST_STEP_NOISE * noise_v)
}
