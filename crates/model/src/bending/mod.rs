//! How the stored charge bends the strip: the thesis's law and its rivals, on one circuit and in one form, so that a
//! fit can hold them against each other.
//!
//! A law is linear in its couplings: the curvature is the sum of each coupling times a course that follows from the
//! charge and from the law's shapes (rates, ratios). The charge comes from the equivalent circuit of the thesis; none
//! of the rivals has an electrical part of its own. A law is one file here and one row in `LAWS`.

mod back_relaxation;
mod bao_two_way;
mod charge;
mod kelvin_voigt;
mod maxwell;
mod standard_linear_solid;
#[cfg(test)]
mod tests;
mod yagasaki_tamagawa;

use std::panic::RefUnwindSafe;

use ieap_domain::Drive;

pub use charge::ChargeCourse;

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
    let courses = law.courses(charge, shapes);
    let mut sum = vec![0.0; charge.len()];
    for (coupling, course) in couplings.iter().zip(&courses) {
        for (out, value) in sum.iter_mut().zip(course) {
            *out += coupling * value;
        }
    }
    sum
}

static LAWS: [(&str, &dyn BendingLaw); 5] = [
    ("yagasaki-tamagawa", &yagasaki_tamagawa::YagasakiTamagawa),
    ("bao-two-way", &bao_two_way::BaoTwoWay),
    ("kelvin-voigt", &kelvin_voigt::KelvinVoigt),
    ("maxwell", &maxwell::Maxwell),
    (
        "standard-linear-solid",
        &standard_linear_solid::StandardLinearSolid,
    ),
];

/// The rival law behind the fit model of that id; none for lumped and distributed models.
pub fn rival_law(model: &str) -> Option<&'static dyn BendingLaw> {
    LAWS.iter().find(|(id, _)| *id == model).map(|(_, law)| *law)
}

/// The law behind the fit model of that id: a rival's own, and the thesis's for lumped models.
pub fn bending_law(model: &str) -> Option<&'static dyn BendingLaw> {
    match model.starts_with("lumped") {
        true => Some(&back_relaxation::BackRelaxation),
        false => rival_law(model),
    }
}
