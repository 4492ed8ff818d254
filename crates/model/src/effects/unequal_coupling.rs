//! Branches whose charge bends the strip unequally.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct UnequalCoupling;

static ABOUT: About = About {
    id: "unequal-coupling",
    code: "K1",
    summary: "the branches bend the strip with different alpha",
    equation: "kappa = HP_lambda(alpha q_1 + alpha (1 + r) q_2)",
    variants: &[],
    parameters: &[EffectParameter {
        key: "ratio_change",
        symbol: "r",
        unit: "",
        meaning: "how much more the charge of branch 2 bends",
    }],
    vanishes: "r = 0",
    signature: "a misfit of the bending at the time constants of branches that fit the current perfectly",
    twins: &["self-discharge", "precurvature", "coupling-saturation"],
    separated_by: "an open circuit; a fast camera at the edge",
    sources: "ions of unlike size in pores of unlike size",
};

impl Equation for UnequalCoupling {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.base.branches.len() < 2 {
            return Search::none();
        }
        Search::over(0.02, vec![Limits::linear(-1.0, 2.0)], &[])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        for branch in system.branches.iter_mut().filter(|b| b.of_base == Some(1)) {
            branch.bends *= 1.0 + parameters[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;
    use crate::extended::tests::{base, drive};

    #[test]
    fn without_the_second_branch_only_the_first_bends() {
        let (levels, times) = ([(0.0, Some(2.0)), (30.0, Some(0.0))], [1.0, 20.0, 60.0]);
        let found = respond(&[("unequal-coupling", 0, &[-1.0])], &levels, &[], &times);
        let mut first = base();
        first.branches.truncate(1);
        let expected = first.curvature_per_cm(&drive(&levels), 0.1, &times);
        for (a, b) in found.curvature_per_cm.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-12);
        }
    }
}
