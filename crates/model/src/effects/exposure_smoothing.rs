//! A mean over the time of exposure.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct ExposureSmoothing;

static ABOUT: About = About {
    id: "exposure-smoothing",
    code: "G5",
    summary: "moving average over the exposure",
    equation: "kappa(t) -> mean of kappa from t - T_e to t",
    variants: &[],
    parameters: &[EffectParameter {
        key: "exposure_s",
        symbol: "T_e",
        unit: "s",
        meaning: "time of exposure",
    }],
    vanishes: "T_e = 0",
    signature: "a double spike at every edge",
    twins: &["camera-delay"],
    separated_by: "a shorter exposure",
    sources: "cameras and smoothing filters",
};

impl Equation for ExposureSmoothing {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let most = (2.0 * scale.shortest_s).max(1.0);
        Search::over(0.02 * most, vec![Limits::linear(0.0, most)], &[])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.camera.exposure_s += parameters[0].max(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn where_the_curve_is_straight_it_is_the_middle() {
        let levels = [(0.0, Some(2.0))];
        let mean = respond(&[("exposure-smoothing", 0, &[1.0])], &levels, &[], &[200.0]);
        let own = respond(&[], &levels, &[], &[199.5]);
        assert!((mean.curvature_per_cm[0] / own.curvature_per_cm[0] - 1.0).abs() < 1e-5);
    }
}
