//! A strip that was not discharged before the run.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct ResidualCharge;

static ABOUT: About = About {
    id: "residual-charge",
    code: "E16",
    summary: "the strip was not discharged before the run",
    equation: "e_k(0) = baseline + f V, V the voltage of the first segment",
    variants: &["branch-2", "both"],
    parameters: &[EffectParameter {
        key: "residual_fraction",
        symbol: "f",
        unit: "",
        meaning: "part of the first voltage that was left",
    }],
    vanishes: "f = 0",
    signature: "a smaller first peak, which depends on the run before and on the rest between",
    twins: &["unequal-coupling", "current-offset"],
    separated_by: "the open-circuit voltage before the run; rests of several lengths",
    sources: "discharge of porous electrodes over many time constants",
};

impl Equation for ResidualCharge {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        if variant == 1 && scale.base.branches.len() < 2 {
            return Search::none();
        }
        Search::over(0.01, vec![Limits::linear(-0.5, 0.5)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let residual_v = parameters[0] * run.first_voltage_v();
        let slowest = system.slowest_of_base();
        for branch in &mut system.branches {
            if branch.of_base.is_some() && (variant == 1 || branch.of_base == slowest) {
                branch.residual_v += residual_v;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn first_current_is_smaller_by_what_was_left() {
        let found = respond(
            &[("residual-charge", 1, &[0.25])],
            &[(0.0, Some(2.0))],
            &[0.0],
            &[],
        );
        let expected = 0.1 * 2.0 * (0.75 * (1.0 / 3.0 + 1.0 / 15.0) + 1.0 / 300.0);
        assert!((found.current_a[0] / expected - 1.0).abs() < 1e-12);
    }
}
