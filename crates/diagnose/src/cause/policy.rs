//! Which equations are fitted and what is held out: every number with its unit and where it comes from. Probabilities have a
//! table of their own, `evidence/policy.rs`, and chances another, `levels.rs`; what is told of it all, `missing/policy.rs`.
//!
//! Where a number is "chosen", its effect was not counted by itself. What all of them together name right and wrong,
//! `cargo run --release --example hide_and_seek -- laws 1 16,32` counts (docs/validation/missing-law.md).
//! Sums of squares are in variances of the noise.

/// Candidates are fitted in full whose forecast is this part of the best one's. Chosen.
pub(super) const PROMISING_PART: f64 = 0.4;
/// Candidates are fitted as well whose forecast is so near to the best one's, sum of squares. Chosen.
pub(super) const PROMISING_WITHIN: f64 = 25.0;
/// Candidates that are fitted in full at least. Chosen.
pub(super) const FEWEST_FITTED: usize = 5;
/// Candidates that are fitted in full at most. Chosen.
pub(super) const MOST_FITTED: usize = 10;
/// Candidates whose quick fit comes within this part of the best one's are fitted to the end. Chosen.
pub(super) const CONTENDING_WITHIN_PART: f64 = 0.5;
/// Starts of every candidate: its best probes. Chosen.
pub(super) const STARTS: usize = 4;

/// Evidence that a strength must bring, in units of the sum of squares; where forms are compared, or several effects with
/// several, every parameter. Chosen.
pub(crate) const PRICE: f64 = 3.0;
/// Candidates this close to the best explain the readings as well, sum of squares: a likelihood ratio of 20 to 1.
pub(crate) const AS_GOOD: f64 = 6.0;

/// Voltages and lengths of runs this near, in parts, are the same. Chosen.
pub(super) const BESIDE_PART: f64 = 0.02;

/// Part of a run's time that is earlier, and predicts the later. Chosen.
pub(super) const EARLIER_PART: f64 = 0.6;
/// What of a single run is held out beside its later time, in parts of the logarithm of its time: what happens after a step
/// happens there. Chosen.
pub(super) const HELD_OUT_OF_LOG: (f64, f64) = (0.5, 0.75);
/// Precision of what is known before held-out readings are predicted, in coordinates scaled to be of order one: a standard
/// deviation of three. Chosen.
pub(super) const PREDICTED_FROM: f64 = 1.0 / 9.0;
