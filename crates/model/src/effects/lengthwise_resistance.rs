//! Electrodes that resist along the strip: its far end charges later.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// Strengths at which its signature is looked for, times the length squared and the conductance across the strip: weak, it
/// looks like a resistance before the strip, which a refit takes up; strong, like charge that walks into it.
const PROBES: [f64; 3] = [0.04, 4.0, 40.0];
/// Strongest that is sought, in the same measure: a tenth of the strip is charged at once. Table 3 of the thesis has 4.6
/// (CNaf) and 33 (PtNaf).
const MOST: f64 = 100.0;

/// See the module.
pub(super) struct LengthwiseResistance;

static ABOUT: About = About {
    id: "lengthwise-resistance",
    code: "K8",
    summary: "electrode resistance along the strip: the distributed model is needed",
    equation: "d2u/dz2 = R_sq i(z), u = v at the clamp, du/dz = 0 at the end; kappa the mean over the length",
    variants: &[],
    parameters: &[EffectParameter {
        key: "electrode_resistance_ohm_per_sq",
        symbol: "R_sq",
        unit: "Ohm/sq",
        meaning: "resistance of both electrodes together",
    }],
    vanishes: "R_sq = 0",
    signature: "curvature that is not constant along the strip, and a tip that lags",
    twins: &["dispersion", "warburg", "mechanical-lag", "series-resistance"],
    separated_by: "the curvature along the strip in one picture; two places of the clamp",
    sources: "distributed model, thesis equations 21-26",
};

impl Equation for LengthwiseResistance {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let Some(length_cm) = scale.length_cm.filter(|length| *length > 0.0) else {
            return Search::none();
        };
        let conductance: f64 = scale
            .base
            .branches
            .iter()
            .map(|b| b.resistance_ohm_cm2.recip())
            .sum();
        // With R_sq G L^2 = 1 the voltage falls by about a third along the strip at once.
        let unit = 1.0 / (conductance * length_cm * length_cm);
        Search {
            limits: vec![Limits::linear(0.0, MOST * unit)],
            probes: PROBES.iter().map(|strength| vec![strength * unit]).collect(),
            absent: 0.0,
        }
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.electrode_resistance_ohm_per_sq += parameters[0].max(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    /// At once the strip is a transmission line without capacitors.
    #[test]
    fn first_current_is_that_of_a_line() {
        let r = 4.0;
        let found = respond(
            &[("lengthwise-resistance", 0, &[r])],
            &[(0.0, Some(2.0))],
            &[0.0],
            &[],
        );
        let conductance: f64 = 1.0 / 3.0 + 1.0 / 15.0 + 1.0 / 300.0;
        let x = 0.5 * (r * conductance).sqrt();
        let expected = 0.1 * 2.0 * conductance * x.tanh() / x;
        assert!(
            (found.current_a[0] / expected - 1.0).abs() < 1e-3,
            "{found:?} {expected}"
        );
    }

    /// With a resistance before the clamp the line is one resistance more, and the source's limit holds for all.
    #[test]
    fn contact_and_limit_act_before_the_line() {
        let levels = [(0.0, Some(2.0))];
        let line = ("lengthwise-resistance", 0, &[4.0][..]);
        let alone = respond(&[line], &levels, &[0.0], &[]).current_a[0];
        let with = respond(&[line, ("series-resistance", 0, &[2.0])], &levels, &[0.0], &[]);
        assert!((with.current_a[0] - 2.0 / (2.0 / alone + 2.0 / 0.1)).abs() < 1e-12);
        let limited = respond(&[line, ("current-limit", 0, &[0.02])], &levels, &[0.0, 0.1], &[]);
        assert!(
            limited.current_a.iter().all(|i| (i - 0.02).abs() < 1e-12),
            "{limited:?}"
        );
    }
}
