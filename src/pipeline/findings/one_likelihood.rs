//! Steps and spectra of the same strips in one likelihood, made whenever it is asked. Nothing of it is stored.

use crate::analysis::impedance::{Both, Comparison, OneLikelihood, comparisons};
use crate::domain::fault::caught;
use crate::domain::{Channel, RunRecord, SpectrumRun};
use crate::fit::{FitInput, step_and_spectrum};
use crate::pipeline::campaign::batch::compute;
use crate::pipeline::campaign::readings;
use crate::pipeline::{Context, PipelineError};
use crate::store::FitTask;

/// Every spectrum with each step at the lowest voltage of the same sample and condition.
///
/// # Errors
/// The database cannot be read.
pub fn in_one_likelihood(
    context: &Context,
    runs: &[RunRecord],
    spectra: &[SpectrumRun],
) -> Result<Vec<OneLikelihood>, PipelineError> {
    let tasks = context.store.fit_tasks()?;
    let mut pairs: Vec<(Comparison, &FitTask)> = Vec::new();
    for comparison in comparisons(spectra, runs) {
        for path in &comparison.lowest.runs {
            let task = tasks.iter().find(|task| task.path == *path);
            pairs.extend(task.map(|task| (comparison.clone(), task)));
        }
    }
    let load = |context: &Context, (_, task): &(Comparison, &FitTask)| readings::of_task(context, task);
    compute(context, &pairs, load, |(comparison, task), channels| {
        of_pair(spectra, comparison, task, &channels)
    })
}

fn of_pair(
    spectra: &[SpectrumRun],
    comparison: &Comparison,
    task: &FitTask,
    channels: &[Channel],
) -> OneLikelihood {
    let drive = readings::placed(task, channels);
    let input = FitInput {
        channels,
        drive: &drive,
        area_cm2: task.area_cm2,
    };
    let run = spectra
        .iter()
        .find(|spectrum| spectrum.run.path == comparison.spectrum);
    let sweep =
        run.and_then(|run| Some((&run.sweeps.get(comparison.sweep - 1)?.spectrum, run.run.area_cm2?)));
    let both = match (sweep, comparison.describes) {
        (_, false) => Err(format!(
            "{} does not describe the spectrum: its numbers are those of no strip",
            comparison.circuit
        )),
        (None, true) => Err("the spectrum states no area".to_owned()),
        (Some(spectrum), true) => caught(|| step_and_spectrum(&input, spectrum, &comparison.circuit))
            .map_err(|reason| format!("a fault of the program stopped the fit: {reason}"))
            .and_then(|found| found.map_err(|error| error.to_string())),
    };
    let several = run.is_some_and(|run| run.sweeps.len() > 1);
    OneLikelihood {
        run_id: task.run_id,
        path: task.path.clone(),
        spectrum: if several {
            format!("{}, sweep {}", comparison.spectrum, comparison.sweep)
        } else {
            comparison.spectrum.clone()
        },
        of_spectrum: comparison
            .rows
            .iter()
            .map(|row| (row.key, row.spectrum.clone()))
            .collect(),
        both: both.map(|found| Both {
            parameters: found.parameters,
            p: found.p,
        }),
    }
}
