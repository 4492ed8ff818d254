//! A strip that is bent at rest, or sags.

use super::acting::read_as;
use super::{About, EffectParameter, Equation, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct Precurvature;

static ABOUT: About = About {
    id: "precurvature",
    code: "M10",
    summary: "offset, gravity",
    equation: "kappa -> kappa + kappa_0",
    variants: &[],
    parameters: &[EffectParameter {
        key: "offset_per_cm",
        symbol: "kappa_0",
        unit: "1/cm",
        meaning: "curvature at rest",
    }],
    vanishes: "kappa_0 = 0",
    signature: "an offset that changes where the stiffness changes",
    twins: &["camera-zero", "unequal-coupling", "self-discharge", "creep"],
    separated_by: "the strip turned over, or hung upright",
    sources: "sag of a cantilever under its weight",
};

impl Equation for Precurvature {
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
        let found = respond(&[("precurvature", 0, &[0.03])], &[(10.0, Some(2.0))], &[], &[2.0]);
        assert!((found.curvature_per_cm[0] - 0.03).abs() < 1e-15);
    }
}
