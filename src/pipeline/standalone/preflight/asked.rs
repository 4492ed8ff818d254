//! What is to be found out.

use super::subject::Subject;
use super::trial::Trial;
use crate::pipeline::PipelineError;

/// Simulations of a plan where no number of them is asked for: an outcome that comes once in twenty is seen, and a plan
/// takes seconds.
pub const DRAWS: usize = 20;

/// What is to be found out before a run is made.
#[derive(Debug, Clone)]
pub struct Preflight {
    /// What the strip is taken to be, and the noise of its readings.
    pub subject: Subject,
    /// How the run is to be made.
    pub trial: Trial,
    /// Largest voltage that a change may go to, V.
    pub max_voltage_v: f64,
    /// Simulations of each way to make the run.
    pub draws: usize,
    /// Seed of their noise.
    pub seed: u64,
}

impl Preflight {
    /// Refuses what no run can have.
    ///
    /// # Errors
    /// What was found and what was needed.
    pub(super) fn check(&self) -> Result<(), PipelineError> {
        if self.draws == 0 {
            return Err(PipelineError::bad_argument(
                "--draws",
                "0".to_owned(),
                "1 or more",
            ));
        }
        let noises = [
            ("--current-noise", Some(&self.subject.current_noise)),
            ("--curvature-noise", self.subject.curvature_noise.as_ref()),
        ];
        for (what, noise) in noises {
            let size = noise.map_or(0.0, |noise| noise.standard_deviation);
            if !(size.is_finite() && size >= 0.0) {
                return Err(PipelineError::bad_argument(
                    what,
                    size.to_string(),
                    "a standard deviation of 0 or more",
                ));
            }
        }
        self.trial.check()
    }
}
