//! How fits came out: what is said of those that failed, how they are stored and counted.

use super::choice::HeldChoice;
use super::plan::Planned;
use crate::domain::{Fit, Issue, KnownParameter};
use crate::fit::FitError;
use crate::pipeline::campaign::context::now;
use crate::pipeline::{Context, PipelineError};
use crate::store::{AskedOf, NewResult};

/// What `fit` did.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct FitSummary {
    /// Runs fitted.
    pub fitted: usize,
    /// Runs whose fit was up to date.
    pub up_to_date: usize,
    /// Runs that could not be fitted, with the reason.
    pub failed: Vec<(String, Issue)>,
    /// Runs whose search did not converge.
    pub not_converged: Vec<String>,
    /// Runs that are left for the next call: what their fits depend on changed each time that they were made.
    pub changing: Vec<String>,
    /// Groups that campaign.toml adopts a model for and that are not there.
    pub unknown_groups: Vec<String>,
    /// Choices of method, steps and model that hold for runs because somebody made them.
    pub choices: Vec<HeldChoice>,
}

impl FitSummary {
    /// Adds what was fitted later, of runs that changed in between.
    pub(crate) fn and_then(&mut self, later: FitSummary) {
        self.fitted += later.fitted;
        self.failed.extend(later.failed);
        self.not_converged.extend(later.not_converged);
        self.changing = later.changing;
    }

    /// Whether a fault of the program stopped a fit.
    pub fn has_fault(&self) -> bool {
        self.failed.iter().any(|(_, issue)| issue.code == FAULT)
    }
}

pub(crate) type Outcome = Result<Fit, Issue>;

/// What is said of a run whose fit a fault of the program stopped.
pub(crate) fn fit_fault(what: &str, reason: &str) -> Issue {
    Issue::fault(FAULT, what, reason).mend("report it with the runs' files; all others are not affected")
}

/// What is said where known parameters take no part in a fit.
pub(crate) fn known_not_used(known: &[KnownParameter], model: &str) -> Issue {
    let known: Vec<String> = known.iter().map(KnownParameter::to_string).collect();
    let message = format!(
        "known and not used: {}; fits with {model} take all parameters from the readings",
        known.join(", ")
    );
    Issue::note("known-not-used", message)
}

/// Code of what is said of a run whose fit failed by its readings.
pub(crate) const NOT_FITTED: &str = "not-fitted";

/// Code of what is said of a run whose fit a fault of the program stopped.
pub const FAULT: &str = "fit-fault";

pub(crate) fn not_fitted(error: FitError) -> Issue {
    Issue::warning(NOT_FITTED, error.to_string())
}

/// Whether that is said of a run whose fit was tried and failed.
pub(crate) fn is_of_failed_fit(issue: &Issue) -> bool {
    [NOT_FITTED, FAULT].iter().any(|code| issue.code == *code)
}

impl FitSummary {
    /// Counts what came of a run.
    pub(crate) fn took(&mut self, run: &str, outcome: &Outcome) {
        match outcome {
            Ok(fit) => {
                self.fitted += 1;
                if !fit.converged {
                    self.not_converged.push(run.to_owned());
                }
            }
            Err(issue) => self.failed.push((run.to_owned(), issue.clone())),
        }
    }
}

/// Stores fits of these runs, and how those were asked for that came out; tells of each whether it is stored.
pub(crate) fn store<'p>(
    context: &mut Context,
    results: &[NewResult<'_, Fit>],
    of: impl Iterator<Item = &'p Planned>,
) -> Result<Vec<bool>, PipelineError> {
    let asked: Vec<AskedOf<'_>> = of.map(|run| (run.task.run_id, &run.chosen.asked)).collect();
    Ok(context.store.save_fits(&now(), results, &asked)?)
}
