//! Steps, spectra and forces of the same strips in one likelihood, made whenever it is asked. Nothing of it is stored.

use crate::analysis::impedance::{Both, Comparison, OneLikelihood, comparisons};
use crate::domain::fault::caught;
use crate::domain::{Campaign, Channel, Quantity, RunRecord, SpectrumRun};
use crate::fit::{FitInput, step_and_spectrum};
use crate::pipeline::campaign::batch::compute;
use crate::pipeline::campaign::readings;
use crate::pipeline::findings::blocked::{lever_mm, size, with_moment};
use crate::pipeline::{Context, PipelineError};
use crate::store::FitTask;

/// Every spectrum with each step at the lowest voltage of the same sample and condition; with each run of the held strip at that
/// voltage, where there are such.
///
/// # Errors
/// The database cannot be read.
pub fn in_one_likelihood(
    context: &Context,
    runs: &[RunRecord],
    spectra: &[SpectrumRun],
) -> Result<Vec<OneLikelihood>, PipelineError> {
    let tasks = context.store.fit_tasks()?;
    let beside: Vec<Beside> = comparisons(spectra, runs)
        .into_iter()
        .flat_map(|comparison| besides(&comparison, runs, &tasks, &context.campaign))
        .collect();
    let load = |context: &Context, beside: &Beside| {
        let held = beside.held.map(|held| context.store.channels(held.run.id));
        Ok((readings::of_task(context, beside.step.task)?, held.transpose()?))
    };
    let campaign = &context.campaign;
    compute(context, &beside, load, |beside, (step, held)| {
        let both = both(campaign, spectra, beside, &step, held.as_deref());
        of_beside(spectra, beside, both)
    })
}

/// A run, and how it is fitted.
#[derive(Clone, Copy)]
struct Run<'a> {
    run: &'a RunRecord,
    task: &'a FitTask,
}

/// A step beside a spectrum, and a run of the held strip.
struct Beside<'a> {
    comparison: Comparison,
    step: Run<'a>,
    held: Option<Run<'a>>,
}

/// A run whose force gives no moment is a step like the others, by its current.
fn besides<'a>(
    comparison: &Comparison,
    runs: &'a [RunRecord],
    tasks: &'a [FitTask],
    campaign: &Campaign,
) -> Vec<Beside<'a>> {
    let of = |path: &String| {
        Some(Run {
            run: runs.iter().find(|run| run.path == *path)?,
            task: tasks.iter().find(|task| task.path == *path)?,
        })
    };
    let is_held = |of: &Run| {
        let mut channels = of.run.channels.iter();
        let has_force = channels.any(|channel| channel.quantity == Quantity::BlockingForce);
        has_force && lever_mm(of.run, campaign).is_some()
    };
    let all = comparison.lowest.runs.iter().filter_map(of);
    let (held, steps): (Vec<Run>, Vec<Run>) = all.partition(is_held);
    let mut held: Vec<Option<Run>> = held.into_iter().map(Some).collect();
    if held.is_empty() {
        held.push(None);
    }
    let with = |step: Run<'a>, held: Option<Run<'a>>| Beside {
        comparison: comparison.clone(),
        step,
        held,
    };
    let each = steps
        .iter()
        .flat_map(|step| held.iter().map(|held| with(*step, *held)));
    each.collect()
}

fn spectrum_of<'a>(spectra: &'a [SpectrumRun], comparison: &Comparison) -> Option<&'a SpectrumRun> {
    spectra
        .iter()
        .find(|spectrum| spectrum.run.path == comparison.spectrum)
}

/// One set of parameters of all; or why there is none.
fn both(
    campaign: &Campaign,
    spectra: &[SpectrumRun],
    Beside {
        comparison,
        step,
        held,
    }: &Beside,
    channels: &[Channel],
    held_channels: Option<&[Channel]>,
) -> Result<Both, String> {
    if !comparison.describes {
        return Err(format!(
            "{} does not describe the spectrum: its numbers are those of no strip",
            comparison.circuit
        ));
    }
    let run = spectrum_of(spectra, comparison);
    let sweep =
        run.and_then(|run| Some((&run.sweeps.get(comparison.sweep - 1)?.spectrum, run.run.area_cm2?)));
    let spectrum = sweep.ok_or("the spectrum states no area")?;
    let moment = held
        .zip(held_channels)
        .map(|(held, channels)| with_moment(held.run, channels, campaign))
        .transpose()
        .map_err(|(message, mend)| format!("{message}; {mend}"))?;
    let found = caught(|| {
        let held = held.as_ref().zip(moment.as_deref());
        let held = held.map(|(held, channels)| input(held.task, channels));
        step_and_spectrum(
            &input(step.task, channels),
            held.as_ref(),
            spectrum,
            &comparison.circuit,
        )
    })
    .map_err(|reason| format!("a fault of the program stopped the fit: {reason}"))?
    .map_err(|error| error.to_string())?;
    Ok(Both {
        parameters: found.parameters,
        moment_mn_mm_per_c: found.moment_per_c.map(size),
        p: found.p,
    })
}

fn input<'a>(task: &'a FitTask, channels: &'a [Channel]) -> FitInput<'a> {
    FitInput {
        channels,
        drive: &task.drive,
        area_cm2: task.area_cm2,
    }
}

fn of_beside(spectra: &[SpectrumRun], beside: &Beside, both: Result<Both, String>) -> OneLikelihood {
    let (comparison, task) = (&beside.comparison, beside.step.task);
    let run = spectrum_of(spectra, comparison);
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
        held: beside.held.map(|held| held.run.path.clone()),
        both,
    }
}
