//! Charge that leaks through R_ss bends the strip too.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct LeakCoupling;

static ABOUT: About = About {
    id: "leak-coupling",
    code: "K4",
    summary: "leak charge bends too (no free strength)",
    equation: "x' = q' + g u/R_ss, x the charge that bends",
    variants: &[],
    parameters: &[EffectParameter {
        key: "coupled_fraction",
        symbol: "g",
        unit: "",
        meaning: "1 where the leak bends, 0 where it does not",
    }],
    vanishes: "g = 0",
    signature: "a plateau alpha u/(R_ss lambda) that takes 1/lambda to come",
    twins: &["partial-relaxation", "counter-flow", "moisture-bending"],
    separated_by: "R_ss, lambda and C predict its size: nothing is free; humidity or voltage change the leak",
    sources: "a choice that every model of this kind makes",
};

impl Equation for LeakCoupling {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if !scale.base.steady_state_resistance_ohm_cm2.is_finite() {
            return Search::none();
        }
        Search::over(1.0, vec![Limits::held()], &[])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.steady_bends += parameters[0];
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn plateau_is_what_leaks_within_one_relaxation() {
        let found = respond(
            &[("leak-coupling", 0, &[1.0])],
            &[(0.0, Some(2.0))],
            &[],
            &[3000.0],
        );
        let plateau = 1.2 * 0.1 * 2.0 / 300.0 / 0.012;
        assert!((found.curvature_per_cm[0] / plateau - 1.0).abs() < 1e-6);
    }
}
