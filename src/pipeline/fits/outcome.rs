//! How fits came out: what is said of those that failed, how they are stored and counted.

use super::choice::HeldChoice;
use super::plan::Planned;
use crate::domain::{Fit, Issue, KnownParameter};
use crate::fit::FitError;
use crate::pipeline::campaign::context::{CODE_VERSION, now};
use crate::pipeline::{Context, PipelineError};
use crate::store::FitStamp;

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
    /// Groups that campaign.toml adopts a model for and that are not there.
    pub unknown_groups: Vec<String>,
    /// Choices of method, steps and model that hold for runs because somebody made them.
    pub choices: Vec<HeldChoice>,
}

impl FitSummary {
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

/// Stores outcomes, each with the hash of what it depends on.
pub(crate) fn save(
    context: &mut Context,
    outcomes: Vec<((&str, &Planned), Outcome)>,
    summary: &mut FitSummary,
) -> Result<(), PipelineError> {
    let now = now();
    let mut fits = Vec::new();
    for ((input_hash, Planned { task, chosen }), outcome) in outcomes {
        // A fault says nothing of the run: it is tried again, and said again, every time.
        let is_fault = matches!(&outcome, Err(issue) if issue.code == FAULT);
        let stamp = FitStamp {
            run_id: task.run_id,
            input_hash: if is_fault {
                String::new()
            } else {
                input_hash.to_owned()
            },
            code_version: CODE_VERSION.to_owned(),
            asked: chosen.asked.clone(),
        };
        match outcome {
            Ok(fit) => {
                summary.fitted += 1;
                if !fit.converged {
                    summary.not_converged.push(task.path.clone());
                }
                fits.push((stamp, fit));
            }
            Err(issue) => {
                context.store.save_fit_failure(&now, &stamp, &issue)?;
                summary.failed.push((task.path.clone(), issue));
            }
        }
    }
    Ok(context.store.save_fits(&now, &fits)?)
}
