//! What decides in charges of levels: every number with its unit and where it comes from.
//!
//! `cargo run --release -p ieap-analysis --example edges_grid` counts what all of them together give.

/// Fewest readings from which the beginning of a level is told: one more than a line beside an exponential has terms.
pub const FEWEST_TO_BEGIN: usize = 4;
/// Readings that tell of it: a straight line follows all but its fastest relaxation over so few. Chosen.
pub const READINGS_TO_BEGIN: usize = 8;
/// ... more where they reach less far than this many times the stretch in which the edge lies, but no more than [`MOST_TO_BEGIN`].
pub const STRETCHES_TO_BEGIN: f64 = 4.0;
/// See [`STRETCHES_TO_BEGIN`].
pub const MOST_TO_BEGIN: usize = 64;
/// Readings that tell how the current goes on to the end of a level. Chosen.
pub const READINGS_TO_END: usize = 4;
/// Shortest time constant that is looked for, in distances of the first two readings: a faster one leaves e^-20 of itself.
pub const SHORTEST: f64 = 0.05;
/// Trial time constants, and trial places of an edge in the stretch in which it lies.
pub const TRIALS: usize = 24;
/// See [`TRIALS`].
pub const PLACES: usize = 7;
/// Most that the current at the edge exceeds what the first reading shows of its step. Chosen: resistances of branches differ by
/// less than that in what the thesis measures (table 5).
pub const MOST_UNSEEN: f64 = 10.0;
/// Chance of no relaxation in the first readings below which one counts as seen, and so as the fastest. Chosen.
pub const SEEN: f64 = 1e-3;
/// Most of its time constant, in the stretch in which the edge may lie before the first reading. Chosen.
pub const FASTER: f64 = 2.0;
/// Standard deviation of the logarithm of its time constant below which that is known. Chosen.
pub const RESOLVED: f64 = 0.25;
/// Standard errors by which the current of the halves of a level differs where a relaxation is seen in it at all. Chosen.
pub const TOLD: f64 = 5.0;
/// Part of the correction of trapezia for the curvature between readings that may be wrong. Chosen.
pub const OF_CORRECTION: f64 = 0.3;
/// Levels at most whose beginnings are few among the windows from which the noise is had: those of a fifth are left out there.
pub const FEW_LEVELS: usize = 4;
