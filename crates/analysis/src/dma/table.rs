//! Modulus logs as a table for other programs: one row a number.

use polars::prelude::DataFrame;

use crate::export::{ExportError, flags, frame, numbers, texts};
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, ModulusLog, Parameter};

/// One number of a log.
struct Row<'a> {
    log: &'a ModulusLog,
    step: Option<usize>,
    parameter: &'a Parameter,
}

/// One row per log, step and number; numbers of the log as a whole have no step. An empty cell is a number that is
/// not determined, with its reason beside it.
///
/// # Errors
/// [`ExportError::Table`]: a fault of the program.
pub fn modulus_table(logs: &[ModulusLog], campaign: &Campaign) -> Result<DataFrame, ExportError> {
    let rows: Vec<Row<'_>> = logs.iter().flat_map(rows).collect();
    let material = |row: &Row| {
        let sample = campaign.sample(row.log.run.tag(keys::SAMPLE)?)?;
        Some(sample.material.clone())
    };
    let of_step = |pick: fn(&ieap_domain::ModulusStep) -> f64| {
        rows.iter().map(move |row| {
            let steps = &row.log.analysis.as_ref()?.steps;
            Some(pick(&steps[row.step?]))
        })
    };
    let columns = vec![
        texts("log", rows.iter().map(|row| Some(row.log.run.path.clone()))),
        texts(
            "sample",
            rows.iter()
                .map(|row| row.log.run.tag(keys::SAMPLE).map(str::to_owned)),
        ),
        texts("material", rows.iter().map(material)),
        numbers(
            "frequency_hz",
            rows.iter().map(|row| row.log.analysis.as_ref()?.frequency_hz),
        ),
        numbers("step", rows.iter().map(|row| Some(row.step? as f64 + 1.0))),
        numbers("step_start_s", of_step(|step| step.start_s)),
        numbers("step_settled_s", of_step(|step| step.settled_s)),
        numbers("step_end_s", of_step(|step| step.end_s)),
        texts(
            "parameter",
            rows.iter().map(|row| Some(row.parameter.key.clone())),
        ),
        numbers("value", rows.iter().map(|row| row.parameter.estimate.value)),
        numbers(
            "standard_error",
            rows.iter().map(|row| row.parameter.estimate.standard_error),
        ),
        numbers("low_95", rows.iter().map(|row| row.parameter.estimate.low_95)),
        numbers("high_95", rows.iter().map(|row| row.parameter.estimate.high_95)),
        flags("at_bound", rows.iter().map(|row| row.parameter.estimate.at_bound)),
        texts(
            "reason",
            rows.iter().map(|row| row.parameter.estimate.reason.clone()),
        ),
    ];
    frame("dma", columns)
}

fn rows(log: &ModulusLog) -> Vec<Row<'_>> {
    let Some(analysis) = &log.analysis else {
        return Vec::new();
    };
    let row = |step, parameter| Row { log, step, parameter };
    let of_steps = analysis.steps.iter().enumerate();
    let of_steps = of_steps.flat_map(|(at, step)| step.estimates.iter().map(move |p| row(Some(at), p)));
    of_steps
        .chain(analysis.estimates.iter().map(|p| row(None, p)))
        .collect()
}
