//! A strip that is no arc of a circle, fitted as one.

use super::acting::{LEAST, read_as};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct NoncircularShape;

static ABOUT: About = About {
    id: "noncircular-shape",
    code: "G6",
    summary: "curvature fitted to a shape that is no arc",
    equation: "kappa -> kappa (1 + c |kappa|), of one-sided kappa (1 + c kappa)",
    variants: &["both-sides", "one-sided"],
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

impl Equation for NoncircularShape {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        Search::over(
            0.01 / scale.curvature_per_cm,
            vec![Limits::linear(
                -0.5 / scale.curvature_per_cm,
                scale.curvature_per_cm.recip(),
            )],
            &[],
        )
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let bias_cm = parameters[0];
        system.observations.push(read_as(move |_, kappa| {
            let bent = if variant == 0 { kappa.abs() } else { kappa };
            kappa * (1.0 + bias_cm * bent).max(LEAST)
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn error_is_even_in_the_curvature_or_odd() {
        for v in [2.0, -2.0] {
            let levels = [(0.0, Some(v))];
            let own = respond(&[], &levels, &[], &[20.0]).curvature_per_cm[0];
            for (variant, bent) in [own.abs(), own].into_iter().enumerate() {
                let effect = ("noncircular-shape", variant, [0.5].as_slice());
                let with = respond(&[effect], &levels, &[], &[20.0]).curvature_per_cm[0];
                assert!((with / own - 1.0 - 0.5 * bent).abs() < 1e-12);
            }
        }
    }
}
