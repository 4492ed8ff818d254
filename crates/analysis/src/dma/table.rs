//! Modulus logs as a table for other programs: one row a number.

use ieap_domain::tag::keys;
use ieap_domain::{ModulusLog, ModulusStep, Parameter};
use ieap_show::{Made, Sheet};

use crate::tables::TableInput;

/// One number of a log.
struct Row<'a> {
    log: &'a ModulusLog,
    step: Option<usize>,
    parameter: &'a Parameter,
}

/// One row per log, step and number; numbers of the log as a whole have no step. An empty cell is a number that is
/// not determined, with its reason beside it.
pub fn make<M: Made>(input: &TableInput) -> M {
    let of_step = |row: &Row, pick: fn(&ModulusStep) -> f64| {
        let steps = &row.log.analysis.as_ref()?.steps;
        Some(pick(&steps[row.step?]))
    };
    Sheet::<Row>::new("dma", "Numbers of the modulus logs", 1)
        .called(|row| {
            let step = row
                .step
                .map_or(String::new(), |step| format!("step {}, ", step + 1));
            format!("{}, {step}{}", row.log.run.path, row.parameter.key)
        })
        .plain("log", |row| row.log.run.path.as_str())
        .plain("sample", |row| row.log.run.tag(keys::SAMPLE))
        .plain("material", move |row| {
            let sample = input.campaign.sample(row.log.run.tag(keys::SAMPLE)?)?;
            Some(sample.material.as_str())
        })
        .plain("frequency_hz", |row| row.log.analysis.as_ref()?.frequency_hz)
        .plain("step", |row| Some(row.step? as f64 + 1.0))
        .plain("step_start_s", move |row| of_step(row, |step| step.start_s))
        .plain("step_settled_s", move |row| of_step(row, |step| step.settled_s))
        .plain("step_end_s", move |row| of_step(row, |step| step.end_s))
        .plain("parameter", |row| row.parameter.key.as_str())
        .plain("value", |row| row.parameter.estimate.value)
        .plain("standard_error", |row| row.parameter.estimate.standard_error)
        .plain("low_95", |row| row.parameter.estimate.low_95)
        .plain("high_95", |row| row.parameter.estimate.high_95)
        .plain("at_bound", |row| row.parameter.estimate.at_bound)
        .plain("reason", |row| row.parameter.estimate.reason.clone())
        .made(input.modulus_logs.iter().flat_map(rows))
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
