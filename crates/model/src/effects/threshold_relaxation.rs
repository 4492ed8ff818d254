//! Relaxation that quickens above a voltage.

use super::acting::instant;
use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct ThresholdRelaxation;

static ABOUT: About = About {
    id: "threshold-relaxation",
    code: "K6",
    class: Class::Coupling,
    summary: "lambda rises above a voltage",
    equation: "lambda -> lambda (1 + c max(0, |v|/V_th - 1)), v the voltage of the source",
    variants: &[],
    parameters: &[
        EffectParameter {
            key: "steepness",
            symbol: "c",
            unit: "",
            meaning: "relative growth of the rate per relative voltage above the threshold",
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

impl Effect for ThresholdRelaxation {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        let volts = scale.voltage_v;
        if volts == 0.0 || scale.base.relaxation_rate_per_s <= 0.0 {
            return Search::none();
        }
        let limits = vec![Limits::linear(0.0, 5.0), Limits::linear(0.1 * volts, volts)];
        let thresholds = [0.3, 0.5, 0.7, 0.9].map(|part| part * volts);
        let mut search = Search::over(0.02, limits, &[thresholds.to_vec()]);
        for probe in &mut search.probes {
            probe[0] /= volts / probe[1] - 1.0;
        }
        search
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let [steepness, threshold_v] = [parameters[0], parameters[1]];
        system.laws.push(instant(move |now, c| {
            let above = (now.source_v.abs() / threshold_v - 1.0).max(0.0);
            c.relaxation_factor *= (1.0 + steepness * above).max(0.0);
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
        let found = respond(&[("threshold-relaxation", 0, &[1.5, 1.0])], &levels, &[], &times);
        let mut faster = base();
        faster.relaxation_rate_per_s *= 2.5;
        let expected = faster.curvature_per_cm(&drive(&levels), 0.1, &times);
        for (a, b) in found.curvature_per_cm.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-9);
        }
    }
}
