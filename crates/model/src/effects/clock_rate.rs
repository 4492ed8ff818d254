//! A camera whose clock runs at another rate.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct ClockRate;

static ABOUT: About = About {
    id: "clock-rate",
    code: "G3",
    summary: "the two clocks run differently",
    equation: "kappa(t) -> kappa(t (1 + e))",
    variants: &[],
    parameters: &[EffectParameter {
        key: "rate_error",
        symbol: "e",
        unit: "",
        meaning: "relative error of the rate",
    }],
    vanishes: "e = 0",
    signature: "a residual of the bending that grows with time",
    twins: &["modulus-drift", "camera-delay"],
    separated_by: "a pulse train; a light at the end of the run",
    sources: "drift of quartz clocks, frames counted at a nominal rate",
};

impl Equation for ClockRate {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, _scale: &Scale) -> Search {
        Search::over(0.005, vec![Limits::linear(-0.05, 0.05)], &[])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.camera.rate_error += parameters[0];
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn clocks_agree_at_the_start_of_the_drive() {
        let levels = [(10.0, Some(2.0))];
        let other = respond(&[("clock-rate", 0, &[0.02])], &levels, &[], &[60.0]);
        let own = respond(&[], &levels, &[], &[61.0]);
        assert!((other.curvature_per_cm[0] - own.curvature_per_cm[0]).abs() < 1e-12);
    }
}
