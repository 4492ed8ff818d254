//! What every method of search answers, and what it searches.

use std::fmt::Debug;
use std::panic::RefUnwindSafe;

use crate::least_squares::{Minimum, Problem};

/// A problem whose whole box is looked over: the sum of squares of its local model may come from products, which round
/// by the size.
pub trait Landscape: Problem {
    /// Sum of squares at a place within the limits, taken from the residuals.
    fn square(&self, at: &[f64]) -> f64;

    /// Places that a coarse look finds promising, the best first.
    fn starts(&self) -> Vec<Vec<f64>>;

    /// Sum of squares of the measured values: what rounding is measured by.
    fn size(&self) -> f64;
}

/// How far a search goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Part of the sum of squares by which a further step must lower it to be worth while.
    pub settle: f64,
    /// Seed of everything random in the search.
    pub seed: u64,
}

/// A way to find the least sum of squares. The same landscape, effort and seed give the same place.
pub trait Method: Debug + Sync + RefUnwindSafe {
    /// Stored id, `differential-evolution`.
    fn id(&self) -> &'static str;

    /// The method's name in running text.
    fn name(&self) -> &'static str;

    /// What it does, in one line.
    fn description(&self) -> &'static str;

    /// Whether the seed matters.
    fn is_random(&self) -> bool;

    /// Searches the box.
    fn minimise(&self, landscape: &dyn Landscape, effort: Effort) -> Minimum;
}
