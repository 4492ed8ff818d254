//! A step and a spectrum of one strip in one likelihood, as tables show it.

use crate::policy::DIFFERS_BELOW;

use ieap_domain::{Estimate, Parameter};

/// What a step and a spectrum say by themselves and together.
#[derive(Debug, Clone, PartialEq)]
pub struct OneLikelihood {
    /// Row id of the step.
    pub run_id: i64,
    /// Its path.
    pub path: String,
    /// Path of the spectrum, with its sweep where it has several.
    pub spectrum: String,
    /// The numbers of the spectrum alone, by the keys of the step's.
    pub of_spectrum: Vec<(&'static str, Estimate)>,
    /// Both together; or why they are not taken so.
    pub both: Result<Both, String>,
}

/// One set of parameters of both.
#[derive(Debug, Clone, PartialEq)]
pub struct Both {
    /// Parameters with the intervals of both.
    pub parameters: Vec<Parameter>,
    /// Chance of a difference as large where both have one circuit.
    pub p: f64,
}

impl Both {
    /// Whether both can have this one set of parameters.
    pub fn agrees(&self) -> bool {
        self.p >= DIFFERS_BELOW
    }
}
