//! What decides in the analysis of a modulus log: every number with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted by itself. What all of them together give,
//! `IEAP_LONG=1 cargo test --lib stated_intervals -- --include-ignored --nocapture` counts over 300 logs, and
//! docs/validation/dma.md says which steps are found in humidities with and without any.

/// Humidities closer than this, percent, are one level, and a smaller change is no step: twice the accuracy of the common
/// capacitive sensors (2 %).
pub const SAME_HUMIDITY_PERCENT: f64 = 4.0;
/// A step must also exceed the noise of the humidity by this factor. Chosen; no step is found in 2100 flat humidities.
pub const STEP_TO_NOISE: f64 = 4.0;
/// Noise of a humidity below this is taken as this, percent: the last digit of the common loggers.
pub const LEAST_NOISE_PERCENT: f64 = 0.05;
/// Price of a cut in units of the long-run variance and the logarithm of the number of points. Chosen; no step is found in
/// 2100 flat humidities, and steps of 8 % and more are found.
pub const CUT_PRICE: f64 = 6.0;
/// Fewest points of a level: a shorter excursion, as by a door that is opened, is none. Chosen.
pub const FEWEST_POINTS_OF_LEVEL: usize = 4;
/// A level on the way from one to another that lasts less than this part of the longer of the two is passage. Chosen.
pub const PASSAGE: f64 = 0.2;
/// A stretch whose thirds differ by more than this part of its smaller step is no level. Chosen.
pub const DRIFT: f64 = 0.25;
/// A change that takes longer than this part of the longer of its levels is no step. Chosen.
pub const LONGEST_CHANGE: f64 = 0.5;
/// Part of the step within which the humidity counts as still at, or already at, a level. Chosen.
pub const AT_LEVEL: f64 = 0.05;

/// Most points of a humidity that are cut into levels, and of a relaxation that are fitted: longer ones are taken in as many
/// blocks. Chosen.
pub const MOST_POINTS: usize = 400;

/// Fewest readings that give a level with an uncertainty. Chosen.
pub const FEWEST_FOR_LEVEL: usize = 12;
/// Part of a stretch, from its end, that gives the level where readings are enough. Chosen.
pub const LEVEL_WINDOW: f64 = 0.5;
/// The change must exceed its standard error by this factor before a part of it can be stated. Chosen.
pub const CLEAR: f64 = 5.0;

/// Fewest readings after the humidity has settled that a relaxation is fitted to. Chosen.
pub const FEWEST_FOR_RELAXATION: usize = 20;
/// Part of the change that may be left when equilibrium counts as reached. Chosen; the page states it.
pub const REMAINDER: f64 = 0.05;
/// Longest time constant looked for, in lengths of the stretch: a slower one cannot be told from a drift. Chosen.
pub const LONGEST_TIME_CONSTANT: f64 = 10.0;
/// Time constants closer than this factor cannot be told apart. Chosen.
pub const APART: f64 = 2.0;
/// A second exponential must lower the sum of squares by this many long-run variances. Chosen.
pub const SECOND_GAIN: f64 = 12.0;

/// Relative difference between what the instrument gives and what follows from its other columns, from which it
/// is pointed out: printed digits stay far below. Chosen.
pub const DISAGREEMENT: f64 = 0.01;
/// Frequencies within this part of each other are one. Chosen.
pub const SAME_FREQUENCY: f64 = 0.01;
/// Share of the readings that one frequency must have for a log not to be a sweep. Chosen.
pub const FREQUENCY_SHARE: f64 = 0.2;
/// Fewest readings of that frequency. Chosen.
pub const FEWEST_OF_FREQUENCY: usize = 16;
