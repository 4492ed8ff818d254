//! Curvature computed from the tip's displacement by a formula for small bending.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{Observation, RunContext, System};

/// See the module.
pub(super) struct TipFormula;

static ABOUT: About = About {
    id: "tip-formula",
    code: "G4",
    summary: "small-bending formula used beyond its range (no free strength)",
    equation: "read kappa = kappa (1 - (kappa L)^2/3) for a tip at arc length L, kappa (1 + (kappa L)^2/4) for a laser at a fixed distance",
    variants: &["arc", "axis"],
    parameters: &[EffectParameter {
        key: "applied",
        symbol: "g",
        unit: "",
        meaning: "1 where the formula was used, 0 where it was not",
    }],
    vanishes: "g = 0",
    signature: "cubic in the curvature, near the peak only",
    twins: &["softening", "coupling-saturation"],
    separated_by: "the strip's length predicts its size: nothing is free; or curvature from a fitted arc",
    sources: "geometry of an arc of a circle",
};

struct Formula {
    per_square: f64,
}

impl Observation for Formula {
    fn observe(&self, _clock_s: &[f64], curvature_per_cm: &mut [f64]) {
        for kappa in curvature_per_cm {
            *kappa *= 1.0 + self.per_square * *kappa * *kappa;
        }
    }
}

impl Equation for TipFormula {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.length_cm.is_none() {
            return Search::none();
        }
        Search::over(1.0, vec![Limits::held()], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let Some(length_cm) = run.length_cm else {
            return;
        };
        let per_square = if variant == 0 { -1.0 / 3.0 } else { 0.25 };
        system.observations.push(Box::new(Formula {
            per_square: parameters[0] * per_square * length_cm * length_cm,
        }));
    }
}
