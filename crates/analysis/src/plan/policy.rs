//! What decides in plans of further runs: every number with its unit and where it comes from.
//!
//! What ties covariates, and from where on they are told apart, is that of the laws: `laws::policy::INFLATION_LIMIT`.

use crate::groups::HUMIDITY_TOLERANCE_PERCENT;

/// Humidities (percent points) and temperatures (degrees) no further apart than this are one level: as far apart as the
/// humidities of one group of runs may be.
pub const ONE_LEVEL: f64 = HUMIDITY_TOLERANCE_PERCENT;
/// Part of a gap between the humidities of two environments at which one is measured anew, from the other's on: half way
/// the variance inflation of the two would stay above its limit where two of three environments are dry (as in the thesis:
/// `cargo test -p ieap-analysis --lib plan::thesis_tests`).
pub const NEAR_THE_OTHER: f64 = 1.0 / 3.0;

/// Runs that a plan names at most. Chosen.
pub const MOST_RUNS: usize = 6;
/// Inflations above this are counted as this, and told as no bound: what is tied so tightly cannot be told apart at all. Chosen.
pub const MOST_INFLATION: f64 = 1e4;
/// Times that every condition is repeated in the design that says what can be untied at all. Chosen.
pub const REPEATS: usize = 4;

/// Candidates that are judged at most: with more conditions, fewer samples are looked at. Chosen; a
/// plan for 999 runs of 111 samples took 6.5 s with this, [`MOST_SAMPLES`] and [`JUDGED_BY`] (docs/methods/across-runs.md).
pub const MOST_CANDIDATES: usize = 160;
/// Samples that are looked at, most. Chosen.
pub const MOST_SAMPLES: usize = 6;
/// Ties that candidates are judged by, most. Chosen.
pub const JUDGED_BY: usize = 24;
