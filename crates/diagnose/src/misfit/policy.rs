//! What decides about a misfit: every number with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted by itself. What all of them together see where something is hidden,
//! and call wrong where nothing is, `cargo run --release --example hide_and_seek -- laws 4 4 own` and `-- null 40` count
//! (docs/validation/diagnose.md).

/// Part of the degrees of freedom of the noise's size that is believed: its memory was found from the same readings, and
/// an error in it moves slow residuals more than the size alone says. When it was set 5.0 % of 500 clean groups had p < 0.05.
pub(super) const NOISE_KNOWN_PART: f64 = 0.5;
/// Weights of the statistics in the smallest p: all candidates, the best of them, single bins, all of them, answers to
/// edges, and lines. Chosen.
pub(super) const WEIGHTS: [f64; 6] = [0.70, 0.05, 0.05, 0.10, 0.05, 0.05];
/// Draws below an observed p from which their count gives its own. Chosen.
pub(super) const RESOLVED_DRAWS: usize = 10;
/// Part of the draws from which the tail goes on. Chosen.
pub(super) const TAIL_PART: f64 = 0.05;
/// Length that a bin keeps, of one, where the base is refitted; of which less is left is not asked. Chosen.
pub(super) const LEAST_OF_BIN: f64 = 0.05;

/// Groups that are drawn to calibrate a p. Chosen.
pub(super) const CALIBRATION_DRAWS: usize = 100;
/// Groups that are drawn at least, however long they take. Chosen.
pub(super) const FEWEST_CALIBRATION_DRAWS: usize = 30;
/// Products of rows and candidates that a calibration may cost before fewer groups are drawn. Chosen.
pub(super) const CALIBRATION_PRODUCTS: f64 = 4e8;
/// A p below this is small whatever a calibration says. Chosen.
pub(super) const SMALL_IN_ANY_CASE: f64 = 1e-7;

/// Bins of the clock per run. Chosen.
pub(super) const BINS_BY_CLOCK: usize = 8;
/// Bins of the time since an edge, per level of the drive. Chosen.
pub(super) const BINS_BY_PHASE: usize = 4;
/// Readings that a bin needs. Chosen.
pub(super) const FEWEST_OF_BIN: usize = 4;
/// Voltages this near each other are one level of the drive, V. Chosen.
pub(super) const SAME_LEVEL_V: f64 = 0.01;
/// A run with so many edges of its drive is asked whether it answers all of them alike. Chosen. Of 12 resistances that swing 8
/// passed for right before it was asked, and 9 are called wrong since.
pub(super) const FEWEST_EDGES: usize = 4;
/// Answers to edges at most; of more edges neighbours are taken together. Chosen.
pub(super) const MOST_EDGE_RESPONSES: usize = 32;
/// A bin is said to be wrong where its mean is this many standard errors off. Chosen.
pub(super) const WRONG_BIN_SIGMAS: f64 = 4.0;

/// An effect of which less than this part is left by a refit is said to be absorbed by it. Chosen.
pub(crate) const ABSORBED: f64 = 1e-3;
/// Prior variance of a direction's length over one more than itself: lengths of about four standard deviations. Chosen. Of 253
/// effects of that size 197 were seen with it, 173 before all effects were asked together.
pub(super) const SHRUNK: f64 = 16.0 / 17.0;
/// Size of a misfit, in standard deviations of the noise after the refit, that is seen in 95 of 100 groups whose error is smooth
/// in the logarithm of time. `cargo run --release --example hide_and_seek -- visible 100` counts it.
pub(super) const SEEN_SIGMAS: f64 = 14.0;

/// Runs from which on one may be odd: two that differ do not say which.
pub(super) const FEWEST_FOR_ODD: usize = 3;
/// Runs agree whose readings are those that one of them predicts times a number within this factor of one. Chosen: strips of
/// the thesis conduct four times better at 2.5 V than at 1.2 V.
pub(super) const ALIKE_FACTOR: f64 = 6.0;
/// Likeness of shape (a cosine) from which runs agree, and from which one is judged at all: a leak is flat where a strip that is
/// charged is not. Chosen.
pub(super) const SAME_SHAPE: f64 = 0.8;
/// Departure from a power of ten, in decades, that is allowed for 10 and 100: 12 %. Chosen.
pub(super) const OFF_LENGTHS_DECADES: f64 = 0.05;
/// The same for prefixes of units, a factor of two. Chosen: they are taken for each other most often and lie so far apart that
/// runs at other voltages may differ beside it.
pub(super) const OFF_PREFIXES_DECADES: f64 = 0.3;
/// Largest power of ten between units of the same quantity that are mistaken for each other: nA and A.
pub(super) const MOST_DECADES: f64 = 9.0;
