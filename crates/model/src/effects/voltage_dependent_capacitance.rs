//! Capacitance that depends on the voltage across it, the same for both signs.

use super::acting::{instant, scale_capacitances};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct VoltageDependentCapacitance;

static ABOUT: About = About {
    id: "voltage-dependent-capacitance",
    code: "E6",
    summary: "C = C0 (1 + a v^2)",
    equation: "dq_k/de_k = C_k (1 + a e_k^2), of magnitude C_k (1 + a |e_k| 1 V), e_k the voltage of the capacitor",
    variants: &["all", "branch-2", "magnitude"],
    parameters: &[EffectParameter {
        key: "quadratic_per_v2",
        symbol: "a",
        unit: "1/V2",
        meaning: "relative change of the differential capacitance per square of the voltage (of magnitude: at 1 V)",
    }],
    vanishes: "a = 0",
    signature: "time constants and charge change with the step's voltage, alike for both signs",
    twins: &["dispersion", "resistance-drift", "asymmetric-capacitance"],
    separated_by: "half the voltage, or a discharge",
    sources: "Aureli and Porfiri 2008; Cottinet et al. 2011",
};

impl Equation for VoltageDependentCapacitance {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let square = scale.voltage_v * scale.voltage_v;
        if square == 0.0 || variant == 1 && scale.base.branches.len() < 2 {
            return Search::none();
        }
        // What a change at the largest voltage is divided by.
        let size = if variant == 2 { scale.voltage_v } else { square };
        let most = (2.0 / size).max(0.5);
        Search::over(0.02 / size, vec![Limits::linear(-0.95 / size, most)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let per_v2 = parameters[0];
        let of_base = (variant == 1).then_some(1);
        system.laws.push(instant(move |now, c| {
            scale_capacitances(now, c, of_base, |e| match variant {
                2 => 1.0 + per_v2 * e.abs(),
                _ => 1.0 + per_v2 * e * e,
            });
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn charge_in_the_end_is_the_integral_of_the_capacitance() {
        let times: Vec<f64> = (0..=8000).map(|k| 0.025 * f64::from(k)).collect();
        let charge = |effects: &[(&str, usize, &[f64])]| -> f64 {
            let found = respond(effects, &[(0.0, Some(-2.0))], &times, &[]).current_a;
            let pairs = times.windows(2).zip(found.windows(2));
            pairs.map(|(t, i)| (t[1] - t[0]) * (i[0] + i[1]) / 2.0).sum()
        };
        let plain = charge(&[]);
        for (variant, part) in [(0, 0.2 * 4.0 / 3.0), (2, 0.2)] {
            let more = charge(&[("voltage-dependent-capacitance", variant, &[0.2])]) - plain;
            let expected = -0.1 * 0.7 * 2.0 * part;
            assert!(
                (more / expected - 1.0).abs() < 0.01,
                "{variant}: {more} {expected}"
            );
        }
    }
}
