//! Causes that several samples share, as the document of `ieap diagnose --json` states them.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::fits::as_object;
use crate::analysis::shared_effects::{SharedEffect, SharedParameter, left_out, sentence, shared_effects};
use crate::domain::{Campaign, Estimate, GroupDiagnosis, RunRecord};

/// A cause of several samples.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SharedEffectEntry {
    /// Material.
    pub material: String,
    /// Id of the effect.
    pub effect: String,
    /// Form that it takes, where it has several.
    pub variant: Option<String>,
    /// Groups in which it was accepted.
    pub groups: Vec<String>,
    /// Means over the samples by key; an object in JSON.
    #[serde(serialize_with = "as_object")]
    #[schemars(with = "BTreeMap<String, Estimate>")]
    pub parameters: Vec<(String, Estimate)>,
    /// Spread of every parameter.
    pub spread: Vec<SpreadEntry>,
    /// Every sample held against the others.
    pub left_out: Vec<LeftOutEntry>,
    /// The finding in words.
    pub sentence: String,
}

/// How far samples differ in a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SpreadEntry {
    /// Key of the parameter.
    pub parameter: String,
    /// Standard deviation between samples, in its unit.
    pub between_samples: Option<f64>,
    /// Probability of differences as large by the errors of the fits alone.
    pub p_equal: Option<f64>,
    /// Whether one value stands for all samples.
    pub is_one: bool,
}

/// A sample that was left out.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LeftOutEntry {
    /// Sample.
    pub sample: String,
    /// Group.
    pub group: String,
    /// Samples that the parameters are from.
    pub from: Vec<String>,
    /// Fall of the sum of squares beside the base model, in units of the noise; null where it cannot be held.
    pub deviance: Option<f64>,
    /// Its standard error.
    pub standard_error: Option<f64>,
    /// The same with the strength found from the sample itself.
    pub deviance_own_strength: Option<f64>,
}

/// Every shared cause.
pub(crate) fn shared_effect_entries(
    found: &[GroupDiagnosis],
    runs: &[RunRecord],
    campaign: &Campaign,
) -> Vec<SharedEffectEntry> {
    shared_effects(found, runs, campaign)
        .iter()
        .map(|effect| entry(effect, found))
        .collect()
}

fn entry(effect: &SharedEffect, found: &[GroupDiagnosis]) -> SharedEffectEntry {
    let finite = |number: f64| number.is_finite().then_some(number);
    SharedEffectEntry {
        material: effect.material.clone(),
        effect: effect.effect.clone(),
        variant: effect.variant.clone(),
        groups: effect.groups.iter().map(|(group, _)| group.clone()).collect(),
        parameters: effect
            .parameters
            .iter()
            .map(|parameter| (parameter.key.clone(), mean(parameter)))
            .collect(),
        spread: effect.parameters.iter().map(spread).collect(),
        left_out: left_out(effect, found)
            .map(|(sample, group, held)| LeftOutEntry {
                sample: sample.to_owned(),
                group: group.to_owned(),
                from: held.samples.clone(),
                deviance: finite(held.fall),
                standard_error: finite(held.standard_error),
                deviance_own_strength: finite(held.fall_own_strength),
            })
            .collect(),
        sentence: sentence(effect, found),
    }
}

fn mean(parameter: &SharedParameter) -> Estimate {
    match parameter.mean {
        Some(mean) => Estimate::determined(mean.value, mean.standard_error, mean.low_95, mean.high_95),
        None => Estimate::not_determined("no sample determines it"),
    }
}

fn spread(parameter: &SharedParameter) -> SpreadEntry {
    SpreadEntry {
        parameter: parameter.key.clone(),
        between_samples: parameter.mean.and_then(|mean| mean.between_samples),
        p_equal: parameter.p_equal,
        is_one: parameter.is_one(),
    }
}
