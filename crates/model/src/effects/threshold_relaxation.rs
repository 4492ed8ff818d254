//! Relaxation that quickens above a voltage.

use super::acting::instant;
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// Width of the step in terms of the threshold: the rate goes from a tenth to nine tenths of its growth within 22 % of it.
const WIDTH: f64 = 0.05;

/// How far the rate has grown at a voltage in terms of the threshold.
fn growth(variant: usize, volts: f64) -> f64 {
    let above = (volts - 1.0).max(0.0);
    match variant {
        0 => above,
        1 => above * above,
        // Nothing at rest.
        _ => logistic((volts - 1.0) / WIDTH) - logistic(-1.0 / WIDTH),
    }
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

/// See the module.
pub(super) struct ThresholdRelaxation;

static ABOUT: About = About {
    id: "threshold-relaxation",
    code: "K6",
    summary: "lambda rises above a voltage",
    equation: "lambda -> lambda (1 + c g), v the voltage of the source; linear: g = max(0, |v|/V_th - 1); square: g the square of that; step: g = 1/(1 + e^(-(|v|/V_th - 1)/0.05))",
    variants: &["linear", "square", "step"],
    parameters: &[
        EffectParameter {
            key: "steepness",
            symbol: "c",
            unit: "",
            meaning: "relative growth of the rate per relative voltage above the threshold (of its square; beyond the step)",
        },
        EffectParameter {
            key: "threshold_v",
            symbol: "V_th",
            unit: "V",
            meaning: "threshold",
        },
    ],
    vanishes: "c = 0",
    signature: "a rate that differs from run to run with the voltage",
    twins: &["faradaic-leak", "joule-heating", "friction"],
    separated_by: "five voltages",
    sources: "back-relaxation of ionic polymer strips faster at high voltage (Virginia Tech thesis 2005)",
};

impl Equation for ThresholdRelaxation {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let volts = scale.voltage_v;
        if volts == 0.0 || scale.base.relaxation_rate_per_s <= 0.0 {
            return Search::none();
        }
        let limits = vec![Limits::linear(0.0, 5.0), Limits::linear(0.1 * volts, volts)];
        let thresholds: &[f64] = match variant {
            0 => &[0.3, 0.5, 0.7, 0.9],
            1 => &[0.3, 0.6],
            _ => &[0.4, 0.6, 0.85],
        };
        let thresholds = thresholds.iter().map(|part| part * volts).collect();
        let mut search = Search::over(0.02, limits, &[thresholds]);
        for probe in &mut search.probes {
            probe[0] /= growth(variant, volts / probe[1]);
        }
        search
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let [steepness, threshold_v] = [parameters[0], parameters[1]];
        system.laws.push(instant(move |now, c| {
            let grown = growth(variant, now.source_v.abs() / threshold_v);
            c.relaxation_factor *= (1.0 + steepness * grown).max(0.0);
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;
    use crate::extended::tests::{base, drive};

    #[test]
    fn at_one_voltage_it_is_another_rate() {
        let (levels, times) = ([(0.0, Some(-2.0))], [5.0, 50.0, 250.0]);
        // Twice the threshold: all forms have grown by one steepness.
        for variant in 0..3 {
            let effect = ("threshold-relaxation", variant, [1.5, 1.0].as_slice());
            let found = respond(&[effect], &levels, &[], &times);
            let mut faster = base();
            faster.relaxation_rate_per_s *= 2.5;
            let expected = faster.curvature_per_cm(&drive(&levels), 0.1, &times);
            for (a, b) in found.curvature_per_cm.iter().zip(&expected) {
                assert!((a - b).abs() < 1e-7, "{variant}: {a} {b}");
            }
        }
    }

    #[test]
    fn a_step_is_half_way_at_its_threshold() {
        assert!((super::growth(2, 1.0) - 0.5).abs() < 1e-8);
        assert_eq!([0, 1, 2].map(|variant| super::growth(variant, 0.0)), [0.0; 3]);
        assert!((super::growth(0, 1.2) - 0.2).abs() < 1e-12 && (super::growth(1, 1.2) - 0.04).abs() < 1e-12);
    }
}
