//! What decides in monitoring: every number with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted by itself. What all of them together tell of simulated series,
//! `IEAP_LONG=1 cargo test -p ieap-analysis --lib monitoring -- --include-ignored --nocapture` counts
//! (docs/validation/monitoring.md).

/// Runs of one sample in one condition from which it is a reference. Chosen.
pub const FEWEST_RUNS: usize = 4;
/// Temperatures this near each other are the same, K. Chosen.
pub const TEMPERATURE_TOLERANCE_C: f64 = 2.0;

/// A step between neighbours beyond this many times the usual scatter of steps is a jump. The largest of 10,000 steps
/// of normal noise is below 4.5. With it the recoveries of two batteries are no jumps, and the three places at which an
/// actuator's sensor was zeroed again are (`cargo test --test it ageing_data -- --include-ignored`).
pub const JUMP_SIGMAS: f64 = 8.0;
/// Readings on either side whose medians must differ as well. Chosen.
pub const JUMP_SIDE: usize = 10;
/// Part of a step that must stay: what returns within as many readings is no jump but a disturbance. Chosen.
pub const STAYS: f64 = 0.7;
/// Readings from which the usual scatter of steps is known. Chosen.
pub const FEWEST_FOR_JUMPS: usize = 12;

/// A trend, or a step, that chance brings more often than this is none: there are several parameters of every sample. Of 400
/// series with nothing 5 are told something without memory of the scatter, 10 at a lag-1 correlation of 0.3.
pub const SHOWN_BELOW: f64 = 0.01;
/// Readings from which a trend is asked for. Chosen.
pub const FEWEST_FOR_TREND: usize = 5;
/// Readings from which a step is asked for, and the memory of the scatter is known. Chosen.
pub const FEWEST_FOR_STEP: usize = 10;
/// Places at most at which a step is looked for, and a trend drawn from. Chosen; the series that are counted have 60
/// runs, so that it does not act in them.
pub const MOST_PLACES: usize = 60;
/// How far beyond the readings a trend may be followed to a limit, in lengths of what was measured. Chosen.
pub const FOLLOWED: f64 = 1.0;
/// Steps by chance at most that the level of a series may take where its seasons are told: more cost time and tell no more.
/// Chosen.
pub const MOST_LEVELS: usize = 24;

/// Draws at most for a chance: none is told below one in a thousand by drawing, a convention of permutation tests.
pub const DRAWS: usize = 999;
/// Draws as strong as the readings after which the p-value is known well enough (Besag and Clifford 1991): to a tenth of itself.
pub const ENOUGH: usize = 100;
/// Below this many draws as strong, which know the p-value to a third of itself, the tail is taken from the F distribution.
pub const RESOLVED: usize = 10;
/// Fewer orders than this are no distribution to draw from. Chosen; it is twice [`DRAWS`].
pub const FEWEST_ORDERS: f64 = 2000.0;

/// Laws whose criterion (BIC) is within this of the best are as good: evidence "not worth more than a bare mention" (Kass and
/// Raftery 1995).
pub const AS_GOOD: f64 = 2.0;
/// Numbers that a step pays for: its size, and its place twice (Zhang and Siegmund 2007).
pub const STEP_PAID: usize = 3;
/// Levels or readings on either side of a step or a jump, at least: fewer are readings that stray. Of 100 pure steps 99 are
/// told with it, of 400 series with nothing 5 (docs/validation/monitoring.md).
pub const STEP_SIDE: usize = 3;
/// Largest size of a law that is looked at, a logarithm: a factor of about 160,000. Chosen.
pub const LARGEST: f64 = 12.0;
