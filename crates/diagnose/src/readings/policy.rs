//! What decides about the readings of a group: every number with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted by itself. What all of them together call wrong where nothing is
//! hidden, `cargo run --release --example hide_and_seek -- null 40` counts (docs/validation/diagnose.md).

use ieap_numerics::correlation::NOISE_EVIDENCE;

/// Readings after the step that a channel needs to take part. Chosen.
pub(super) const FEWEST_READINGS: usize = 12;
/// Readings of a channel beyond which neighbours are averaged: the diagnosis asks about shapes, not about sampling. Chosen; what
/// happens within a mean is lost.
pub(super) const MOST_READINGS: usize = 1500;
/// Steps of time within this factor are the same: a correlation of neighbouring readings is one of their distance. Chosen.
pub(super) const SAME_STEP_FACTOR: f64 = 1.1;

/// A channel with a memory so many times as long as the middle one's kind is not believed. Chosen.
pub(super) const MEMORY_BEYOND_USUAL: f64 = 5.0;
/// Readings that carry as much as one independent one, at most: what remembers longer is drift, which a model owes an
/// answer to, and no noise. Chosen.
pub(super) const LONGEST_MEMORY_READINGS: f64 = 50.0;
/// Growths of the noise that are tried: its part that goes with the signal, at the largest signal of the group, in units
/// of its even part. Chosen.
pub(super) const GROWTHS: [f64; 12] = [0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 8.0, 16.0, 64.0];
/// Twice the log likelihood ratio that growth must bring, and each number that describes a memory: as any property of the noise.
/// Growth taken in vain costs little, growth missed makes every edge of the drive look wrong.
pub(super) const GROWTH_EVIDENCE: f64 = NOISE_EVIDENCE;
/// What a number that describes a memory must bring in twice the log likelihood (Akaike): slow noise that is missed makes a
/// simulation look wrong, slow noise taken in vain costs little.
pub(super) const SLOW_WORTH: f64 = 2.0;

/// An outlier stands this many robust standard deviations off. Chosen: under Gaussian noise one reading in two million does, and
/// what a model misses smoothly is not seen in differences of neighbours.
pub(super) const OUTLIER_SIGMAS: f64 = 5.0;
/// Other edges of the drive that show what the model misses so many readings behind an edge. Chosen.
pub(super) const FEWEST_OTHER_EDGES: usize = 3;
/// An outlier near an edge is so many times as far off as nine tenths of the readings at that place of other edges. Chosen.
pub(super) const BEYOND_OTHER_EDGES: f64 = 2.0;
/// Part of a channel's readings that are outliers at most: where more stand off the noise is of that kind. Under the bubbles of
/// a measured electrolysis (`electrolysis-onset` in docs/validation/diagnose.md) up to a tenth do. Chosen below
/// that.
pub(super) const MOST_OUTLIERS_PART: f64 = 0.03;
/// Chance below which outliers beside edges are no wild values. A wild value stands anywhere; what stands off beside edges more
/// often than elsewhere is how the strip or the source answers them, and is asked for its cause. One of 1,200 readings, beside
/// an edge and with none elsewhere, is below it; two of them among thirty elsewhere are not.
pub(super) const BESIDE_EDGES_BELOW: f64 = 1e-2;

/// Runs in which noise grows with the voltage for it to be told: seven in order come so by chance in 1 of 5,000 cases.
pub(super) const FEWEST_FOR_LOUDER: usize = 7;
/// Loudest over quietest noise that is worth a word. Chosen.
pub(super) const LOUDER_FACTOR: f64 = 3.0;
/// Kendall's statistic in its standard deviations beyond which the order is no chance: 1 in 1,000.
pub(super) const LOUDER_SIGMAS: f64 = 3.1;
/// Readings from which the noise of a run is known. Chosen.
pub(super) const FEWEST_FOR_NOISE: usize = 20;

/// A record so many times as long as another is one of another length. Chosen.
pub(super) const LONGER_RECORD_FACTOR: f64 = 2.0;
/// A time constant so many times as large has grown with the record. Chosen.
pub(super) const GROWN_FACTOR: f64 = 1.5;
/// Exponents of a power law that are tried: at 0 it is a resistance, at 1 the charge has no end. Chosen short of both.
pub(super) const POWER_LAW_EXPONENTS: (f64, f64) = (0.05, 0.95);
/// Readings sooner behind an edge than this part of the usual interval are left out of a power law, which has no limit there.
/// Chosen.
pub(super) const POWER_LAW_FROM_PART: f64 = 0.1;

/// Readings that are averaged where a single one would be noise. Chosen.
pub(super) const READINGS_TOGETHER: usize = 5;
/// Part of the record that counts as its end. Chosen.
pub(super) const END_PART: f64 = 0.05;
/// A value that is not so many of its standard errors is next to nothing: what a prediction is off by is no part of it. Chosen;
/// a strip that had relaxed was said to be 270 % off its curvature.
pub(super) const KNOWN_FROM_SIGMAS: f64 = 5.0;

/// Readings at rest from which a zero and a drift of the instrument are known. Chosen.
pub(super) const FEWEST_AT_REST: usize = 8;
/// Stretches of a rest whose means tell how well its mean is known. Chosen.
pub(super) const REST_BLOCKS: usize = 4;
/// Drift of an instrument over a record, current and curvature, as a part of the range that it reads, which is allowed for at
/// most (standard deviation): an ammeter hardly drifts within a run, a laser or a camera's mount does. Chosen;
/// `cargo run --release --example hide_and_seek -- null 40 1 zero laser` counts what it gives.
pub(super) const MOST_DRIFT_PARTS: [f64; 2] = [0.0, 0.01];
