//! The slow branch loses its charge inside.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{BranchLaw, RunContext, System};

/// See the module.
pub(super) struct SelfDischarge;

static ABOUT: About = About {
    id: "self-discharge",
    code: "E10",
    summary: "a branch loses its charge internally",
    equation: "q_2' = (u - e_2)/R_2 - g e_2",
    variants: &[],
    parameters: &[EffectParameter {
        key: "internal_conductance_s_per_cm2",
        symbol: "g",
        unit: "S/cm2",
        meaning: "conductance across the capacitor of branch 2",
    }],
    vanishes: "g = 0",
    signature: "a lower plateau of charge, and a decay of the voltage while the circuit is open",
    twins: &["unequal-coupling", "precurvature", "coupling-saturation"],
    separated_by: "an open circuit after the step",
    sources: "self-discharge of porous supercapacitors",
};

impl Equation for SelfDischarge {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let Some(slowest) = scale.base.branches.last() else {
            return Search::none();
        };
        // The plateau falls to a third. The base model alone takes a strong leak for a larger resistance: what is twice
        // as large as a strip could bear by its own is within the limit.
        let most = 2.0 / slowest.resistance_ohm_cm2;
        Search::over(0.0025 * most, vec![Limits::linear(0.0, most)], &[])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let Some(slowest) = system.slowest_of_base() else {
            return;
        };
        let of_slowest = |b: &&mut BranchLaw| b.of_base == Some(slowest);
        let shares = system.branches.iter().filter(|b| b.of_base == Some(slowest));
        let total: f64 = shares.map(|b| b.capacitance_f_per_cm2).sum();
        for branch in system.branches.iter_mut().filter(of_slowest) {
            branch.internal_conductance_s_per_cm2 += parameters[0] * branch.capacitance_f_per_cm2 / total;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn steady_current_flows_through_the_branch() {
        let g = 0.002;
        let found = respond(&[("self-discharge", 0, &[g])], &[(0.0, Some(2.0))], &[500.0], &[]);
        let expected = 0.1 * 2.0 * (1.0 / 300.0 + g / (1.0 + 15.0 * g));
        assert!((found.current_a[0] / expected - 1.0).abs() < 1e-9);
    }
}
