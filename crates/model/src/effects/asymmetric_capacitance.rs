//! Capacitance that differs between the two polarities.

use super::acting::{instant, scale_capacitances};
use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct AsymmetricCapacitance;

static ABOUT: About = About {
    id: "asymmetric-capacitance",
    code: "E7",
    class: Class::Charging,
    summary: "C = C0 (1 + b v)",
    equation: "dq_k/de_k = C_k (1 + b e_k), e_k the voltage of the capacitor",
    variants: &["all", "branch-2"],
    parameters: &[EffectParameter {
        key: "linear_per_v",
        symbol: "b",
        unit: "1/V",
        meaning: "relative change of the differential capacitance per volt",
    }],
    vanishes: "b = 0",
    signature: "charge and time constants differ between the polarities",
    twins: &[
        "voltage-dependent-capacitance",
        "piezoresistive-electrode",
        "water-exchange",
        "dispersion",
        "joule-heating",
    ],
    separated_by: "reversed polarity, or a discharge",
    sources: "unlike electrodes, or ions of unlike size",
};

impl Effect for AsymmetricCapacitance {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        if scale.voltage_v == 0.0 || variant == 1 && scale.base.branches.len() < 2 {
            return Search::none();
        }
        let most = 0.9 / scale.voltage_v;
        Search::over(0.02 / scale.voltage_v, vec![Limits::linear(-most, most)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let per_v = parameters[0];
        let of_base = (variant == 1).then_some(1);
        system.laws.push(instant(move |now, c| {
            scale_capacitances(now, c, of_base, |e| 1.0 + per_v * e);
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn polarity_and_sign_are_one() {
        let times = [0.5, 5.0, 50.0];
        let up = respond(
            &[("asymmetric-capacitance", 0, &[0.2])],
            &[(0.0, Some(2.0))],
            &times,
            &times,
        );
        let down = respond(
            &[("asymmetric-capacitance", 0, &[-0.2])],
            &[(0.0, Some(-2.0))],
            &times,
            &times,
        );
        for k in 0..times.len() {
            assert!((up.current_a[k] + down.current_a[k]).abs() < 1e-12);
            assert!((up.curvature_per_cm[k] + down.curvature_per_cm[k]).abs() < 1e-12);
        }
    }
}
