//! Curvature readings that stand still at a level: a stop, or the edge of the picture.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct CurvatureLimit;

static ABOUT: About = About {
    id: "curvature-limit",
    code: "G10",
    summary: "curvature is read no larger than a level",
    equation: "both: kappa -> kappa within -k_max and k_max; above: kappa -> min(kappa, k_max); below: kappa -> max(kappa, -k_max)",
    variants: &["both", "above", "below"],
    parameters: &[EffectParameter {
        key: "limit_per_cm",
        symbol: "k_max",
        unit: "1/cm",
        meaning: "largest curvature that is read",
    }],
    vanishes: "k_max above the largest curvature",
    signature: "a flat top at the same level in every run",
    twins: &["coupling-saturation", "softening", "friction"],
    separated_by: "the pictures; half the voltage: the level is not reached",
    sources: "edge of a camera's field of view, stops beside a strip",
};

impl Equation for CurvatureLimit {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let most = scale.curvature_per_cm;
        // One side may bend less far than the other.
        let parts: &[f64] = if variant == 0 { &[0.9, 0.65] } else { &[0.5] };
        Search {
            limits: vec![Limits::linear(0.1 * most, 1.5 * most)],
            probes: parts.iter().map(|part| vec![part * most]).collect(),
            absent: f64::INFINITY,
        }
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let most = parameters[0].max(0.0);
        let (low, high) = match variant {
            0 => (-most, most),
            1 => (f64::NEG_INFINITY, most),
            _ => (-most, f64::INFINITY),
        };
        let written = move |_, kappa: f64| kappa.clamp(low, high);
        system.written_curvature.push(Box::new(written));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn readings_are_flat_at_the_level_on_the_sides_that_have_one() {
        let times: Vec<f64> = (0..300).map(f64::from).collect();
        for volts in [2.0, -2.0] {
            let levels = [(0.0, Some(volts))];
            let own = respond(&[], &levels, &times, &times);
            for (variant, low, high) in [(0, -0.05, 0.05), (1, -9.0, 0.05), (2, -0.05, 9.0)] {
                let found = respond(&[("curvature-limit", variant, &[0.05])], &levels, &times, &times);
                assert_eq!(found.current_a, own.current_a);
                let clipped: Vec<f64> = own
                    .curvature_per_cm
                    .iter()
                    .map(|k| k.max(low).min(high))
                    .collect();
                assert_eq!(found.curvature_per_cm, clipped);
            }
            assert!(own.curvature_per_cm[30].abs() > 0.1);
        }
    }
}
