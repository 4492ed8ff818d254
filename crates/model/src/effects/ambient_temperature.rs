//! A room that warms or cools: all rates move together.

use super::acting::{LEAST, instant, scale_resistances};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// Times in which a room settles that a run lasts.
const SETTLES: f64 = 4.0;

/// See the module.
pub(super) struct AmbientTemperature;

static ABOUT: About = About {
    id: "ambient-temperature",
    code: "N6",
    summary: "all rates scale with temperature",
    equation: "R_k -> R_k/(1 + e g), lambda -> lambda (1 + e g); linear: g = t/T; settling: g = (1 - e^(-4t/T))/(1 - e^-4); T the time of the last reading",
    variants: &["linear", "settling"],
    parameters: &[EffectParameter {
        key: "drift_per_run",
        symbol: "e",
        unit: "",
        meaning: "relative change of all rates over the run",
    }],
    vanishes: "e = 0",
    signature: "electrical times and the relaxation move by one factor",
    twins: &["resistance-drift", "water-exchange"],
    separated_by: "a thermometer",
    sources: "Vogel-Fulcher-Tammann viscosity of ionic liquids",
};

impl Equation for AmbientTemperature {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, _scale: &Scale) -> Search {
        Search::over(0.03, vec![Limits::linear(-0.6, 1.5)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let [change, end_s] = [parameters[0], run.duration_s.max(f64::MIN_POSITIVE)];
        let per_s = change / end_s;
        system.laws.push(instant(move |now, c| {
            let clock_s = now.clock_s.max(0.0);
            let grown = match variant {
                0 => per_s * clock_s,
                _ => change * (-SETTLES * clock_s / end_s).exp_m1() / (-SETTLES).exp_m1(),
            };
            let faster = (1.0 + grown).max(LEAST);
            scale_resistances(c, faster.recip());
            c.relaxation_factor *= faster;
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn a_late_step_meets_the_warmer_strip() {
        let late = [(0.0, Some(0.0)), (150.0, Some(2.0))];
        let settled = 1.0 / (1.0 + (-2.0_f64).exp());
        for (variant, way) in [0.5, settled].into_iter().enumerate() {
            let found = respond(&[("ambient-temperature", variant, &[0.4])], &late, &[150.0], &[]);
            let expected = 0.1 * 2.0 * ((1.0 / 3.0 + 1.0 / 15.0) * (1.0 + 0.4 * way) + 1.0 / 300.0);
            assert!((found.current_a[0] / expected - 1.0).abs() < 1e-12);
        }
    }
}
