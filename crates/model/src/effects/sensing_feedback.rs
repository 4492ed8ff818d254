//! Motion that gives a voltage of its own.

use super::acting::instant;
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// No motion gives more, V: where another effect makes the loop run away, numbers stay finite.
const MOST_V: f64 = 1e3;

/// See the module.
pub(super) struct SensingFeedback;

static ABOUT: About = About {
    id: "sensing-feedback",
    code: "K7",
    summary: "motion induces voltage",
    equation: "v -> v + g kappa'",
    variants: &[],
    parameters: &[EffectParameter {
        key: "emf_v_s_cm",
        symbol: "g",
        unit: "V s cm",
        meaning: "voltage per rate of the curvature",
    }],
    vanishes: "g = 0",
    signature: "a small change of the current while the strip moves",
    twins: &["series-resistance", "piezoresistive-electrode"],
    separated_by: "the strip moved by hand at 0 V",
    sources: "sensing by ionic polymer strips",
};

impl Equation for SensingFeedback {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let conductance: f64 = scale
            .base
            .branches
            .iter()
            .map(|b| b.resistance_ohm_cm2.recip())
            .sum();
        let per_volt = scale.base.charge_to_curvature_per_c_cm.abs() * scale.area_cm2 * conductance;
        if per_volt == 0.0 {
            return Search::none();
        }
        let most = 0.3 / per_volt;
        Search::over(0.03 * most, vec![Limits::linear(-most, most)], &[])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let per_rate = parameters[0];
        system.laws.push(instant(move |now, c| {
            // The voltage moves the strip that makes it: solved for a voltage that agrees with itself.
            let loop_gain = per_rate * now.curvature_rate_per_cm_s_v;
            let own = now.curvature_rate_per_cm_s - now.curvature_rate_per_cm_s_v * now.emf_v;
            c.emf_v += (per_rate * own / (1.0 - loop_gain.min(0.9))).clamp(-MOST_V, MOST_V);
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn first_current_is_that_of_the_closed_loop() {
        let found = respond(
            &[("sensing-feedback", 0, &[1.0])],
            &[(0.0, Some(2.0))],
            &[0.0],
            &[],
        );
        let conductance = 1.0 / 3.0 + 1.0 / 15.0;
        let across = 2.0 / (1.0 - 1.2 * 0.1 * conductance);
        assert!((found.current_a[0] / (0.1 * across * (conductance + 1.0 / 300.0)) - 1.0).abs() < 1e-12);
    }
}
