//! A leak that splits the water of the membrane.

use super::acting::{remembering, scale_resistances};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{Now, RunContext, System};

/// See the module.
pub(super) struct ElectrolyticDrying;

static ABOUT: About = About {
    id: "electrolytic-drying",
    code: "N5",
    summary: "leak charge consumes water, R grows",
    equation: "R_k -> R_k (1 + k INT j dt); jump: j = |u|/R_ss where |u| > E_on; ramp: j = (|u| - E_on)/R_ss there",
    variants: &["jump", "ramp"],
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

impl Equation for ElectrolyticDrying {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let (volts, longest_s) = (scale.voltage_v, scale.longest_s());
        let leaked = volts / scale.base.steady_state_resistance_ohm_cm2 * longest_s;
        if leaked <= 0.0 {
            return Search::none();
        }
        let limits = vec![
            Limits::linear(0.0, if variant == 0 { 3.0 } else { 10.0 } / leaked),
            Limits::linear(0.05 * volts, volts),
        ];
        let onsets: &[f64] = if variant == 0 {
            &[0.3, 0.5, 0.7, 0.9]
        } else {
            &[0.4, 0.75]
        };
        let onsets = onsets.iter().map(|part| part * volts).collect();
        Search::over(0.05 / leaked, limits, &[onsets])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let [growth, onset_v] = [parameters[0], parameters[1]];
        let leak = move |now: &Now| {
            let volts = now.terminal_v.abs();
            match (volts > onset_v, variant) {
                (false, _) => 0.0,
                (true, 0) => now.steady_a_per_cm2.abs(),
                (true, _) => now.steady_a_per_cm2.abs() * (1.0 - onset_v / volts),
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
        for (variant, volts) in [2.0, 2.0 - 1.0].into_iter().enumerate() {
            let effect = ("electrolytic-drying", variant, [0.6, 1.0].as_slice());
            let found = respond(&[effect], &levels, &[150.0 - 1e-7, 150.0], &[]);
            let factor = 1.0 + 0.6 * 50.0 * volts / 300.0;
            let jump = 0.1 * 2.0 * ((1.0 / 3.0 + 1.0 / 15.0) / factor + 1.0 / 300.0);
            assert!(((found.current_a[0] - found.current_a[1]) / jump - 1.0).abs() < 1e-6);
        }
    }
}
