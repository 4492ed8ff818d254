//! Bending that is not proportional to the bending moment.

use super::acting::read_as;
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct Softening;

static ABOUT: About = About {
    id: "softening",
    code: "M7",
    summary: "nonlinear in curvature (cubic)",
    equation: "cubic: kappa (1 + b kappa^2) = kappa_q; hyperbolic: sinh(a kappa)/a = kappa_q where b > 0, kappa = sinh(a kappa_q)/a where b < 0, a = sqrt(6 |b|)",
    variants: &["cubic", "hyperbolic"],
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

/// The same law as far as the cubic term, which goes on with the exponential of the curvature.
fn bent_hyperbolically(b: f64, k: f64) -> f64 {
    let a = (6.0 * b.abs()).sqrt();
    if a * k.abs() < 1e-6 {
        k
    } else if b > 0.0 {
        (a * k).asinh() / a
    } else {
        (a * k).sinh() / a
    }
}

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

impl Equation for Softening {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let square = scale.curvature_per_cm * scale.curvature_per_cm;
        // The forms part where the strip bends far.
        let (small, most) = if variant == 0 { (0.01, 1.0) } else { (1.0, 3.0) };
        let limits = vec![Limits::linear(-0.12 / square, most / square)];
        Search::over(small / square, limits, &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let cubic = parameters[0];
        let law = if variant == 0 { bent } else { bent_hyperbolically };
        system
            .observations
            .push(read_as(move |_, kappa| law(cubic, kappa)));
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn both_forms_begin_alike_and_the_hyperbolic_one_is_solved() {
        for b in [0.4, -0.4] {
            let (cubic, other) = (super::bent(b, 0.05), super::bent_hyperbolically(b, 0.05));
            assert!((cubic - 0.05 + b * 0.05_f64.powi(3)).abs() < 1e-5 * 0.05);
            assert!((cubic - other).abs() < 1e-5 * 0.05, "{b}: {cubic} {other}");
        }
        let (x, a) = (super::bent_hyperbolically(1.5, 2.0), 3.0);
        assert!(((a * x).sinh() / a - 2.0).abs() < 1e-12);
        assert!((super::bent_hyperbolically(-1.5, x) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn cubic_is_solved_and_folds_at_its_top() {
        for (b, k) in [(0.4, 1.3), (-0.08, 0.9), (2.0, -0.7), (1e-20, 0.5)] {
            let x = super::bent(b, k);
            assert!((x * (1.0 + b * x * x) - k).abs() < 1e-12);
        }
        assert!((super::bent(-1.0 / 3.0, 5.0) - 1.0).abs() < 1e-12);
    }
}
