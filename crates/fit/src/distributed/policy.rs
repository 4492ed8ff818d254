//! What decides along a strip: every number with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted by itself. How often even strips are called uneven, clean ones broken
//! and intervals hold, the commands of docs/validation/along-the-strip.md count.

/// Chance below which differences between places are claimed: the one in twenty that is a convention of the field.
pub const UNEVEN_BELOW: f64 = 0.05;
/// Chance below which a break is claimed. Chosen.
pub(super) const BREAK_BELOW: f64 = 0.01;
/// Draws of what chance does: none is told below one in a thousand, a convention of permutation tests.
pub(super) const BREAK_DRAWS: usize = 999;
/// Seed of the draws.
pub(super) const BREAK_SEED: u64 = 1;
/// Places that a break is looked for at. Chosen.
pub(super) const BREAK_PLACES: usize = 15;
/// A break is fitted where an answer, in variances of the noise of single readings, is at least so large: three standard
/// deviations. Chosen.
pub(super) const BREAK_FITTED_FROM: f64 = 9.0;
/// A foil is called cracked where its resistance changes by more than this factor, its interval allowed for: foils are
/// uneven by less, and so is what a tracer gets wrong. Chosen; without it an even foil in drawn frames was called cracked, by a
/// factor near one.
pub(super) const CRACK_FACTOR: f64 = 1.1;
/// Half width of a place's interval, as a share of the length, beyond which it is no place. Chosen.
pub(super) const WIDEST_PLACE: f64 = 0.25;

/// Readings that each phase needs at least. Chosen.
pub(super) const FEWEST_READINGS: usize = 12;
/// `R_e L^2 / R_c` below which nothing would be noticed: a lumped model is then wrong by a quarter of a thousandth.
pub(super) const LEAST_REACH: f64 = 1e-3;
/// The same beyond which nothing more is described: only the first thousandth of the strip conducts at once, and a smaller R_c shows
/// in times below a millionth of that in which the strip charges. Chosen; 900 readings that led beyond took over ten minutes,
/// for such a response has ten thousands of modes, and take seconds with it.
pub(super) const MOST_REACH: f64 = 1e6;
/// The same at which the direction of a resistance is taken where less was found. Chosen.
pub(super) const LEAST_REACH_ASKED: f64 = 0.01;
/// Half width of the box around a start, in logarithms: a factor of about nine million. Chosen.
pub(super) const HALF_BOX_LOG: f64 = 16.0;

/// Half waves over the record that errors which all times share are looked at in, the constant counted. Chosen.
pub(super) const WAVES: usize = 6;
/// Fewest places of which common errors are told from noise. Chosen.
pub(super) const FEWEST_FOR_COMMON: usize = 5;
/// Fewest times of which they are. Chosen.
pub(super) const FEWEST_TIMES: usize = 4 * WAVES;
/// Fewest independent amplitudes, beyond what the fit has taken, from which their size is known. Chosen.
pub(super) const LEAST_FREEDOM: f64 = 3.0;
/// Fewest places of a group that are left out by blocks, and of blocks. Chosen.
pub(super) const FEWEST_BLOCKS: usize = 5;
/// Most blocks of places that are left out in turn. Chosen.
pub(super) const MOST_BLOCKS: usize = 8;
/// The noise's size is taken for one over the record over so many to either side. Chosen.
pub(super) const SIZE_PARTS: usize = 24;
/// Fewest readings to either side over which it is. Chosen.
pub(super) const FEWEST_FOR_SIZE: usize = 8;
/// No stretch is quieter than this, in variances of all. Chosen.
pub(super) const LEAST_SIZE: f64 = 0.01;
