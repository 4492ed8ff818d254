//! What decides what a finding says: every number with its unit and where it comes from. Which cause it is was decided before
//! (`cause/policy.rs`).

/// Spikes beyond this part of the readings make the readings themselves the problem. Chosen.
pub(super) const SPIKED_PART: f64 = 0.05;

/// Independent readings, in parts of a record's, below which noise is told to be slow: noise that dies away from one reading to
/// the next is not worth a sentence. Chosen.
pub(super) const SLOW_BELOW_PART: f64 = 0.25;

/// Readings of a run that is proposed. Chosen.
pub(super) const READINGS_OF_NEXT_RUN: usize = 400;
/// Chances from places along the strip are stated down to here: below it they tell of a far tail of the noise that nothing has
/// checked. Chosen.
pub(super) const LEAST_CHANCE: f64 = 1e-6;
