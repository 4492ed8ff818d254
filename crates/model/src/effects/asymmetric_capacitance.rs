//! Capacitance that differs between the two polarities.

use super::acting::{instant, scale_capacitances};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// Voltage within which the capacitance goes from that of one polarity to that of the other, V.
const STEP_V: f64 = 0.2;

/// See the module.
pub(super) struct AsymmetricCapacitance;

static ABOUT: About = About {
    id: "asymmetric-capacitance",
    code: "E7",
    summary: "C = C0 (1 + b v)",
    equation: "dq_k/de_k = C_k (1 + b e_k), of step C_k (1 + b V_0 tanh(e_k/V_0)) with V_0 = 0.2 V, e_k the voltage of the capacitor",
    variants: &["all", "branch-2", "step"],
    parameters: &[EffectParameter {
        key: "linear_per_v",
        symbol: "b",
        unit: "1/V",
        meaning: "relative change of the differential capacitance per volt (of step: at 0 V)",
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

impl Equation for AsymmetricCapacitance {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        if scale.voltage_v == 0.0 || variant == 1 && scale.base.branches.len() < 2 {
            return Search::none();
        }
        let volts = if variant == 2 {
            STEP_V.min(scale.voltage_v)
        } else {
            scale.voltage_v
        };
        let most = 0.9 / volts;
        Search::over(0.02 / volts, vec![Limits::linear(-most, most)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let per_v = parameters[0];
        let of_base = (variant == 1).then_some(1);
        system.laws.push(instant(move |now, c| {
            scale_capacitances(now, c, of_base, |e| match variant {
                2 => 1.0 + per_v * STEP_V * (e / STEP_V).tanh(),
                _ => 1.0 + per_v * e,
            });
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn polarity_and_sign_are_one() {
        let times = [0.5, 5.0, 50.0];
        for variant in [0, 2] {
            let of = |per_v: f64, volts| {
                respond(
                    &[("asymmetric-capacitance", variant, &[per_v])],
                    &[(0.0, Some(volts))],
                    &times,
                    &times,
                )
            };
            let (up, down) = (of(0.2, 2.0), of(-0.2, -2.0));
            for k in 0..times.len() {
                assert!((up.current_a[k] + down.current_a[k]).abs() < 1e-12);
                assert!((up.curvature_per_cm[k] + down.curvature_per_cm[k]).abs() < 1e-12);
            }
        }
    }

    /// Far above the step's width both capacitors are larger by b V_0.
    #[test]
    fn a_step_is_another_capacitance_in_the_end() {
        let levels = [(0.0, Some(2.0)), (200.0, Some(2.2))];
        let found = respond(&[("asymmetric-capacitance", 2, &[1.0])], &levels, &[203.0], &[]);
        let slower = |r: f64, c: f64| (-3.0 / (1.2 * r * c)).exp() / r;
        let expected = 0.1 * (0.2 * (slower(3.0, 0.1) + slower(15.0, 0.6)) + 2.2 / 300.0);
        assert!((found.current_a[0] / expected - 1.0).abs() < 1e-5);
    }
}
