//! The document that `ieap fit --json` prints: the current fits of a campaign.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use super::groups::GroupEntry;
use super::lengthwise::LumpedOrDistributedEntry;
use crate::analysis::{same_tags, sequence};
use crate::domain::tag::keys;
use crate::domain::{ChannelNoise, Estimate, Issue, Nuisance, Parameter, RunOrigin, RunRecord};
use crate::pipeline::campaign::standing::{self, Runs, SetAside};
use crate::pipeline::{Context, PipelineError};

/// Every current fit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FitsDocument {
    /// Always `ieap/fits/1`.
    pub schema: &'static str,
    /// Fits in the order of the runs' names.
    pub fits: Vec<FitEntry>,
    /// Runs without a fit, with the reasons.
    pub not_fitted: Vec<NotFitted>,
    /// Runs that no result is made from, with the reasons.
    pub set_aside: Vec<SetAside>,
    /// Groups fitted with shared parameters, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub groups: Option<Vec<GroupEntry>>,
}

/// One fit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FitEntry {
    /// Path relative to the campaign.
    pub run: String,
    /// Revision of the run.
    pub revision: u32,
    /// Model id.
    pub model: String,
    /// Version of the model.
    pub model_version: u32,
    /// Version of the program that fitted.
    pub code_version: Option<String>,
    /// Commit that it was built from.
    pub built_from: Option<String>,
    /// Hash of the readings.
    pub data_hash: String,
    /// Sample id.
    pub sample: Option<String>,
    /// Material id.
    pub material: Option<String>,
    /// Environment id.
    pub environment: Option<String>,
    /// Relative humidity, percent.
    pub relative_humidity_percent: Option<f64>,
    /// Nominal voltage, V.
    pub voltage_v: Option<f64>,
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
    #[schemars(with = "BTreeMap<String, Estimate>")]
    pub parameters: Vec<(String, Estimate)>,
    /// What was estimated beside them: edges, zeros, clocks, charge that no reading saw.
    pub nuisances: Vec<Nuisance>,
    /// Coefficient of determination of the current.
    pub r_squared_current: Option<f64>,
    /// Coefficient of determination of the curvature.
    pub r_squared_curvature: Option<f64>,
    /// Noise and residual per channel.
    pub noise: Vec<ChannelNoise>,
    /// Clocks with their offsets, flags and profiles that the readings rest on.
    pub origin: RunOrigin,
    /// Whether the run needs the distributed model; null where the fit does not say.
    pub lumped_or_distributed: Option<LumpedOrDistributedEntry>,
    /// Issues of the run and of the fit.
    pub issues: Vec<Issue>,
}

/// Pairs as an object.
pub(crate) fn as_object<T: Serialize, S: Serializer>(
    entries: &[(String, T)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(entries.iter().map(|(key, entry)| (key, entry)))
}

/// A run without a fit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct NotFitted {
    /// Path relative to the campaign.
    pub run: String,
    /// `untagged`, `not_fitted` or `ready`.
    pub state: &'static str,
    /// Why.
    pub issues: Vec<Issue>,
}

/// Reads the current fits.
///
/// # Errors
/// The database cannot be read.
pub fn fits_document(context: &Context) -> Result<FitsDocument, PipelineError> {
    let Runs {
        speaking: mut runs,
        set_aside,
    } = standing::runs(context)?;
    same_tags::annotate(&mut runs);
    sequence::annotate(&mut runs);
    let not_fitted = runs.iter().filter(|run| run.fit.is_none()).map(|run| NotFitted {
        run: run.path.clone(),
        state: run.state.key(),
        issues: run.issues.clone(),
    });
    Ok(FitsDocument {
        schema: "ieap/fits/1",
        fits: runs.iter().filter_map(|run| entry(context, run)).collect(),
        not_fitted: not_fitted.collect(),
        set_aside: set_aside.iter().map(SetAside::of).collect(),
        groups: None,
    })
}

/// Parameters by key.
pub(crate) fn parameter_entries(parameters: &[Parameter]) -> Vec<(String, Estimate)> {
    let one = |parameter: &Parameter| (parameter.key.clone(), parameter.estimate.clone());
    parameters.iter().map(one).collect()
}

fn entry(context: &Context, run: &RunRecord) -> Option<FitEntry> {
    let fit = run.fit.as_ref()?;
    let sample = run.tag(keys::SAMPLE).map(str::to_owned);
    let material = sample
        .as_deref()
        .and_then(|id| context.campaign.sample(id))
        .map(|s| s.material.clone());
    let made_by = run.fit_made_by.as_ref();
    Some(FitEntry {
        run: run.path.clone(),
        revision: run.revision,
        model: fit.model.clone(),
        model_version: fit.model_version,
        code_version: made_by.map(|by| by.version.to_string()),
        built_from: made_by.map(|by| by.built_from.to_string()),
        data_hash: run.data_hash.clone(),
        material,
        sample,
        environment: run.tag(keys::ENVIRONMENT).map(str::to_owned),
        relative_humidity_percent: run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT),
        voltage_v: run.tag_number(keys::VOLTAGE_V),
        converged: fit.converged,
        why_stopped: fit.why_stopped.clone(),
        method: fit.method.clone(),
        n_samples: fit.n_samples,
        parameters: parameter_entries(&fit.parameters),
        nuisances: fit.nuisances.clone(),
        r_squared_current: fit.r_squared_current,
        r_squared_curvature: fit.r_squared_curvature,
        noise: fit.noise.clone(),
        origin: run.origin.clone(),
        lumped_or_distributed: LumpedOrDistributedEntry::of(run),
        issues: run.issues.iter().chain(&fit.issues).cloned().collect(),
    })
}
