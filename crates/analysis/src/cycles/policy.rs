//! What decides in a train of cycles: every number with its unit and where it comes from.
//!
//! Where a number is "chosen", its effect was not counted by itself; `cargo unit -p ieap-analysis cycles::` counts how often
//! the intervals of 20 simulated trains hold.

/// Fewest cycles of a train. Chosen.
pub const FEWEST_CYCLES: usize = 3;
/// Most levels of a cycle. Chosen.
pub const MOST_LEVELS: usize = 12;
/// Share of the voltage's range, and of a duration, within which two levels are the same. Chosen.
pub const SAME: f64 = 0.05;
/// Share of the levels that must come again: a train may begin with others, or pause. Chosen.
pub const MOSTLY: f64 = 0.9;

/// Share of a level at its end over which the curvature is averaged. Chosen.
pub const END: f64 = 0.25;
/// Share of the range by which the voltage changes at an edge that tells of the resistance. Chosen.
pub const EDGE: f64 = 0.05;
/// Fewest readings of a period, or of a cycle whose curvature is held against its charge. Chosen.
pub const LEAST_IN_PERIOD: usize = 12;

/// Points of a trend at most: means of as many cycles each. Chosen.
pub const MOST_POINTS: usize = 150;
/// Part of its beginning to which a number has fallen where a life test is over: a convention for batteries.
pub const END_OF_LIFE: f64 = 0.8;

/// Part of a slope that the noise of what it is on may take away; more is not put right. Chosen.
pub const BLURRED: f64 = 0.2;
/// Standard error of a ratio, in parts of it, from which it is not stated. Chosen.
pub const TOO_WIDE: f64 = 0.25;
/// Chi-square of a relaxation above which it shows: chance exceeds that of one degree of freedom once in 10^4.
pub const MOST_SHOWN: f64 = 15.1;
