//! A feature drawn to a value: by what is known of it, or along an interval.

use ieap_numerics::least_squares::Local;
use ieap_numerics::slopes;

use super::feature::Feature;
use super::problem::JointProblem;

/// Step of the derivative, in coordinates.
const STEP: f64 = 1e-5;

/// Draws a feature of a run to a value, as a reading of it with that error would.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spring {
    pub(crate) run: usize,
    pub(crate) feature: Feature,
    pub(crate) target: f64,
    /// One over the standard error.
    pub(crate) stiffness: f64,
}

impl Spring {
    /// How far the feature is from its target, in standard errors.
    pub(crate) fn gap(&self, problem: &JointProblem, at: &[f64]) -> f64 {
        self.stiffness * (self.target - self.feature.of(problem.layout, &problem.of_run(self.run, at)))
    }

    /// Adds the spring to a sum of squares at a place.
    pub(crate) fn add(&self, problem: &JointProblem, at: &[f64], local: &mut Local) {
        let gap = self.gap(problem, at);
        local.square += gap * gap;
        let gradient = gradient(problem, self.feature, self.run, at);
        for (row, left) in gradient.iter().enumerate() {
            local.descent[row] += self.stiffness * left * gap;
            for (column, right) in gradient.iter().enumerate() {
                local
                    .normal
                    .add(row, column, self.stiffness * self.stiffness * left * right);
            }
        }
    }
}

/// Derivatives of a feature by the coordinates.
pub(crate) fn gradient(problem: &JointProblem, feature: Feature, run: usize, at: &[f64]) -> Vec<f64> {
    let value = |at: &[f64]| feature.of(problem.layout, &problem.of_run(run, at));
    slopes::gradient(at, |_| STEP, value)
}
