//! A part of a campaign, and what was found of it.

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::{Issue, Severity};

/// A part of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Part {
    /// `database`, `archive`, `subjects`, `journal`, `report`, `tables` or `results`.
    pub part: &'static str,
    /// What was looked at, in words.
    pub looked_at: String,
    /// What was found: errors are damage or loss, notes are worth knowing.
    pub findings: Vec<Issue>,
}

impl Part {
    /// Whether nothing is lost or damaged.
    pub fn is_sound(&self) -> bool {
        self.findings
            .iter()
            .all(|issue| issue.severity != Severity::Error)
    }
}
