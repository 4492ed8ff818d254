//! How a simulated instrument samples.

use serde::Deserialize;

/// Even sampling up to a time.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sampling {
    /// Last time sampled so, s.
    pub until_s: f64,
    /// Interval, s.
    pub every_s: f64,
}
