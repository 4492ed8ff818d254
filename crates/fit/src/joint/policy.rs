//! What decides in fits of both responses at once, and in their noise: every number with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted by itself; the command that counts all of them stands in
//! `crate::policy`. How a further property of the noise is weighed stands in `ieap_numerics::correlation`.

use ieap_domain::quantiles::CHI_SQUARE_95;

/// A root mean square of the residuals beyond this multiple of the noise is no chance: the noise is taken from the
/// scatter of neighbours, which finds slow noise (correlation 0.8) up to three times too small.
pub(crate) const MISFIT_FACTOR: f64 = 4.0;
/// Rise of the sum of squares beyond which a hidden branch is ruled out (95 %).
pub(super) const RULED_OUT_RISE: f64 = CHI_SQUARE_95[0];
/// How much wider the intervals of a branch are that was only just taken: runs in which chance made it look
/// larger are taken more often than those in which it made it look smaller. Chosen.
pub(super) const CHOSEN_WIDER: f64 = 0.5;
/// How far an interval of a logarithm is followed: just beyond the factor of [`crate::policy::WIDEST_FACTOR`], where it gives no
/// value.
pub(crate) const FOLLOWED_LOG: f64 = 1.7;
/// A lower minimum found on the way counts when it lies this much deeper, in variances of the noise. Chosen.
pub(super) const DEEPER_BY: f64 = 0.02;
/// How far a logarithm may move from where it starts: a factor of about 160,000. Chosen.
pub(super) const FARTHEST_LOG: f64 = 12.0;
/// Refits to drawn readings from which their points of 2.5 % and 97.5 % are told. Chosen.
pub(super) const FEWEST_REFITS: usize = 20;
/// Noise is not taken to be smaller than this part of the peak: rounding, and what the model's kernels leave.
pub(super) const LEAST_NOISE_PART: f64 = 1e-9;

/// Channels do not share a correlation where chance makes so different ones this rarely. Chosen; of 171 effects of four standard
/// deviations 135 were seen with a memory that is shared so, 127 without; `hide_and_seek -- laws 4 4 own` counts what is seen now.
pub(super) const DIFFERENT_BELOW: f64 = 0.01;
/// Mean of the prior of a noise's correlation time, an exponential, in records. Chosen: of 27 readings it weighs a correlation of
/// 0.99 down by a deviance of 29 and one of 0.5 by 0.4; of 700 readings one of 0.99 by 1.
/// `cargo unit -p ieap-fit short_records` counts what short records state with it.
pub(super) const MEMORY_OF_RECORD: f64 = 0.25;
/// Shortest slow noise that is tried, in readings. Chosen.
pub(super) const SLOW_FROM_READINGS: f64 = 4.0;
/// Longest slow noise that is tried, in records. Chosen.
pub(super) const SLOW_TO_RECORDS: f64 = 0.35;
/// Parts of the variance that slow noise is tried with. Chosen.
pub(super) const SLOW_PARTS: [f64; 7] = [0.02, 0.05, 0.12, 0.3, 0.6, 0.85, 0.97];
/// Shortest process that noise of which every octave has as much (1/f) is made of, in distances of readings. Chosen.
pub(super) const FLICKER_FROM_READINGS: f64 = 0.5;
/// Longest such process, in records. Chosen.
pub(super) const FLICKER_TO_RECORDS: f64 = 1.0;

/// A stretch of whitened readings that nodes stand for ends at this multiple of the time at which it begins: the nodes of
/// `ieap_numerics::discrete_gauss` are counted for it.
pub(super) const STRETCH: f64 = 2.0;
/// Rate times time from which on an exponential is nothing beside rounding: e^-40 is 4e-18.
pub(super) const GONE_AT: f64 = 40.0;

/// Exponentials of the smooth part per segment, at most. Chosen.
pub(super) const MOST_SHAPES: usize = 16;
/// The closest that they lie in the logarithm of time. Chosen.
pub(super) const CLOSEST_SHAPES_LOG: f64 = 0.6;
/// Powers of a moving voltage whose exponential means the smooth part holds, and of each how many at most. Chosen: the first are
/// the answers of every linear circuit and strip; the others keep what bends with the voltage from being taken for noise.
pub(super) const POWERS: [(i32, usize); 3] = [(1, 12), (2, 4), (3, 4)];
/// Readings for each of the shapes that follow the voltage, at least. Chosen.
pub(super) const READINGS_PER_ANSWER: usize = 24;

/// Means that the readings before the first edge are taken by at most, a record. Chosen.
pub(super) const BINS_AT_REST: f64 = 60.0;
/// Width of a mean behind an edge, in parts of the time since it, times the edges of the record. Chosen: a response of which a
/// twentieth of the time has passed is straight to 1e-4 of it.
pub(super) const BIN_WIDTH: f64 = 0.05;
/// Factor from one correlation time of slow noise to the next, and from one size of it to the next: between two such neighbours
/// the likelihood hardly differs (docs/validation/fitting.md counts what holds).
pub(super) const KIND_RATIO: f64 = 4.0;
/// Longest correlation time of slow noise, in records: beyond it all are the same walk.
pub(super) const SLOWEST_RECORDS: f64 = 4.0;
/// Largest slow noise, in variances of the white noise of a reading. Chosen: 9 parts in 10 of the variance.
pub(super) const LARGEST_SLOW_RATIO: f64 = 9.0;
