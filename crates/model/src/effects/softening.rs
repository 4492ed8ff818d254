//! Bending that is not proportional to the bending moment.

use super::acting::read_as;
use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct Softening;

static ABOUT: About = About {
    id: "softening",
    code: "M7",
    class: Class::Coupling,
    summary: "nonlinear in curvature (cubic)",
    equation: "kappa (1 + b kappa^2) = kappa_q",
    variants: &[],
    parameters: &[EffectParameter {
        key: "cubic_cm2",
        symbol: "b",
        unit: "cm2",
        meaning: "cubic term; positive where the strip stiffens",
    }],
    vanishes: "b = 0",
    signature: "cubic in the curvature, near the peak only",
    twins: &["tip-formula", "coupling-saturation", "quadratic-coupling"],
    separated_by: "b = L^2/3 is the tip formula: the length decides",
    sources: "finite bending of soft laminates",
};

/// Root of x (1 + b x^2) = k that goes to k with b; where a softening strip would fold, the fold.
fn bent(b: f64, k: f64) -> f64 {
    let size = (3.0 * b.abs()).sqrt();
    let of = 1.5 * size * k;
    if of.abs() < 1e-9 {
        k
    } else if b > 0.0 {
        2.0 / size * (of.asinh() / 3.0).sinh()
    } else {
        2.0 / size * (of.clamp(-1.0, 1.0).asin() / 3.0).sin()
    }
}

impl Effect for Softening {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        let square = scale.curvature_per_cm * scale.curvature_per_cm;
        Search::over(
            0.01 / square,
            vec![Limits::linear(-0.12 / square, 1.0 / square)],
            &[],
        )
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let cubic = parameters[0];
        system
            .observations
            .push(read_as(move |_, kappa| bent(cubic, kappa)));
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn cubic_is_solved_and_folds_at_its_top() {
        for (b, k) in [(0.4, 1.3), (-0.08, 0.9), (2.0, -0.7), (1e-20, 0.5)] {
            let x = super::bent(b, k);
            assert!((x * (1.0 + b * x * x) - k).abs() < 1e-12);
        }
        assert!((super::bent(-1.0 / 3.0, 5.0) - 1.0).abs() < 1e-12);
    }
}
