//! A camera whose zero is not the straight strip.

use super::acting::read_as;
use super::{About, EffectParameter, Equation, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct CameraZero;

static ABOUT: About = About {
    id: "camera-zero",
    code: "G1",
    summary: "constant added to curvature",
    equation: "kappa -> kappa + k_0",
    variants: &[],
    parameters: &[EffectParameter {
        key: "offset_per_cm",
        symbol: "k_0",
        unit: "1/cm",
        meaning: "curvature at rest",
    }],
    vanishes: "k_0 = 0",
    signature: "a constant before and after the drive",
    twins: &["precurvature", "moisture-bending", "unequal-coupling"],
    separated_by: "pictures before the drive",
    sources: "frame of the picture turned against the clamp",
};

impl Equation for CameraZero {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        Search::of_offset(scale)
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let offset = parameters[0];
        system.observations.push(read_as(move |_, kappa| kappa + offset));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn it_is_there_before_the_drive() {
        let found = respond(&[("camera-zero", 0, &[0.03])], &[(10.0, Some(2.0))], &[], &[2.0]);
        assert!((found.curvature_per_cm[0] - 0.03).abs() < 1e-15);
    }
}
