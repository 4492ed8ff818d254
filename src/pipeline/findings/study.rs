//! What the study asked, from the current fits and from the curves themselves.

use crate::analysis::cache::Cache;
use crate::analysis::laws::doubt::{Doubts, Findings};
use crate::analysis::model_free::curves::StepCurves;
use crate::analysis::study::Evidence;
pub use crate::analysis::study::Study;
pub use crate::analysis::study::view::lines;
use crate::domain::RunRecord;
use crate::pipeline::campaign::standing::{self, Runs};
use crate::pipeline::findings::current::{CurrentFindings, current_findings};
use crate::pipeline::findings::kept;
use crate::pipeline::findings::model_free::curves_after_steps;
use crate::pipeline::{Context, PipelineError};

/// Schema of what is printed of it.
pub const SCHEMA: &str = "ieap/study/1";

/// What the study asked, with its answers.
///
/// # Errors
/// The database cannot be read.
pub fn study(context: &Context) -> Result<Study, PipelineError> {
    let Runs {
        speaking: runs,
        set_aside,
    } = standing::runs(context)?;
    let kept = kept::values(context);
    let curves = curves_after_steps(context, &runs, &kept)?;
    Ok(of_runs(context, &runs, &current_findings(context)?, &curves, &kept).beside(&set_aside))
}

/// The same of these runs, of which a diagnosis found this, and of their curves where they were read; what was answered before is
/// taken from `kept`.
pub(crate) fn of_runs(
    context: &Context,
    runs: &[RunRecord],
    found: &CurrentFindings,
    curves: &[StepCurves],
    kept: &Cache,
) -> Study {
    let findings = Findings {
        groups: &found.groups,
        runs: &found.runs,
    };
    let evidence = Evidence {
        runs,
        campaign: &context.campaign,
        doubts: &Doubts::new(findings, runs),
        curves,
    };
    Study::kept(evidence, kept)
}
