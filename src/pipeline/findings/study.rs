//! What the study asked, from the current fits and from the curves themselves.

use crate::analysis::cache::Cache;
use crate::analysis::laws::doubt::{Doubts, Findings};
use crate::analysis::study::Evidence;
pub use crate::analysis::study::Study;
pub use crate::analysis::study::view::lines;
use crate::pipeline::campaign::standing;
use crate::pipeline::findings::current::current_findings;
use crate::pipeline::findings::model_free::curves_after_steps;
use crate::pipeline::{Context, PipelineError};

/// Schema of what is printed of it.
pub const SCHEMA: &str = "ieap/study/1";

/// What the study asked, with its answers.
///
/// # Errors
/// The database cannot be read.
pub fn study(context: &Context) -> Result<Study, PipelineError> {
    let runs = standing::runs(context)?.speaking;
    let found = current_findings(context)?;
    let findings = Findings {
        groups: &found.groups,
        runs: &found.runs,
    };
    Ok(Study::of(Evidence {
        runs: &runs,
        campaign: &context.campaign,
        doubts: &Doubts::new(findings, &runs),
        curves: &curves_after_steps(context, &runs, &Cache::default())?,
    }))
}
