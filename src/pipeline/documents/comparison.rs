//! The document that `ieap compare --json` prints: models held against each other on the same runs.

use schemars::JsonSchema;
use serde::Serialize;

use crate::analysis::models_compared::{ComparedCondition, ComparedModel};
use crate::domain::{ModelScore, RunComparison};
use crate::pipeline::findings::compare::CompareSummary;

/// Models held against each other on the same runs.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ComparisonDocument {
    /// Always `ieap/comparison/1`.
    pub schema: &'static str,
    /// Runs of one material in the same surroundings: which model is best there.
    pub conditions: Vec<ConditionEntry>,
    /// Run by run, what every model leaves.
    pub runs: Vec<RunEntry>,
    /// Runs on which no model could be fitted.
    pub not_compared: Vec<NotCompared>,
    /// Groups of runs whose comparison stopped on an internal fault.
    pub faults: Vec<String>,
}

/// The models on the runs of one material in one environment.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ConditionEntry {
    /// Material.
    pub material: String,
    /// Environment, with its humidity where it was measured at several.
    pub surroundings: String,
    /// Column of the response that tells the models apart: the curvature where it was measured.
    pub deciding: &'static str,
    /// Paths of the runs, the lowest voltage first.
    pub runs: Vec<String>,
    /// Every model, the best first; those that do not describe all runs stand last.
    pub models: Vec<ComparedModel>,
    /// The answer in words.
    pub sentence: String,
}

/// A run.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RunEntry {
    /// Path of the run.
    pub run: String,
    /// Every model, in the order asked for.
    pub models: Vec<ModelScore>,
}

/// A run on which no model could be fitted.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct NotCompared {
    /// Path of the run.
    pub run: String,
    /// Why.
    pub reason: String,
}

/// What was compared, as the document.
pub fn comparison_document(summary: &CompareSummary) -> ComparisonDocument {
    let condition = |found: &ComparedCondition| ConditionEntry {
        material: found.material.clone(),
        surroundings: found.surroundings.clone(),
        deciding: found.deciding.column(),
        runs: (found.comparisons.iter())
            .map(|&place| summary.comparisons[place].run.clone())
            .collect(),
        models: found.models.clone(),
        sentence: found.sentence.clone(),
    };
    let run = |found: &RunComparison| RunEntry {
        run: found.run.clone(),
        models: found.models.clone(),
    };
    let not_compared = |(run, reason): &(String, String)| NotCompared {
        run: run.clone(),
        reason: reason.clone(),
    };
    ComparisonDocument {
        schema: "ieap/comparison/1",
        conditions: summary.conditions.iter().map(condition).collect(),
        runs: summary.comparisons.iter().map(run).collect(),
        not_compared: summary.failed.iter().map(not_compared).collect(),
        faults: summary.faults.clone(),
    }
}
