//! What is said of work that was interrupted: what is kept, what is left, which verb goes on.

use super::exit::CliError;
use super::output::Output;
use super::signals;
use crate::domain::words::counted;
use crate::pipeline::{Context, Observer, left};

/// The verb that goes on after an interruption, and what it makes beside fits.
pub struct GoesOn {
    /// Its name.
    pub verb: &'static str,
    /// Whether it diagnoses.
    pub diagnoses: bool,
    /// Whether it writes the report.
    pub reports: bool,
}

/// Says what is left of work that was interrupted.
pub fn interrupted(context: &Context, goes_on: &GoesOn, output: &Output) -> Result<u8, CliError> {
    output.end();
    let left = left(context)?;
    let mut parts = Vec::new();
    if left.fits > 0 {
        parts.push(format!("{} to fit", counted(left.fits, "run")));
    }
    if left.diagnoses > 0 && goes_on.diagnoses {
        parts.push(format!("{} to diagnose", counted(left.diagnoses, "group")));
    }
    if left.report && goes_on.reports {
        parts.push("the report to be written anew".to_owned());
    }
    let left = if parts.is_empty() {
        "new files, if there are any".to_owned()
    } else {
        parts.join(", ")
    };
    output.message(&format!(
        "Interrupted. What was made so far is kept. Left: {left}. `ieap {}` goes on from there.",
        goes_on.verb
    ));
    Ok(signals::status())
}
