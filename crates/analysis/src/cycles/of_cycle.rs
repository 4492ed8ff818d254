//! What the numbers of every cycle are made with.

use ieap_domain::Estimate;
use ieap_numerics::robust::sd_on_a_slope;

use crate::levels::symmetric;

/// Readings of a channel with the standard deviation of their noise.
pub(super) struct Readings<'a> {
    pub time_s: &'a [f64],
    pub values: &'a [f64],
    pub noise: f64,
}

impl<'a> Readings<'a> {
    /// The noise is that of second differences: short cycles leave no room for anything smoother.
    pub fn of(time_s: &'a [f64], values: &'a [f64]) -> Readings<'a> {
        Readings {
            time_s,
            values,
            noise: sd_on_a_slope(values),
        }
    }

    pub fn range(&self, from_s: f64, to_s: f64) -> std::ops::Range<usize> {
        let at = |t: f64| self.time_s.partition_point(|own| *own < t);
        at(from_s)..at(to_s).max(at(from_s))
    }
}

/// The numbers of a cycle, in the order of [`super::CYCLE_FIGURES`].
pub(super) type Numbers = [Estimate; 7];

pub(super) fn missing(why: &str) -> Estimate {
    Estimate::not_determined(why)
}

pub(super) const NO_CURRENT: &str = "the cycle has no readings of the current";
pub(super) const NO_BENDING: &str = "the cycle has no readings of the bending";
pub(super) const NOTHING_FLOWED: &str = "nothing flowed";

/// A ratio of independent numbers, its error to first order.
pub(super) fn ratio((a, a_error): (f64, f64), (b, b_error): (f64, f64), scale: f64) -> Estimate {
    if b == 0.0 {
        return missing(NOTHING_FLOWED);
    }
    let value = a / b;
    symmetric(scale * value, scale * (a_error / b).hypot(value * b_error / b))
}
