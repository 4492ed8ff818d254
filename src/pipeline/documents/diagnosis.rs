//! The document that `ieap diagnose --json` prints: the current findings of a campaign.

use crate::analysis::groups::is_called;
pub use crate::analysis::groups::title as group_title;
pub use std::collections::BTreeMap;
use std::ops::Deref;

use crate::domain::Estimate;

use schemars::JsonSchema;
use serde::ser::Error;
use serde::{Serialize, Serializer};

use super::doubted::{self, DoubtedEntry};
use super::fits::{as_object, parameter_entries};
use super::lengthwise::LumpedOrDistributedEntry;
use super::shared_effects::{SharedEffectEntry, shared_effect_entries};
use crate::analysis::laws::doubt::{Doubts, Findings};
use crate::analysis::online::OnlineDecision;
use crate::analysis::study::{Study, sentence};
use crate::domain::{EffectFinding, Fault, GroupDiagnosis, Verdict};
use crate::pipeline::campaign::standing::{self, Runs, SetAside};
use crate::pipeline::findings::current::findings_among;
use crate::pipeline::findings::kept;
use crate::pipeline::findings::model_free::curves_after_steps;
use crate::pipeline::findings::next_runs::{self, PlannedIds, PlannedRun};
use crate::pipeline::findings::study;
use crate::pipeline::fits::input_hash::library_hash;
use crate::pipeline::infra::fault::{or_nothing, step};
use crate::pipeline::{Context, DiagnoseChoice, PipelineError};

/// Every current finding.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DiagnosisDocument {
    /// Always `ieap/diagnosis/4`.
    pub schema: &'static str,
    /// Hash of the library of effects.
    pub library: String,
    /// Seed of the draws.
    pub seed: u64,
    /// Draws of what chance does.
    pub draws: usize,
    /// Id of the base model.
    pub base_model: &'static str,
    /// Every run alone, by name.
    pub runs: Vec<RunEntry>,
    /// Every group, by name.
    pub groups: Vec<GroupEntry>,
    /// Runs that take no part, with the reason.
    pub set_aside: Vec<SetAside>,
    /// Causes that several samples of a material share.
    pub campaign_effects: Vec<SharedEffectEntry>,
    /// Groups whose fits are in doubt, and what that does to the questions across runs.
    pub campaign_doubted: Vec<DoubtedEntry>,
    /// Runs to make next, the first first.
    pub campaign_next_runs: Vec<PlannedRun>,
    /// What the study asked, in words.
    pub campaign_contrasts: Vec<String>,
    /// The same with its numbers, and the details.
    pub study: Study,
    /// Steps that a fault of the program stopped: what they would have given is missing.
    pub faults: Vec<Fault>,
}

/// One run alone.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RunEntry {
    /// Path relative to the campaign.
    pub run: String,
    /// What is said.
    pub verdict: Verdict,
    /// The finding in one plain sentence.
    pub sentence: String,
    /// Probability of residuals at least as bad by chance.
    pub p_misfit: Option<f64>,
    /// The same over all runs of the campaign.
    pub q_misfit: Option<f64>,
    /// What could be claimed of it when it came.
    pub online: Option<OnlineDecision>,
    /// Accepted effects.
    pub effects: Vec<EffectEntry>,
    /// Ids of the effects that may be the cause.
    pub set: Vec<String>,
    /// Whether the run needs the distributed model; null where its fit does not say.
    pub lumped_or_distributed: Option<LumpedOrDistributedEntry>,
}

/// One group.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct GroupEntry {
    /// What was found.
    #[serde(flatten, serialize_with = "as_told")]
    found: GroupDiagnosis,
    /// Accepted effects.
    pub effects: Vec<EffectEntry>,
    /// Whether the gain is clear: every held-out part comes out better, or the 95 % interval of the fall of the deviance does
    /// not reach zero.
    pub gain_is_clear: Option<bool>,
    /// The least error of the base model that would have been seen, beside what was granted.
    pub sensitivity: Sensitivity,
    /// Which of its runs need the distributed model, as far as their fits say.
    pub lumped_or_distributed: Vec<LumpedOrDistributedEntry>,
}

impl Deref for GroupEntry {
    type Target = GroupDiagnosis;

    fn deref(&self) -> &GroupDiagnosis {
        &self.found
    }
}

/// Of a finding what stands in no other form beside it, and is not only drawn.
fn as_told<S: Serializer>(found: &GroupDiagnosis, serializer: S) -> Result<S::Ok, S::Error> {
    let mut told = serde_json::to_value(found).map_err(S::Error::custom)?;
    if let Some(told) = told.as_object_mut() {
        told.retain(|key, _| !ELSEWHERE.contains(&key.as_str()));
    }
    told.serialize(serializer)
}

/// What the schema of a finding skips.
const ELSEWHERE: [&str; 6] = [
    "is_fault",
    "effects",
    "residuals",
    "held_out_residuals",
    "from_others",
    "visible_percent",
];

/// The least error of the base model that would have been seen in 95 of 100 such groups, percent of the ranges.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Sensitivity {
    /// Nuisances that were granted to the readings: `edges`, `zero`, `noise`, `scatter`.
    pub beside: Vec<&'static str>,
    /// Of the current.
    pub current_percent: Option<f64>,
    /// Of the curvature.
    pub curvature_percent: Option<f64>,
}

/// An accepted effect.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct EffectEntry {
    /// Id of the effect.
    pub effect: String,
    /// Form that it takes, where it has several.
    pub variant: Option<String>,
    /// Parameters by key; an object in JSON.
    #[serde(serialize_with = "as_object")]
    #[schemars(with = "BTreeMap<String, Estimate>")]
    pub parameters: Vec<(String, Estimate)>,
    /// Probability of such a gain by chance, over all candidates.
    pub p: f64,
    /// The same over all groups of the campaign.
    pub q: Option<f64>,
    /// Ids of effects that explain the readings as well.
    pub twins: Vec<String>,
}

/// The document of the current findings; of one group and its runs where one is named.
///
/// # Errors
/// The model is not known, or the database cannot be read.
pub fn diagnosis_document(
    context: &Context,
    choice: &DiagnoseChoice,
    group: Option<&str>,
) -> Result<DiagnosisDocument, PipelineError> {
    let options = choice.options(&context.campaign)?;
    let all = standing::all(context)?;
    let mut findings = findings_among(context, &all)?;
    if let Some(name) = group {
        findings.groups.retain(|found| is_called(&found.group, name));
        let members: Vec<String> = findings
            .groups
            .iter()
            .flat_map(|found| found.runs.clone())
            .collect();
        findings.runs.retain(|found| members.contains(&found.group));
    }
    let ids = PlannedIds::of(context, &all)?;
    let Runs {
        speaking: runs,
        set_aside,
    } = Runs::of(all);
    let (mut faults, kept) = (Vec::new(), kept::values(context));
    let curves = step("curves after the steps", || {
        curves_after_steps(context, &runs, &kept)
    });
    let curves = or_nothing(curves, &mut faults)?;
    let study = || Ok(study::of_runs(context, &runs, &findings, &curves, &kept));
    let study = or_nothing(step("what the study asked", study), &mut faults)?;
    let plan = || match group {
        Some(_) => Ok(Vec::new()),
        None => Ok(next_runs::plan_from(
            context,
            (&runs, &ids),
            &study,
            &findings.groups,
        )),
    };
    let plan = or_nothing(step("which runs to make next", plan), &mut faults)?;
    let of_groups = Findings {
        groups: &findings.groups,
        runs: &findings.runs,
    };
    let told_of_doubts = match group {
        Some(_) => Vec::new(),
        None => Doubts::new(of_groups, &runs).told(of_groups),
    };
    let campaign_effects = shared_effect_entries(&findings.groups, &runs, &context.campaign);
    let told: Vec<_> = runs.iter().filter_map(LumpedOrDistributedEntry::of).collect();
    Ok(DiagnosisDocument {
        schema: "ieap/diagnosis/4",
        library: library_hash(),
        seed: options.seed,
        draws: options.draws,
        base_model: options.model.id,
        faults,
        runs: findings
            .runs
            .into_iter()
            .map(|found| {
                let online = findings.turns.get(&found.group).copied();
                run_entry(found, online, &told)
            })
            .collect(),
        groups: findings
            .groups
            .into_iter()
            .map(|found| group_entry(found, &told))
            .collect(),
        set_aside: set_aside.iter().map(SetAside::of).collect(),
        campaign_effects,
        campaign_doubted: doubted::entries(&told_of_doubts),
        campaign_next_runs: plan,
        campaign_contrasts: study.asked().map(sentence).collect(),
        study,
    })
}

fn run_entry(
    found: GroupDiagnosis,
    online: Option<OnlineDecision>,
    told: &[LumpedOrDistributedEntry],
) -> RunEntry {
    RunEntry {
        lumped_or_distributed: told.iter().find(|entry| entry.run == found.group).cloned(),
        run: found.group,
        online,
        verdict: found.verdict,
        sentence: found.sentence,
        p_misfit: found.p_misfit,
        q_misfit: found.q_misfit,
        effects: found.effects.iter().map(effect_entry).collect(),
        set: found.set,
    }
}

/// A finding as the document states it.
pub fn group_entry(found: GroupDiagnosis, told: &[LumpedOrDistributedEntry]) -> GroupEntry {
    let of_group = |entry: &&LumpedOrDistributedEntry| found.runs.contains(&entry.run);
    GroupEntry {
        effects: found.effects.iter().map(effect_entry).collect(),
        gain_is_clear: found.gain.as_ref().map(|gain| gain.proof.is_clear()),
        sensitivity: Sensitivity {
            beside: if found.scatter_is_noise {
                vec!["edges", "zero", "noise", "scatter"]
            } else {
                vec!["edges", "zero", "noise"]
            },
            current_percent: found.visible_percent.current,
            curvature_percent: found.visible_percent.curvature,
        },
        lumped_or_distributed: told.iter().filter(of_group).cloned().collect(),
        found,
    }
}

fn effect_entry(finding: &EffectFinding) -> EffectEntry {
    EffectEntry {
        effect: finding.effect.clone(),
        variant: finding.variant.clone(),
        parameters: parameter_entries(&finding.parameters),
        p: finding.p,
        q: finding.q,
        twins: finding.twins.clone(),
    }
}
