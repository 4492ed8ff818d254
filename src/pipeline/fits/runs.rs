//! Fits every run that has no fit yet, or whose readings, tags or model changed.

use std::collections::BTreeSet;

use super::along;
use super::choice::{FitChoice, held, takes_known};
use super::extended;
use super::instruments::{NoiseOfOthers, Told};
use super::outcome::{FitSummary, Outcome, fit_fault, known_not_used, not_fitted, store};
use super::plan::{Planned, fit_plan};
use crate::domain::fault::caught;
use crate::domain::{AskedFit, Channel, Fit, Issue, KnownParameter};
use crate::fit::{FitInput, FitOptions, distributed, fit_knowing};
use crate::ingest::derived;
use crate::pipeline::campaign::batch::{Making, TO_THE_END};
use crate::pipeline::campaign::derived::{Derived, Keyed, MadeOf, bring_up_to_date, in_rounds, sorted};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{FitTask, NewResult, ResultKind};

/// Runs fitted between two commits: bounds memory, and what an interruption costs.
const BATCH: usize = 32;

/// The verb `fit`; [the library](crate) has an example.
#[derive(Debug, Clone, Default)]
pub struct FitRuns {
    /// How to fit.
    pub choice: FitChoice,
    /// Fit again even where nothing changed.
    pub again: bool,
}

impl FitRuns {
    /// Fits what is missing or out of date. The outcome does not depend on the number of threads.
    ///
    /// # Errors
    /// The model is not known, or the database fails; a run that cannot be fitted is no error.
    pub fn run(&self, context: &mut Context, observer: &dyn Observer) -> Result<FitSummary, PipelineError> {
        let mut summary = FitSummary::default();
        summary.changing = in_rounds(DOING, observer, |is_first| {
            let (found, changed) = self.once(context, self.again && is_first, observer)?;
            if is_first {
                summary = found;
            } else {
                summary.and_then(found);
            }
            Ok(changed)
        })?;
        Ok(summary)
    }

    /// Fits what is due of the runs as they are now; names those of which it changed meanwhile what their fits depend on.
    fn once(
        &self,
        context: &mut Context,
        again: bool,
        observer: &dyn Observer,
    ) -> Result<(FitSummary, BTreeSet<String>), PipelineError> {
        let asked = self.choice.asked();
        let plan = fit_plan(context, &asked)?;
        let in_groups = plan.extended.iter().flat_map(|group| &group.runs);
        let chosen = plan.single.iter().chain(in_groups).map(|run| &run.chosen);
        let mut summary = FitSummary {
            choices: held(chosen, &context.campaign),
            unknown_groups: plan.unknown_groups,
            ..FitSummary::default()
        };
        let (single, groups) = (Single::new(asked.clone()), extended::Groups::new(asked));
        let runs = sorted(&single, context, plan.single, again)?;
        let in_groups = sorted(&groups, context, plan.extended, again)?;
        let of_groups = in_groups.up_to_date.iter().map(|(_, group)| group.runs.len());
        summary.up_to_date = runs.up_to_date.len() + of_groups.sum::<usize>();
        let mut changed = bring_up_to_date(&single, context, &runs.due, observer, |_, run, made| {
            summary.took(run, made)
        })?;
        let of_groups = bring_up_to_date(&groups, context, &in_groups.due, observer, |_, run, made| {
            summary.took(run, made)
        })?;
        changed.extend(of_groups);
        Ok((summary, changed))
    }

    /// Number of runs that would be fitted.
    ///
    /// # Errors
    /// The model is not known, or the database fails.
    pub fn due(&self, context: &Context) -> Result<usize, PipelineError> {
        let asked = self.choice.asked();
        let plan = fit_plan(context, &asked)?;
        let single = Single::new(asked.clone());
        let runs = sorted(&single, context, plan.single, self.again)?;
        let groups = sorted(&extended::Groups::new(asked), context, plan.extended, self.again)?;
        let of_groups = groups.due.iter().map(|(_, group)| group.runs.len());
        Ok(runs.due.len() + of_groups.sum::<usize>())
    }
}

/// What is done, for the progress.
const DOING: &str = "fitting";

/// Fits of runs one by one.
struct Single {
    /// How fits are asked for.
    asked: AskedFit,
    /// What runs told of the noise of their instruments.
    told: Told,
}

impl Single {
    fn new(asked: AskedFit) -> Single {
        Single {
            asked,
            told: Told::default(),
        }
    }
}

impl Derived for Single {
    type Subject = Planned;
    type Readings = FitReadings;
    type Found = Fit;
    const KIND: ResultKind = ResultKind::Fit;
    const DOING: &'static str = DOING;
    const AT_ONCE: usize = BATCH;

    fn subjects(&self, context: &Context) -> Result<Vec<Planned>, PipelineError> {
        Ok(fit_plan(context, &self.asked)?.single)
    }

    fn runs<'s>(&self, run: &'s Planned) -> Vec<MadeOf<'s>> {
        vec![MadeOf::from(&run.task)]
    }

    fn key(&self, run: &Planned) -> String {
        run.input_hash()
    }

    fn load(&self, context: &Context, run: &Planned) -> Result<FitReadings, PipelineError> {
        FitReadings::load(context, run, &self.told)
    }

    fn make(&self, run: &Planned, readings: FitReadings) -> Vec<Outcome> {
        let options = run.options(&readings.of_others);
        vec![fit_uncaught(
            &run.task,
            &readings.channels,
            &options,
            &run.known(),
        )]
    }

    fn fault(&self, reason: &str) -> Issue {
        fit_fault("the fit", reason)
    }

    fn store(
        &self,
        context: &mut Context,
        results: &[NewResult<'_, Fit>],
        of: &[&Planned],
    ) -> Result<Vec<bool>, PipelineError> {
        store(context, results, of.iter().copied())
    }
}

/// What a fit of a planned run is made from.
pub(crate) struct FitReadings {
    channels: Vec<Channel>,
    of_others: NoiseOfOthers,
}

impl FitReadings {
    /// # Errors
    /// The database cannot be read.
    pub(crate) fn load(context: &Context, run: &Planned, told: &Told) -> Result<FitReadings, PipelineError> {
        Ok(FitReadings {
            channels: context.store.channels(run.task.run_id)?,
            of_others: told.to(context, run)?,
        })
    }

    /// The fit of the run.
    pub(crate) fn fit(&self, run: &Planned) -> Outcome {
        let options = run.options(&self.of_others);
        fit_one(&run.task, &self.channels, &options, &run.known())
    }
}

/// A run to fit with the hash of all that its fit depends on.
pub(crate) type Due = Keyed<Planned>;

/// Fits the runs and hands each batch to `take`, in its order; nothing is stored. `doing` is what the progress says.
pub(crate) fn fit_and_take(
    doing: &'static str,
    context: &Context,
    due: &[Due],
    observer: &dyn Observer,
    take: impl FnMut(Vec<(&Due, Outcome)>) -> Result<(), PipelineError>,
) -> Result<(), PipelineError> {
    let making = Making {
        doing,
        at_once: BATCH,
        observer,
        may_go_on: TO_THE_END,
    };
    let told = Told::default();
    let load = |context: &Context, (_, run): &Due| FitReadings::load(context, run, &told);
    let make = |(_, run): &Due, readings: FitReadings| readings.fit(run);
    making.look(context, due, load, make, take)
}

/// Fits one run; a panic in a kernel is that run's failure, not the program's.
pub(crate) fn fit_one(
    task: &FitTask,
    channels: &[Channel],
    options: &FitOptions,
    known: &[KnownParameter],
) -> Outcome {
    let fitted = caught(|| fit_uncaught(task, channels, options, known));
    fitted.unwrap_or_else(|reason| Err(fit_fault("the fit", &reason)))
}

fn fit_uncaught(
    task: &FitTask,
    channels: &[Channel],
    options: &FitOptions,
    known: &[KnownParameter],
) -> Outcome {
    let taken = if takes_known(options.model) { known } else { &[] };
    let mut fit = match options.model.id {
        distributed::MODEL_ID => along::fit(task, channels, options),
        _ => fit_whole(task, channels, options, taken),
    }?;
    if taken.len() < known.len() {
        fit.issues.push(known_not_used(known, options.model.id));
    }
    Ok(fit)
}

/// The strip as a whole, with a lumped model.
fn fit_whole(
    task: &FitTask,
    measured: &[Channel],
    options: &FitOptions,
    known: &[KnownParameter],
) -> Outcome {
    let channels = derived::responses(measured, task.length_cm, Some(&task.drive));
    let input = FitInput {
        channels: &channels,
        drive: &task.drive,
        area_cm2: task.area_cm2,
    };
    let mut fit = fit_knowing(&input, options, known).map_err(not_fitted)?;
    fit.issues
        .extend(along::lumped_or_distributed(task, measured, &fit));
    Ok(fit)
}
