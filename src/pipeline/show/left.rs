//! What is left to be made in a campaign, after work that was cut short.

use super::report::is_current;
use crate::domain::{RunRecord, RunState};
use crate::pipeline::campaign::standing;
use crate::pipeline::findings::diagnose;
use crate::pipeline::fits::outcome::is_of_failed_fit;
use crate::pipeline::{Context, PipelineError};

/// What is left to be made. New files are not looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Left {
    /// Runs without a fit that may have one.
    pub fits: usize,
    /// Groups without a finding, or with one that is out of date.
    pub diagnoses: usize,
    /// Whether the report does not show all that is known.
    pub report: bool,
}

/// Counts what is left.
///
/// # Errors
/// The database cannot be read.
pub fn left(context: &Context) -> Result<Left, PipelineError> {
    let runs = standing::all(context)?;
    let waits = |issues: &[_]| !issues.iter().any(is_of_failed_fit);
    let is_due = |run: &&RunRecord| run.state == RunState::Ready && run.fit.is_none() && waits(&run.issues);
    let fits = runs.iter().filter(is_due).count();
    let waiting = diagnose::waiting(context, runs)?;
    Ok(Left {
        fits,
        diagnoses: waiting.missing.len() + waiting.outdated.len(),
        report: !is_current(context)?,
    })
}
