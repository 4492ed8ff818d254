//! Problems with certified answers: the nonlinear regression sets of the Statistical Reference Datasets of NIST
//! (https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml), against which the least-squares kernel is held.

mod average;
mod digits;
mod higher;
mod lower;

/// How hard NIST calls a problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Difficulty {
    Lower,
    Average,
    Higher,
}

/// Value of a model and its derivatives with respect to the parameters `b`, at `x`.
type Model = fn(b: &[f64], x: f64, slopes: &mut [f64]) -> f64;

/// A problem with data, both official starts and the certified answer.
pub(super) struct Problem {
    /// `NIST StRD, <name>`.
    pub(super) source: &'static str,
    pub(super) difficulty: Difficulty,
    pub(super) model: Model,
    pub(super) x: &'static [f64],
    pub(super) y: &'static [f64],
    pub(super) starts: [&'static [f64]; 2],
    pub(super) certified: &'static [f64],
    /// Certified residual sum of squares.
    pub(super) square: f64,
}

/// Every problem, by difficulty.
pub(super) fn problems() -> impl Iterator<Item = &'static Problem> {
    lower::PROBLEMS
        .iter()
        .chain(&average::PROBLEMS)
        .chain(&higher::PROBLEMS)
}
