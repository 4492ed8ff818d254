//! What every law of bending answers.

use std::panic::RefUnwindSafe;

use ieap_domain::Drive;
use ieap_numerics::sums::combined;

use super::charge::ChargeCourse;

/// What a law is, for people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LawText {
    /// Governing equation, in plain signs.
    pub equation: &'static str,
    /// What drives the bending.
    pub driven_by: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// What it cannot describe.
    pub limits: &'static str,
}

/// A parameter in which a law is not linear, with the range that it may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A rate, 1/s: from none to far above what the sampling shows.
    Rate,
    /// A part, from 0 to 1.
    Part,
    /// A ratio from 0 upwards.
    Excess,
}

/// How an interval of a reported number is stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stated {
    /// A coupling that must be told from zero, else it is open.
    Coupling,
    /// A number that may be zero or negative.
    Signed,
    /// A number that cannot be negative: below a bound where it cannot be told from zero.
    FromZero,
    /// The time that is one over the computed rate: above a bound where the rate cannot be told from zero.
    Time,
}

/// A number that a law reports.
#[derive(Clone, Copy)]
pub struct Reported {
    /// Stored key.
    pub key: &'static str,
    /// How its interval is stated.
    pub stated: Stated,
    /// The number (for times: the rate) from the law's couplings, 1/(C cm), followed by its shapes.
    pub of: fn(&[f64]) -> f64,
}

/// How charge becomes curvature.
pub trait BendingLaw: Sync + RefUnwindSafe {
    /// What it is.
    fn about(&self) -> LawText;

    /// Number of couplings.
    fn couplings(&self) -> usize {
        1
    }

    /// The parameters in which it is not linear.
    fn shapes(&self) -> &'static [Shape];

    /// Curvature per coupling, C (1/cm over 1/(C cm)), at the times of `charge`: one course for each coupling.
    fn courses(&self, charge: &ChargeCourse, shapes: &[f64]) -> Vec<Vec<f64>>;

    /// What a fit reports, derived numbers last.
    fn reported(&self) -> &'static [Reported];

    /// The couplings, followed by the shapes, of which the first that [`BendingLaw::reported`] lists have these values: as
    /// many as there are couplings and shapes.
    fn natural(&self, reported: &[f64]) -> Vec<f64> {
        let of = |(own, value): (&Reported, &f64)| match own.stated {
            Stated::Time => value.recip(),
            _ => *value,
        };
        self.reported().iter().zip(reported).map(of).collect()
    }

    /// Why it does not describe runs under `drive`; none where it does.
    fn refuses(&self, _drive: &Drive) -> Option<&'static str> {
        None
    }

    /// Whether the shapes mean nothing at this place, because what they shape is not there.
    fn is_idle(&self, _shapes: &[f64]) -> bool {
        false
    }
}

/// Curvature at each time, 1/cm, with the shape before the drive subtracted.
pub fn curvature_per_cm(
    law: &dyn BendingLaw,
    charge: &ChargeCourse,
    couplings: &[f64],
    shapes: &[f64],
) -> Vec<f64> {
    combined(&law.courses(charge, shapes), couplings)
}
