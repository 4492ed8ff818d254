//! What decides which readings are left out: every number with its unit and where it comes from.

/// Readings of a channel from which the spread about their neighbours is known. Chosen.
pub const FEWEST_FOR_SPREAD: usize = 30;
/// Readings after an edge of the drive in which a fast decay may look like one reading off. Chosen.
pub const READINGS_AFTER_EDGE: usize = 4;
/// Readings before an edge whose neighbours lie behind it: the farthest that is asked is two readings ahead.
pub const READINGS_BEFORE_EDGE: usize = 2;
/// Readings of a stretch whose surroundings tell the spread. Chosen.
pub const READINGS_OF_SURROUNDINGS: usize = 16;

/// An outlier stands this many robust standard deviations of the steps between readings out of both of its neighbours. Chosen: of
/// readings of Gaussian noise fewer than one in ten million do (`clean_runs_lose_no_reading`).
pub(super) const OUTLIER_SPREADS: f64 = 5.0;
/// Steps to either side that an outlier is held against. Chosen.
pub(super) const NEIGHBOURS: usize = 3;
/// It stands out by so many times the largest of these: a peak that is sampled stands out by less than the steps beside it.
/// Chosen.
pub(super) const BESIDE: f64 = 2.0;
/// Part of the largest reading below which no instrument tells one reading from another. Chosen.
pub(super) const FINEST_PART: f64 = 1e-6;
/// Times that are told one by one. Chosen.
pub(super) const MOST_TOLD: usize = 5;
