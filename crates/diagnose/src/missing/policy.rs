//! What decides about a missing law: every number with its unit and where it comes from.
//!
//! All were chosen on development seeds; `cargo run --release --example hide_and_seek -- laws 16 32` counts what they give
//! (docs/validation/missing-law.md).

pub(super) use ieap_domain::diagnosis::SURE;

/// Laws that are fitted in full at most, so many at a time, and how far below the best one's logarithm of evidence, in parts of
/// that and beside.
pub(super) const MOST_FITTED: usize = 12;
pub(super) const FITTED_TOGETHER: usize = 4;
pub(super) const NEAR_PART: f64 = 0.15;
pub(super) const NEAR_BESIDE: f64 = 12.0;

/// Prior weights, those of all laws and equations together being one: that runs differ; slow noise.
pub(super) const DIFFERS: f64 = 0.05;
pub(super) const SLOW: f64 = 0.05;
/// Prior weight, beside that of all laws, that something follows the drive which is none of them, in the current and in the bending
/// together. Prototype (0.15 beside 0.35); `hide_and_seek -- laws 24 32 absent outside` counts what it gives.
pub(super) const UNNAMED: f64 = 0.4;
/// Relaxations of such an answer, and those of all runs' own together, for the time that they take. Chosen.
pub(super) const RELAXATIONS: usize = 6;
pub(super) const MOST_RELAXATIONS: usize = 60;
/// What the width of a strength costs where an equation was not fitted in full: the logarithm of as many standard deviations
/// as are thought of.
pub(super) const UNFITTED: f64 = 5.0;
/// Part of the weight of a law and variable that its smooth curves have; its equations have the rest.
pub(super) const OF_CURVES: f64 = 0.5;
pub(crate) use ieap_domain::finding_words::INEXACT;

/// Logarithm of the odds on held-out readings from which a law is told: nineteen to one, as of all that is sure.
pub(super) const CLEAR_GAIN: f64 = 2.944;
/// A law must leave less than this part of the error beyond noise: the larger part is its own. By definition.
pub(super) const LARGER_PART: f64 = 0.5;
/// Part of the square of its columns by which a law may differ from another that is the same on the group's drives: a thousandth, which
/// the steps of the integration leave. Chosen.
pub(super) const ALIKE: f64 = 1e-6;
/// Laws that are sought one after another at most. Chosen.
pub(super) const MOST_LAWS: usize = 3;
/// Part of the error beyond noise that laws must leave for another one to be sought: no law is exact.
pub(super) const NEXT_FROM_PART: f64 = 0.05;
/// Hypotheses below this probability are not told, but for the leading one of each kind. Chosen.
pub(super) const LEAST_PROBABILITY: f64 = 1e-3;
/// A law is drawn where the readings leave so much of the error that was there before (of a steady current, of its largest value),
/// in as many places at least; else not. Chosen.
pub(super) const TOLD_PART: f64 = 0.5;
pub(super) const FEWEST_PLACES: usize = 5;
/// Places over the variable at which a law is drawn.
pub(super) const PLACES: usize = 41;
/// Voltages at which a steady current is drawn, and time constants of the slowest branch after which it is one.
pub(super) const STEADY_PLACES: usize = 25;
pub(super) const STEADY_AFTER: f64 = 12.0;
/// Explanations at most that a next run is asked to tell apart. Chosen.
pub(super) const MOST_RIVALS: usize = 5;
