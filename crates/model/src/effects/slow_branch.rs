//! A third, slower R-C branch: slow pores, or charge that is redistributed between them.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{BranchLaw, RunContext, System};

/// See the module.
pub(super) struct SlowBranch;

static ABOUT: About = About {
    id: "slow-branch",
    code: "E2",
    summary: "a third R-C branch, slower; its charge bends the strip",
    equation: "q_3' = (v - q_3/C_3)/R_3, with tau_3 = R_3 C_3 above the others",
    variants: &[],
    parameters: &[
        EffectParameter {
            key: "slow_capacitance_f_per_cm2",
            symbol: "C_3",
            unit: "F/cm2",
            meaning: "capacitance of the slow branch",
        },
        EffectParameter {
            key: "slow_time_constant_s",
            symbol: "tau_3",
            unit: "s",
            meaning: "its time constant",
        },
    ],
    vanishes: "C_3 = 0",
    signature: "a slow positive tail of the current that comes back on discharge, with a slow rise of the bending",
    twins: &[
        "diffusion-limited-leak",
        "second-relaxation",
        "warburg",
        "fractional-relaxation",
    ],
    separated_by: "a long hold followed by a discharge: the charge of a branch comes back, that of a leak does not",
    sources: "redistribution of charge in supercapacitors (Sedlakova 2013); catalogue of circuits, thesis figure 8",
};

impl Equation for SlowBranch {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let (_, slowest_s) = scale.time_constants_s();
        let longest_s = scale.longest_s();
        let low_s = (1.2 * slowest_s).min(longest_s);
        let high_s = (5.0 * longest_s).max(2.0 * low_s);
        let most = 2.0 * scale.capacitance_f_per_cm2();
        let limits = vec![Limits::linear(0.0, most), Limits::logarithmic(low_s, high_s)];
        Search::over(
            0.01 * most,
            limits,
            &[super::search::spread(1.5 * low_s, high_s / 2.0, 4)],
        )
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        if parameters[0] > 0.0 {
            system
                .branches
                .push(BranchLaw::added(parameters[0], parameters[1]));
        }
    }
}
