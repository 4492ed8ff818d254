//! What decides in monitoring: every number with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted by itself. What all of them together tell of simulated series,
//! `IEAP_LONG=1 cargo test -p ieap-analysis --lib monitoring -- --include-ignored --nocapture` counts
//! (docs/validation/monitoring.md). How many readings stand on either side of a jump or a step is that of the laws:
//! `laws::policy::STEP_SIDE`.

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
