//! Electrodes whose resistance changes as they bend.

use super::acting::{instant, scale_resistances};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct PiezoresistiveElectrode;

static ABOUT: About = About {
    id: "piezoresistive-electrode",
    code: "E12",
    summary: "R changes with curvature",
    equation: "R_k -> R_k (1 + g kappa), of even R_k (1 + g |kappa|)",
    variants: &["odd", "even"],
    parameters: &[EffectParameter {
        key: "gauge_cm",
        symbol: "g",
        unit: "cm",
        meaning: "relative change of the resistances per curvature",
    }],
    vanishes: "g = 0",
    signature: "odd in the voltage, or even; the current follows the bending, its relaxation too",
    twins: &["joule-heating", "water-redistribution", "asymmetric-capacitance"],
    separated_by: "reversed polarity, or a strip that is held straight",
    sources: "strain gauges; models of metal electrodes under bending",
};

impl Equation for PiezoresistiveElectrode {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        let most = 0.9 / scale.curvature_per_cm;
        Search::over(0.03 * most, vec![Limits::linear(-most, most)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let gauge_cm = parameters[0];
        system.laws.push(instant(move |now, c| {
            let kappa = now.curvature_per_cm;
            scale_resistances(c, 1.0 + gauge_cm * if variant == 0 { kappa } else { kappa.abs() })
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn an_edge_meets_the_resistance_of_the_bent_strip() {
        let times = [100.0 - 1e-7, 100.0];
        for (variant, volts) in [(0, 2.0), (1, 2.0), (1, -2.0)] {
            let levels = [(0.0, Some(volts)), (100.0, Some(0.0))];
            let effect = ("piezoresistive-electrode", variant, [1.5].as_slice());
            let found = respond(&[effect], &levels, &times, &times);
            let factor = 1.0 + 1.5 * found.curvature_per_cm[0].abs();
            let jump = 0.1 * volts * ((1.0 / 3.0 + 1.0 / 15.0) / factor + 1.0 / 300.0);
            assert!((found.current_a[0] - found.current_a[1] - jump).abs() < 1e-7);
        }
    }
}
