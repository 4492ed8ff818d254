//! The document that `ieap dma --json` prints: what was found in the modulus logs of a campaign.

use std::collections::BTreeMap;

use crate::analysis::dma::view::view;
use crate::domain::Estimate;
use schemars::JsonSchema;
use serde::Serialize;

use super::fits::as_object;
use crate::domain::tag::keys;
use crate::domain::{Issue, ModulusLog, Parameter};
use crate::pipeline::campaign::standing::{self, SetAside};
use crate::pipeline::{Context, PipelineError};
use crate::show::Block;

/// Schema of what is printed of modulus logs.
pub const SCHEMA: &str = "ieap/dma/1";

/// Every modulus log.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Dma {
    /// Logs in the order of their names.
    pub logs: Vec<LogEntry>,
    /// Logs that no result is made from, with the reasons.
    pub set_aside: Vec<SetAside>,
}

/// One log.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LogEntry {
    /// Path relative to the campaign.
    pub log: String,
    /// Revision.
    pub revision: u32,
    /// `ready`, `untagged` or `not_fitted`.
    pub state: &'static str,
    /// Hash of the readings.
    pub data_hash: String,
    /// Sample id.
    pub sample: Option<String>,
    /// Material id.
    pub material: Option<String>,
    /// Frequency, Hz.
    pub frequency_hz: Option<f64>,
    /// How |E*| was had; null where the log is not analysed.
    pub modulus_source: Option<String>,
    /// Readings of |E*| used.
    pub readings: Option<usize>,
    /// Humidity steps in order of time.
    pub steps: Vec<StepEntry>,
    /// Part of the change that the way back has undone at its end, percent.
    pub recovery_percent: Option<Estimate>,
    /// |E*| on the way back against that on the way out at the same humidity.
    pub hysteresis: Vec<HysteresisEntry>,
    /// What a reader must know.
    pub issues: Vec<Issue>,
}

/// One humidity step.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct StepEntry {
    /// When the humidity leaves its level, s.
    pub start_s: f64,
    /// When it has reached the next, s.
    pub settled_s: f64,
    /// End of the stretch after the step, s.
    pub end_s: f64,
    /// Numbers by key.
    #[serde(serialize_with = "as_object")]
    #[schemars(with = "BTreeMap<String, Estimate>")]
    pub estimates: Vec<(String, Estimate)>,
}

/// The hysteresis at one humidity.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct HysteresisEntry {
    /// The humidity, percent; null where none is held on both ways.
    pub relative_humidity_percent: Option<f64>,
    /// Relative difference, percent.
    pub hysteresis_percent: Estimate,
}

/// Reads the modulus logs: as a document, and as they are shown.
///
/// # Errors
/// The database cannot be read.
pub fn dma(context: &Context) -> Result<(Dma, Vec<Block>), PipelineError> {
    let (logs, set_aside) = standing::modulus_logs(context)?;
    let document = Dma {
        logs: logs.iter().map(|log| entry(context, log)).collect(),
        set_aside: set_aside.iter().map(|log| SetAside::of(&log.run)).collect(),
    };
    Ok((document, view(&logs, &context.campaign)))
}

fn entry(context: &Context, log: &ModulusLog) -> LogEntry {
    let run = &log.run;
    let analysis = log.analysis.as_ref();
    let sample = run.tag(keys::SAMPLE);
    let of_analysis = analysis.iter().flat_map(|found| &found.issues);
    LogEntry {
        log: run.path.clone(),
        revision: run.revision,
        state: run.state.key(),
        data_hash: run.data_hash.clone(),
        sample: sample.map(str::to_owned),
        material: sample.and_then(|id| Some(context.campaign.sample(id)?.material.clone())),
        frequency_hz: analysis.and_then(|found| found.frequency_hz),
        modulus_source: analysis.map(|found| found.modulus_source.clone()),
        readings: analysis.map(|found| found.readings),
        steps: analysis.map_or_else(Vec::new, |found| found.steps.iter().map(step).collect()),
        recovery_percent: analysis.and_then(|found| found.recovery()).cloned(),
        hysteresis: analysis.map_or_else(Vec::new, |found| {
            let all = found.hysteresis().into_iter();
            all.map(|(relative_humidity_percent, estimate)| HysteresisEntry {
                relative_humidity_percent,
                hysteresis_percent: estimate.clone(),
            })
            .collect()
        }),
        issues: run.issues.iter().chain(of_analysis).cloned().collect(),
    }
}

fn step(step: &crate::domain::ModulusStep) -> StepEntry {
    let estimate = |parameter: &Parameter| (parameter.key.clone(), parameter.estimate.clone());
    StepEntry {
        start_s: step.start_s,
        settled_s: step.settled_s,
        end_s: step.end_s,
        estimates: step.estimates.iter().map(estimate).collect(),
    }
}
