//! Fits of runs that no campaign holds.

use serde::Serialize;

use super::RunAtHand;
use crate::domain::{
    AskedFit, Channel, ChannelNoise, Drive, Estimate, Fit, Issue, KnownParameter, Nuisance, Severity,
};
use crate::fit::{EdgeTimes, FitError, FitInput, FitOptions, distributed, placed_drive};
use crate::ingest::derived;
use crate::ingest::formats::columns::COLUMN_REFUSED;
use crate::model::ModelChoice;
use crate::pipeline::campaign::context::{BUILT_FROM, CODE_VERSION};
use crate::pipeline::documents::fits::{as_object, parameter_entries};
use crate::pipeline::fits::choice::{FitChoice, options_of};
use crate::pipeline::fits::input_hash::input_hash;
use crate::pipeline::fits::runs::fit_one;

/// A fit as `ieap fit --json` states it, less what only a campaign knows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitAtHand {
    /// Name of the run.
    pub run: String,
    /// Model id.
    pub model: String,
    /// Version of the model.
    pub model_version: u32,
    /// Version of the program that fitted.
    pub code_version: &'static str,
    /// Commit that it was built from.
    pub built_from: &'static str,
    /// Hash of the readings.
    pub data_hash: String,
    /// Hash of everything that the fit depends on.
    pub input_hash: String,
    /// Whether the search converged.
    pub converged: bool,
    /// Why it stopped.
    pub why_stopped: String,
    /// How the minimum was searched.
    pub method: String,
    /// Readings used.
    pub n_samples: usize,
    /// Parameters by key, in the model's order; an object in JSON.
    #[serde(serialize_with = "as_object")]
    pub parameters: Vec<(String, Estimate)>,
    /// What was estimated beside them: edges, zeros, clocks, charge that no reading saw.
    pub nuisances: Vec<Nuisance>,
    /// Coefficient of determination of the current.
    pub r_squared_current: Option<f64>,
    /// Coefficient of determination of the curvature.
    pub r_squared_curvature: Option<f64>,
    /// Noise and residual per channel.
    pub noise: Vec<ChannelNoise>,
    /// Issues of the readings and of the fit.
    pub issues: Vec<Issue>,
}

/// How a run is fitted: what is left open is as in a campaign that states nothing.
///
/// # Errors
/// The model or the method is not known, or the model is one of a group of runs.
pub fn fit_options(choice: &FitChoice) -> Result<FitOptions<'static>, Issue> {
    options_as_asked(&choice.asked())
}

/// As [`fit_options`].
pub(super) fn options_as_asked(said: &AskedFit) -> Result<FitOptions<'static>, Issue> {
    let refused = |error: FitError| Issue::error("not-known", error.to_string()).at("model or method");
    let stated = said.model.as_deref().unwrap_or(FitOptions::default().model.id);
    let model = ModelChoice::parse(stated).map_err(|error| refused(error.into()))?;
    if model.is_extended() {
        let message = format!("{model} is a model of a group of runs, whose effects they share");
        let issue = Issue::error("model-of-group", message).at("model");
        return Err(issue.mend(format!(
            "fit a run by itself with {}, or adopt the model in a campaign",
            model.base.id
        )));
    }
    options_of(said, &model).map_err(refused)
}

/// Fits a run, `known` of its parameters beforehand: the fit with its curves, and how `ieap fit --json` states it.
///
/// # Errors
/// There is nothing to fit, or a fault of the program stopped the fit.
pub fn fit(
    run: &RunAtHand,
    options: &FitOptions,
    known: &[KnownParameter],
) -> Result<(Fit, FitAtHand), Issue> {
    let fit = fit_one(&run.task, &run.channels, options, known).map_err(|issue| explained(issue, run))?;
    let stated = FitAtHand {
        run: run.task.path.clone(),
        model: fit.model.clone(),
        model_version: fit.model_version,
        code_version: CODE_VERSION,
        built_from: BUILT_FROM,
        data_hash: run.task.data_hash.clone(),
        input_hash: input_hash(&run.task, options, known),
        converged: fit.converged,
        why_stopped: fit.why_stopped.clone(),
        method: fit.method.clone(),
        n_samples: fit.n_samples,
        parameters: parameter_entries(&fit.parameters),
        nuisances: fit.nuisances.clone(),
        r_squared_current: fit.r_squared_current,
        r_squared_curvature: fit.r_squared_curvature,
        noise: fit.noise.clone(),
        issues: run.issues.iter().chain(&fit.issues).cloned().collect(),
    };
    Ok((fit, stated))
}

/// The drive of a run with its edges where a fit of it takes them to be: of those that only readings tell, the fit looks for
/// the time between these.
pub fn drive_as_fitted(run: &RunAtHand, options: &FitOptions) -> Drive {
    let drive = &run.task.drive;
    if options.model.id == distributed::MODEL_ID {
        return EdgeTimes::of(drive).drive().clone();
    }
    let channels = derived::responses(&run.channels, run.task.length_cm, Some(drive));
    let input = FitInput {
        channels: &channels,
        drive,
        area_cm2: run.task.area_cm2,
    };
    placed_drive(&input, options).unwrap_or_else(|_| drive.clone())
}

/// Why there is nothing to fit: a response whose column was refused says it better.
fn explained(issue: Issue, run: &RunAtHand) -> Issue {
    let responds = run.channels.iter().any(Channel::is_response);
    let refused = run.issues.iter().find(|issue| issue.code == COLUMN_REFUSED);
    match refused.filter(|_| !responds) {
        Some(refused) => Issue {
            severity: Severity::Error,
            ..refused.clone()
        },
        None => issue,
    }
}
