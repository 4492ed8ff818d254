//! Water that the current carries along.

use super::acting::{LEAST, remembering, scale_resistances};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct WaterRedistribution;

static ABOUT: About = About {
    id: "water-redistribution",
    code: "N2",
    summary: "current moves water, R and lambda follow",
    equation: "w' = i - w/tau, R_k -> R_k (1 + c w), lambda -> lambda (1 + c w)",
    variants: &["resistance", "relaxation", "both"],
    parameters: &[
        EffectParameter {
            key: "change_cm2_per_c",
            symbol: "c",
            unit: "cm2/C",
            meaning: "relative change per charge that has carried water",
        },
        EffectParameter {
            key: "return_time_s",
            symbol: "tau",
            unit: "s",
            meaning: "time in which the water returns",
        },
    ],
    vanishes: "c = 0",
    signature: "slow, and its sign follows the current",
    twins: &[
        "piezoresistive-electrode",
        "joule-heating",
        "resistance-drift",
        "counter-flow",
    ],
    separated_by: "another humidity, or an open circuit",
    sources: "electro-osmosis in ionomers",
};

/// Fastest way back of water that the current moved, by diffusion across a strip of 0.1 mm (1e-9 m2/s, as in free water).
const SHORTEST_S: f64 = 3.0;

impl Equation for WaterRedistribution {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let areal = scale.charge_c / scale.area_cm2;
        let relaxes = scale.curvature_per_cm > 0.0 && scale.base.relaxation_rate_per_s > 0.0;
        if areal == 0.0 || variant == 1 && !relaxes {
            return Search::none();
        }
        let most = 0.5 / areal;
        let longest_s = scale.longest_s();
        let low_s = (longest_s / 100.0).max(SHORTEST_S);
        let mut times_s = scale.times_s(0.02, 1.0, 4);
        times_s.retain(|time_s| *time_s >= low_s);
        if times_s.is_empty() {
            return Search::none();
        }
        let limits = vec![
            Limits::linear(-most, most),
            Limits::logarithmic(low_s, 3.0 * longest_s),
        ];
        Search::over(0.07 * most, limits, &[times_s])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let per_charge = parameters[0];
        system.laws.push(remembering(
            parameters[1],
            |now| now.current_a_per_cm2,
            move |water, c| {
                let factor = (1.0 + per_charge * water).max(LEAST);
                if variant != 1 {
                    scale_resistances(c, factor);
                }
                if variant != 0 {
                    c.relaxation_factor *= factor;
                }
            },
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    /// Water that never returns is the charge that has passed.
    #[test]
    fn an_edge_meets_the_resistance_that_the_charge_made() {
        let levels = [(0.0, Some(2.0)), (150.0, Some(0.0))];
        let found = respond(
            &[("water-redistribution", 0, &[0.1, 1e12])],
            &levels,
            &[150.0 - 1e-7, 150.0],
            &[],
        );
        let passed = 2.0 * (0.7 + 150.0 / 300.0);
        let jump = 0.1 * 2.0 * ((1.0 / 3.0 + 1.0 / 15.0) / (1.0 + 0.1 * passed) + 1.0 / 300.0);
        assert!(((found.current_a[0] - found.current_a[1]) / jump - 1.0).abs() < 1e-3);
    }
}
