//! Fits every run that has no fit yet, or whose readings, tags or model changed.

use std::collections::BTreeMap;

use super::along;
use super::choice::{FitChoice, held, takes_known};
use super::extended;
use super::outcome::{FitSummary, Outcome, fit_fault, known_not_used, not_fitted, save};
use super::plan::{Planned, fit_plan};
use crate::domain::fault::caught;
use crate::domain::{AskedFit, Channel, KnownParameter};
use crate::fit::{FitInput, FitOptions, distributed, fit_knowing};
use crate::ingest::derived;
use crate::pipeline::campaign::batch::{Making, TO_THE_END};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::FitTask;

/// Runs fitted between two commits: bounds memory, and what an interruption costs.
const BATCH: usize = 32;

/// The verb `fit`.
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
        self.run_as_kept(context, &BTreeMap::new(), observer)
    }

    /// The same for a database without earlier fits: `kept` says how runs were asked to be fitted, by their names.
    ///
    /// # Errors
    /// As of [`FitRuns::run`].
    pub(crate) fn run_as_kept(
        &self,
        context: &mut Context,
        kept: &BTreeMap<String, AskedFit>,
        observer: &dyn Observer,
    ) -> Result<FitSummary, PipelineError> {
        let plan = fit_plan(context, &self.choice.asked(), kept)?;
        let in_groups = plan.extended.iter().flat_map(|group| &group.runs);
        let chosen = plan.single.iter().chain(in_groups).map(|run| &run.chosen);
        let choices = held(chosen, &context.campaign);
        let (done, due) = self.sorted(plan.single);
        let mut summary = FitSummary {
            up_to_date: done.len(),
            unknown_groups: plan.unknown_groups,
            choices,
            ..FitSummary::default()
        };
        making(observer).run(context, &due, load, make, |context, made| {
            let stamped = made
                .into_iter()
                .map(|((hash, run), fit)| ((hash.as_str(), run), fit));
            save(context, stamped.collect(), &mut summary)
        })?;
        extended::fit_groups(context, &plan.extended, self.again, observer, &mut summary)?;
        Ok(summary)
    }
}

impl FitRuns {
    /// Number of runs that would be fitted.
    ///
    /// # Errors
    /// The model is not known, or the database fails.
    pub fn due(&self, context: &Context) -> Result<usize, PipelineError> {
        let plan = fit_plan(context, &self.choice.asked(), &BTreeMap::new())?;
        let (_, due) = self.sorted(plan.single);
        Ok(due.len() + extended::due(&plan.extended, self.again))
    }

    /// The runs of a plan whose fit is up to date, and the others.
    pub(crate) fn sorted(&self, single: Vec<Planned>) -> (Vec<Due>, Vec<Due>) {
        let hashed = single.into_iter().map(|run| (run.input_hash(), run));
        hashed.partition(|due| self.is_done(due))
    }

    /// Whether a run's fit is up to date.
    pub(crate) fn is_done(&self, (hash, run): &Due) -> bool {
        !self.again && run.task.done_input_hash.as_ref() == Some(hash)
    }
}

/// A run to fit with the hash of all that its fit depends on.
pub(crate) type Due = (String, Planned);

fn making(observer: &dyn Observer) -> Making<'_> {
    Making {
        doing: "fitting",
        at_once: BATCH,
        observer,
        may_go_on: TO_THE_END,
    }
}

fn load(context: &Context, (_, run): &Due) -> Result<Vec<Channel>, PipelineError> {
    Ok(context.store.channels(run.task.run_id)?)
}

fn make((_, run): &Due, channels: Vec<Channel>) -> Outcome {
    fit_one(&run.task, &channels, &run.chosen.options, &run.known())
}

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
        ..making(observer)
    };
    making.look(context, due, load, make, take)
}

/// Fits one run; a panic in a kernel is that run's failure, not the program's.
pub(crate) fn fit_one(
    task: &FitTask,
    channels: &[Channel],
    options: &FitOptions,
    known: &[KnownParameter],
) -> Outcome {
    let taken = if takes_known(options.model) { known } else { &[] };
    let fitted = caught(|| match options.model.id {
        distributed::MODEL_ID => along::fit(task, channels, options),
        _ => fit_whole(task, channels, options, taken),
    });
    let mut fit = fitted.unwrap_or_else(|reason| Err(fit_fault("the fit", &reason)))?;
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
    let channels = derived::responses(measured, task.length_cm);
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
