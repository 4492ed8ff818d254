//! Readings of a run as results are made of them: current and curvature of the strip, whatever was measured in their place.

use crate::domain::tag::keys;
use crate::domain::{Channel, Drive, RunRecord};
use crate::fit::{FitInput, FitOptions, placed_drive};
use crate::ingest::derived;
use crate::pipeline::{Context, PipelineError};
use crate::store::FitTask;

/// Of a run that can be fitted.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn of_task(context: &Context, task: &FitTask) -> Result<Vec<Channel>, PipelineError> {
    Ok(derived::responses(
        &context.store.channels(task.run_id)?,
        task.length_cm,
    ))
}

/// Of each of them, in their order.
///
/// # Errors
/// As of [`of_task`].
pub(crate) fn of_tasks(context: &Context, tasks: &[FitTask]) -> Result<Vec<Vec<Channel>>, PipelineError> {
    tasks.iter().map(|task| of_task(context, task)).collect()
}

/// The drive of a run with its edges where a fit of these readings takes them to be; what is not fitted keeps them as they are told.
pub(crate) fn placed(task: &FitTask, channels: &[Channel]) -> Drive {
    let input = FitInput {
        channels,
        drive: &task.drive,
        area_cm2: task.area_cm2,
    };
    placed_drive(&input, &FitOptions::default()).unwrap_or_else(|_| task.drive.clone())
}

/// Of any run; the length of the strip is that of its sample.
///
/// # Errors
/// As of [`of_task`].
pub(crate) fn of_run(context: &Context, run: &RunRecord) -> Result<Vec<Channel>, PipelineError> {
    let sample = run.tag(keys::SAMPLE).and_then(|id| context.campaign.sample(id));
    let length_cm = sample
        .and_then(|sample| sample.length_mm)
        .map(|length_mm| length_mm / 10.0);
    Ok(derived::responses(&context.store.channels(run.id)?, length_cm))
}
