//! Fits in doubt, as the document of `ieap diagnose --json` states them.

use schemars::JsonSchema;
use serde::Serialize;

use crate::analysis::laws::doubt::{Doubted, Treatment};
use crate::analysis::laws::words;

/// Fits of a group whose misfit is claimed.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DoubtedEntry {
    /// Name of the group.
    pub group: String,
    /// `widened` or `left-out`.
    pub treatment: &'static str,
    /// Runs that this is about.
    pub runs: Vec<String>,
    /// Ids of the causes that its finding names.
    pub causes: Vec<String>,
    /// In words.
    pub sentence: String,
}

/// Groups whose fits are in doubt.
pub fn entries(doubted: &[Doubted]) -> Vec<DoubtedEntry> {
    let entry = |one: &Doubted| DoubtedEntry {
        group: one.group.clone(),
        treatment: match one.treatment {
            Treatment::Widened => "widened",
            Treatment::LeftOut => "left-out",
        },
        runs: one.runs.clone(),
        causes: one.causes.clone(),
        sentence: words::doubted(one),
    };
    doubted.iter().map(entry).collect()
}
