//! A question that only a person can answer: statements about runs contradict each other.

use schemars::JsonSchema;
use serde::Serialize;

/// Runs of which two sources say different things, in one question.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Contradiction {
    /// Tag key: `sample`, `environment`, `voltage_v` or `relative_humidity_percent`.
    pub key: String,
    /// The runs.
    pub runs: Vec<String>,
    /// Who says what, and what the readings are like; a sentence without its full stop.
    pub question: String,
    /// What holds until a person answers: no result is made from the runs, or what was measured counts; a sentence without its
    /// full stop.
    pub until: String,
    /// Commands that answer it; where several tags of one run stand, only one of them is right.
    pub answers: Vec<String>,
}
