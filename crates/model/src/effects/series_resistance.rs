//! Resistance of contact, clip or lead in series with the strip.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct SeriesResistance;

static ABOUT: About = About {
    id: "series-resistance",
    code: "E1",
    summary: "contact, clip or lead resistance before the branches",
    equation: "u = v - R_s i, with the branches driven by u",
    variants: &[],
    parameters: &[EffectParameter {
        key: "series_resistance_ohm_cm2",
        symbol: "R_s",
        unit: "Ohm cm2",
        meaning: "resistance in series with the strip, times its area",
    }],
    vanishes: "R_s = 0",
    signature: "the first current is too low and all branches are coupled; linear in the voltage",
    twins: &["dispersion", "source-rise", "current-limit"],
    separated_by: "a four-wire measurement at the clamp, or an impedance above the frequency of the first branch",
    sources: "potentiostat manuals on uncompensated resistance",
};

impl Equation for SeriesResistance {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let parallel: f64 = scale
            .base
            .branches
            .iter()
            .map(|b| b.resistance_ohm_cm2.recip())
            .sum();
        let most = 2.0 / parallel;
        Search::over(0.02 * most, vec![Limits::linear(0.0, most)], &[])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.series_resistance_ohm_cm2 += parameters[0];
    }
}
