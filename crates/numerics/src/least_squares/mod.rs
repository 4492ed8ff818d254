//! Least squares in a box: what a problem tells of a place, and the one search that lowers its sum of squares.
//!
//! Whoever fits anything says what the residuals and their derivatives are at some coordinates ([`Problem`]), and has
//! them searched by [`Levenberg`], or by another of the methods of [`global`](super::global).

mod bounds;
mod levenberg;
mod local;
mod step;

pub use bounds::Bounds;
pub use levenberg::{Levenberg, Settle};
pub use local::Local;
pub use step::Damping;

/// Residuals and their derivatives over coordinates in a box.
pub trait Problem {
    /// Limits of the coordinates, which are scaled so that a step of 1 is large (logarithms of positive parameters are).
    fn bounds(&self) -> Bounds;

    /// Sum of squares with its local model. A place whose sum of squares is above `most` is of no use: derivatives there
    /// may be left out ([`Local::refused`]).
    fn local(&self, at: &[f64], most: f64) -> Local;
}

/// Why a search stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// A further step would lower the sum of squares by less than what was asked for, or hardly move.
    Converged,
    /// No damped step lowers the sum of squares any more: rounding has been reached.
    NoDescent,
    /// The limit of evaluations was reached first.
    EvaluationLimit,
    /// The sum of squares was no finite number.
    NotFinite,
}

impl Stop {
    /// Whether the place found is a minimum.
    pub fn converged(self) -> bool {
        matches!(self, Stop::Converged | Stop::NoDescent)
    }

    /// The reason in words.
    pub fn words(self) -> &'static str {
        match self {
            Stop::Converged => "a further step would not lower the sum of squares noticeably",
            Stop::NoDescent => "no step lowers the sum of squares any more",
            Stop::EvaluationLimit => "the limit of evaluations was reached",
            Stop::NotFinite => "the sum of squares is no finite number",
        }
    }
}

/// Where a search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The place.
    pub at: Vec<f64>,
    /// The local model there.
    pub local: Local,
    /// Evaluations that it took.
    pub evaluations: u64,
    /// Why it stopped.
    pub stop: Stop,
}

impl Minimum {
    /// The lowest of these whose sum of squares is a number, the first of equals.
    pub fn lowest(searches: impl Iterator<Item = Minimum>) -> Option<Minimum> {
        searches
            .filter(|found| found.local.square.is_finite())
            .min_by(|a, b| a.local.square.total_cmp(&b.local.square))
    }
}
