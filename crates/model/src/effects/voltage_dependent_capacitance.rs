//! Capacitance that depends on the voltage across it, the same for both signs.

use super::acting::{instant, scale_capacitances};
use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct VoltageDependentCapacitance;

static ABOUT: About = About {
    id: "voltage-dependent-capacitance",
    code: "E6",
    class: Class::Charging,
    summary: "C = C0 (1 + a v^2)",
    equation: "dq_k/de_k = C_k (1 + a e_k^2), e_k the voltage of the capacitor",
    variants: &["all", "branch-2"],
    parameters: &[EffectParameter {
        key: "quadratic_per_v2",
        symbol: "a",
        unit: "1/V2",
        meaning: "relative change of the differential capacitance per square of the voltage",
    }],
    vanishes: "a = 0",
    signature: "time constants and charge change with the step's voltage, alike for both signs",
    twins: &["dispersion", "resistance-drift", "asymmetric-capacitance"],
    separated_by: "half the voltage, or a discharge",
    sources: "Aureli and Porfiri 2008; Cottinet et al. 2011",
};

impl Effect for VoltageDependentCapacitance {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let square = scale.voltage_v * scale.voltage_v;
        if square == 0.0 || variant == 1 && scale.base.branches.len() < 2 {
            return Search::none();
        }
        let most = (2.0 / square).max(0.5);
        Search::over(0.02 / square, vec![Limits::linear(-0.95 / square, most)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let per_v2 = parameters[0];
        let of_base = (variant == 1).then_some(1);
        system.laws.push(instant(move |now, c| {
            scale_capacitances(now, c, of_base, |e| 1.0 + per_v2 * e * e);
        }));
    }
}
