//! What a run says of lumped and distributed, as documents and lists state it.

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::RunRecord;
use crate::fit::distributed::Decision;

/// Whether a run needs the distributed model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct LumpedOrDistributedEntry {
    /// Path relative to the campaign.
    pub run: String,
    /// `distributed`, `open`, `lumped` or `cannot be told`.
    pub verdict: &'static str,
    /// The decision in a sentence, with its numbers.
    pub sentence: String,
    /// What would tell; null where nothing is asked for.
    pub mend: Option<String>,
}

impl LumpedOrDistributedEntry {
    /// What the current fit of a run says of it; none where the fit says nothing, or there is none.
    pub fn of(run: &RunRecord) -> Option<LumpedOrDistributedEntry> {
        let issue = run.fit.as_ref()?.lumped_or_distributed()?;
        Some(LumpedOrDistributedEntry {
            run: run.path.clone(),
            verdict: Decision::word_of(issue)?,
            sentence: issue.message.clone(),
            mend: (!issue.mend.is_empty()).then(|| issue.mend.clone()),
        })
    }
}
