//! A strip that is no arc of a circle, fitted as one.

use super::acting::{LEAST, read_as};
use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct NoncircularShape;

static ABOUT: About = About {
    id: "noncircular-shape",
    code: "G6",
    class: Class::Frame,
    summary: "curvature fitted to a shape that is no arc",
    equation: "kappa -> kappa (1 + c |kappa|)",
    variants: &[],
    parameters: &[EffectParameter {
        key: "bias_cm",
        symbol: "c",
        unit: "cm",
        meaning: "relative error per curvature",
    }],
    vanishes: "c = 0",
    signature: "depends on the curvature and on the part of the strip that is seen",
    twins: &["softening", "coupling-saturation", "tip-formula"],
    separated_by: "the residual of the circle in every picture",
    sources: "fit of a circle to an edge in a picture",
};

impl Effect for NoncircularShape {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        Search::over(
            0.01 / scale.curvature_per_cm,
            vec![Limits::linear(
                -0.5 / scale.curvature_per_cm,
                scale.curvature_per_cm.recip(),
            )],
            &[],
        )
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let bias_cm = parameters[0];
        system.observations.push(read_as(move |_, kappa| {
            kappa * (1.0 + bias_cm * kappa.abs()).max(LEAST)
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn error_is_even_in_the_curvature() {
        for v in [2.0, -2.0] {
            let levels = [(0.0, Some(v))];
            let with =
                respond(&[("noncircular-shape", 0, &[0.5])], &levels, &[], &[20.0]).curvature_per_cm[0];
            let own = respond(&[], &levels, &[], &[20.0]).curvature_per_cm[0];
            assert!((with / own - 1.0 - 0.5 * own.abs()).abs() < 1e-12);
        }
    }
}
