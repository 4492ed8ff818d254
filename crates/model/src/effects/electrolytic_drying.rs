//! A leak that splits the water of the membrane.

use super::acting::{remembering, scale_resistances};
use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{Now, RunContext, System};

/// See the module.
pub(super) struct ElectrolyticDrying;

static ABOUT: About = About {
    id: "electrolytic-drying",
    code: "N5",
    class: Class::Drift,
    summary: "leak charge consumes water, R grows",
    equation: "R_k -> R_k (1 + k INT |u|/R_ss dt where |u| > E_on)",
    variants: &[],
    parameters: &[
        EffectParameter {
            key: "growth_cm2_per_c",
            symbol: "k",
            unit: "cm2/C",
            meaning: "relative growth of the resistances per charge leaked",
        },
        EffectParameter {
            key: "onset_v",
            symbol: "E_on",
            unit: "V",
            meaning: "voltage above which water splits",
        },
    ],
    vanishes: "k = 0",
    signature: "resistances grow with the charge leaked, above a voltage only",
    twins: &["faradaic-leak", "resistance-drift", "water-exchange"],
    separated_by: "a pair of runs below and above the onset; mass before and after",
    sources: "Faraday's law of electrolysis",
};

impl Effect for ElectrolyticDrying {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let (volts, longest_s) = (scale.voltage_v, scale.longest_s());
        let leaked = volts / scale.base.steady_state_resistance_ohm_cm2 * longest_s;
        if leaked <= 0.0 {
            return Search::none();
        }
        let limits = vec![
            Limits::linear(0.0, 3.0 / leaked),
            Limits::linear(0.05 * volts, volts),
        ];
        Search::over(
            0.05 / leaked,
            limits,
            &[[0.3, 0.5, 0.7, 0.9].map(|part| part * volts).to_vec()],
        )
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let [growth, onset_v] = [parameters[0], parameters[1]];
        let leak = move |now: &Now| {
            if now.terminal_v.abs() > onset_v {
                now.steady_a_per_cm2.abs()
            } else {
                0.0
            }
        };
        system
            .laws
            .push(remembering(f64::INFINITY, leak, move |leaked, c| {
                scale_resistances(c, 1.0 + growth * leaked)
            }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn an_edge_meets_what_has_leaked_above_the_onset() {
        let levels = [(0.0, Some(0.9)), (100.0, Some(2.0)), (150.0, Some(0.0))];
        let found = respond(
            &[("electrolytic-drying", 0, &[0.6, 1.0])],
            &levels,
            &[150.0 - 1e-7, 150.0],
            &[],
        );
        let factor = 1.0 + 0.6 * 50.0 * 2.0 / 300.0;
        let jump = 0.1 * 2.0 * ((1.0 / 3.0 + 1.0 / 15.0) / factor + 1.0 / 300.0);
        assert!(((found.current_a[0] - found.current_a[1]) / jump - 1.0).abs() < 1e-6);
    }
}
