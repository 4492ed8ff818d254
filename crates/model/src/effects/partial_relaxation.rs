//! Part of the strain does not relax: a standard linear solid in place of spring and dashpot.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RelaxationMode, RunContext, System};

/// See the module.
pub(super) struct PartialRelaxation;

static ABOUT: About = About {
    id: "partial-relaxation",
    code: "M1",
    summary: "part of the strain does not relax (standard linear solid; Bao with K2 other than 0)",
    equation: "kappa = alpha ((1 - f) HP(q) + f q), HP the relaxation of rate lambda",
    variants: &[],
    parameters: &[EffectParameter {
        key: "fraction",
        symbol: "f",
        unit: "",
        meaning: "part of the strain that stays",
    }],
    vanishes: "f = 0",
    signature: "a plateau above zero at long times, linear in the voltage",
    twins: &[
        "counter-flow",
        "leak-coupling",
        "moisture-bending",
        "second-relaxation",
        "creep",
    ],
    separated_by: "reversed polarity against drift and creep; the sign of the plateau against back-flow; the size that R_ss, lambda and C predict against the leak's coupling",
    sources: "standard linear solid; Bao et al. with K2 other than 0",
};

impl Equation for PartialRelaxation {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, _scale: &Scale) -> Search {
        Search::over(0.01, vec![Limits::linear(0.0, 1.0)], &[])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        for mode in &mut system.relaxation {
            mode.weight *= 1.0 - parameters[0];
        }
        system.relaxation.push(RelaxationMode {
            rate_per_s: 0.0,
            weight: parameters[0],
        });
    }
}
