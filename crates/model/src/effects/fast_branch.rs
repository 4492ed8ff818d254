//! A third, faster R-C branch.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{BranchLaw, RunContext, System};

/// See the module.
pub(super) struct FastBranch;

static ABOUT: About = About {
    id: "fast-branch",
    code: "E3",
    summary: "a third R-C branch, faster; its charge bends the strip",
    equation: "q_3' = (v - q_3/C_3)/R_3, with tau_3 = R_3 C_3 below the others",
    variants: &[],
    parameters: &[
        EffectParameter {
            key: "fast_capacitance_f_per_cm2",
            symbol: "C_3",
            unit: "F/cm2",
            meaning: "capacitance of the fast branch",
        },
        EffectParameter {
            key: "fast_time_constant_s",
            symbol: "tau_3",
            unit: "s",
            meaning: "its time constant",
        },
    ],
    vanishes: "C_3 = 0",
    signature: "a spike of current in the first readings after every edge",
    twins: &["source-rise", "camera-delay", "current-limit"],
    separated_by: "readings at least twenty times per tau_3 after an edge",
    sources: "equivalent circuits with n branches, thesis figure 7",
};

impl Equation for FastBranch {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let (fastest_s, _) = scale.time_constants_s();
        let (low_s, high_s) = (0.2 * scale.shortest_s, 0.8 * fastest_s);
        let Some(first) = scale.base.branches.first() else {
            return Search::none();
        };
        if low_s >= high_s {
            return Search::none();
        }
        let most = 2.0 * first.capacitance_f_per_cm2;
        let limits = vec![Limits::linear(0.0, most), Limits::logarithmic(low_s, high_s)];
        let shapes = super::search::spread(1.5 * low_s, (high_s / 1.5).max(1.6 * low_s), 3);
        Search::over(0.005 * most, limits, &[shapes])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        if parameters[0] > 0.0 {
            system
                .branches
                .push(BranchLaw::added(parameters[0], parameters[1]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn current_has_a_spike_of_its_own() {
        let t = 0.02_f64;
        let levels = [(0.0, Some(2.0))];
        let with = respond(&[("fast-branch", 0, &[0.01, 0.05])], &levels, &[t], &[t]);
        let without = respond(&[], &levels, &[t], &[t]);
        let spike = 0.1 * 2.0 * 0.01 / 0.05 * (-t / 0.05).exp();
        assert!((with.current_a[0] - without.current_a[0] - spike).abs() < 1e-12);
    }
}
