//! A step, a spectrum and the force of one strip in one likelihood, as tables show it.

use crate::policy::DIFFERS_BELOW;

use ieap_domain::{Estimate, Parameter};

/// What a step and a spectrum say by themselves, and together, with a run of the held strip where there is one.
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
    /// Path of the run in which the strip was held.
    pub held: Option<String>,
    /// All together; or why they are not taken so.
    pub both: Result<Both, String>,
}

/// One set of parameters of all.
#[derive(Debug, Clone, PartialEq)]
pub struct Both {
    /// Parameters with the intervals of all.
    pub parameters: Vec<Parameter>,
    /// Size of the moment per charge of the held strip, mN mm / C.
    pub moment_mn_mm_per_c: Option<Estimate>,
    /// Chance of a difference as large where all have one circuit.
    pub p: f64,
}

impl Both {
    /// Whether all can have this one set of parameters.
    pub fn agrees(&self) -> bool {
        self.p >= DIFFERS_BELOW
    }
}
