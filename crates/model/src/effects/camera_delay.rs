//! Curvature that is read late.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct CameraDelay;

static ABOUT: About = About {
    id: "camera-delay",
    code: "G2",
    summary: "curvature late against current",
    equation: "kappa(t) -> kappa(t - d)",
    variants: &[],
    parameters: &[EffectParameter {
        key: "delay_s",
        symbol: "d",
        unit: "s",
        meaning: "what a reading shows was this long ago",
    }],
    vanishes: "d = 0",
    signature: "a residual like a derivative, just after every edge, in the bending only",
    twins: &["mechanical-lag", "resonance", "friction", "source-rise"],
    separated_by: "a light on the same trigger in the camera's view",
    sources: "latency of cameras",
};

impl Equation for CameraDelay {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let most = (3.0 * scale.shortest_s).max(1.0);
        Search::over(
            0.01 * most,
            vec![Limits::linear(-scale.shortest_s.min(1.0), most)],
            &[],
        )
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.camera.delay_s += parameters[0];
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn a_reading_shows_what_was() {
        let levels = [(0.0, Some(2.0)), (10.0, Some(0.0))];
        let late = respond(&[("camera-delay", 0, &[0.4])], &levels, &[], &[0.2, 5.0, 10.2]);
        let own = respond(&[], &levels, &[], &[4.6, 9.8]);
        assert_eq!(late.curvature_per_cm[0], 0.0);
        assert!((late.curvature_per_cm[1] - own.curvature_per_cm[0]).abs() < 1e-12);
        assert!((late.curvature_per_cm[2] - own.curvature_per_cm[1]).abs() < 1e-12);
    }
}
