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
mod law;
mod maxwell;
mod standard_linear_solid;
#[cfg(test)]
mod tests;
mod yagasaki_tamagawa;

pub use charge::ChargeCourse;
pub use law::{BendingLaw, LawText, Reported, Shape, Stated, curvature_per_cm};

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
    if model.starts_with("lumped") {
        Some(&back_relaxation::BackRelaxation)
    } else {
        rival_law(model)
    }
}
