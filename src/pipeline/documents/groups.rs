//! What `ieap run --only fit --group` adds to the document of fits: one entry for every group.

use std::collections::BTreeMap;

use crate::domain::Estimate;
use crate::domain::number::fixed;
use schemars::JsonSchema;
use serde::Serialize;

use super::fits::{as_object, parameter_entries};
use crate::domain::{ChannelNoise, Issue, Nuisance};
use crate::fit::{GroupFit, Resampled};
use crate::model::FitModel;
use crate::pipeline::fits::groups::FittedGroup;

/// Chance below which runs that share parameters are said to differ in them.
const CHANCE: f64 = 1e-3;

/// One group of runs, fitted with shared parameters.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct GroupEntry {
    /// What its runs have in common.
    pub group: String,
    /// The runs fitted, by name.
    pub runs: Vec<String>,
    /// Runs that could not be part of it, with the reasons.
    pub left_out: Vec<LeftOut>,
    /// Model id.
    pub model: &'static str,
    /// Keys of the shared parameters.
    pub shared: Vec<String>,
    /// Whether the search converged.
    pub converged: bool,
    /// Why it stopped, or was not begun.
    pub why_stopped: String,
    /// Weighted sum of squared residuals over all runs; null where nothing was fitted.
    pub chi_square: Option<f64>,
    /// Readings minus parameters.
    pub degrees_of_freedom: Option<f64>,
    /// What sharing costs; null for a single run.
    pub sharing: Option<SharingCost>,
    /// Parameters that are the same in every run, by key.
    #[serde(serialize_with = "as_object")]
    #[schemars(with = "BTreeMap<String, Estimate>")]
    pub parameters: Vec<(String, Estimate)>,
    /// Every run by itself.
    pub fits: Vec<GroupRunEntry>,
    /// Issues of the group.
    pub issues: Vec<Issue>,
}

/// Likelihood ratio of sharing against every parameter free in every run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct SharingCost {
    /// Rise of the weighted sum of squares.
    pub chi_square_rise: f64,
    /// Parameters saved.
    pub parameters_saved: usize,
    /// Chance of such a rise where the runs do share them.
    pub p: f64,
}

/// One run of a group.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct GroupRunEntry {
    /// Path relative to the campaign.
    pub run: String,
    /// Readings used.
    pub n_samples: usize,
    /// All parameters, the shared ones included, by key.
    #[serde(serialize_with = "as_object")]
    #[schemars(with = "BTreeMap<String, Estimate>")]
    pub parameters: Vec<(String, Estimate)>,
    /// Bootstrap by key; empty where none was asked for.
    #[serde(serialize_with = "as_object")]
    #[schemars(with = "BTreeMap<String, BootstrapEntry>")]
    pub bootstrap: Vec<(String, BootstrapEntry)>,
    /// What was estimated beside them: edges, zeros, clocks.
    pub nuisances: Vec<Nuisance>,
    /// Coefficient of determination of the current.
    pub r_squared_current: Option<f64>,
    /// Coefficient of determination of the curvature.
    pub r_squared_curvature: Option<f64>,
    /// Noise and residual per channel.
    pub noise: Vec<ChannelNoise>,
    /// Issues.
    pub issues: Vec<Issue>,
}

/// What the bootstrap, refits to resampled residuals, says of one parameter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct BootstrapEntry {
    /// Standard deviation of the refits, unit of the parameter.
    pub standard_deviation: f64,
    /// 2.5 % point.
    pub low_95: f64,
    /// 97.5 % point.
    pub high_95: f64,
    /// Refits that counted.
    pub replicates: usize,
}

/// A run that could not be part of its group.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LeftOut {
    /// Path relative to the campaign.
    pub run: String,
    /// Why.
    pub issue: Issue,
}

/// The entry of a group that was fitted.
pub fn entry(fitted: FittedGroup) -> GroupEntry {
    let left_out = fitted.left_out.into_iter();
    let mut entry = GroupEntry {
        group: fitted.name,
        runs: fitted.runs,
        left_out: left_out.map(|(run, issue)| LeftOut { run, issue }).collect(),
        model: fitted.options.model.id,
        shared: fitted.options.shared.clone(),
        converged: false,
        why_stopped: "not fitted".to_owned(),
        chi_square: None,
        degrees_of_freedom: None,
        sharing: None,
        parameters: Vec::new(),
        fits: Vec::new(),
        issues: Vec::new(),
    };
    match fitted.outcome {
        Ok(fit) => fill(&mut entry, fitted.options.model, &fit),
        Err(issue) => entry.issues.push(issue),
    }
    entry
}

fn fill(entry: &mut GroupEntry, model: &FitModel, fit: &GroupFit) {
    entry.converged = fit.converged;
    entry.why_stopped.clone_from(&fit.why_stopped);
    entry.chi_square = Some(fit.chi_square);
    entry.degrees_of_freedom = Some(fit.degrees_of_freedom);
    let common: Vec<_> = fit.common_parameters(model).into_iter().cloned().collect();
    entry.parameters = parameter_entries(&common);
    entry.sharing = fit.sharing.as_ref().map(|sharing| SharingCost {
        chi_square_rise: sharing.chi_square_rise,
        parameters_saved: sharing.parameters_saved,
        p: sharing.p,
    });
    entry.fits = (fit.runs.iter().zip(&entry.runs).enumerate())
        .map(|(index, (run, name))| GroupRunEntry {
            run: name.clone(),
            n_samples: run.n_samples,
            parameters: parameter_entries(&run.parameters),
            bootstrap: fit
                .bootstrap
                .get(index)
                .map_or_else(Vec::new, |all| bootstrap_entries(all)),
            nuisances: run.nuisances.clone(),
            r_squared_current: run.r_squared_current,
            r_squared_curvature: run.r_squared_curvature,
            noise: run.noise.clone(),
            issues: run.issues.clone(),
        })
        .collect();
    if let Some(sharing) = entry.sharing.filter(|sharing| sharing.p < CHANCE) {
        let message = format!(
            "the runs differ in what they were made to share: that raises the weighted sum of squares by {} for {} \
             parameters fewer, which chance does in less than one of {} cases",
            fixed(sharing.chi_square_rise, 0),
            sharing.parameters_saved,
            fixed(CHANCE.recip(), 0)
        );
        entry.issues.push(
            Issue::warning("group-differs", message)
                .mend("leave free what differs with --free KEYS, or group the runs more finely with group_by in campaign.toml"),
        );
    }
}

fn bootstrap_entries(resampled: &[Resampled]) -> Vec<(String, BootstrapEntry)> {
    let one = |of: &Resampled| {
        let entry = BootstrapEntry {
            standard_deviation: of.standard_deviation,
            low_95: of.low_95,
            high_95: of.high_95,
            replicates: of.replicates,
        };
        (of.key.clone(), entry)
    };
    resampled.iter().map(one).collect()
}
