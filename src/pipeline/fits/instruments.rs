//! Which runs tell of the noise of an instrument, and what they tell. What a run tells follows from its own readings alone, so that
//! a fit is a function of its readings and of theirs, whichever are fitted first.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::choice::choose;
use super::input_hash::{input_hash, is_weighed_by_kinds};
use super::plan::{Planned, fit_plan};
use crate::domain::fault::caught;
use crate::domain::{AskedFit, Campaign};
use crate::fit::{
    FitInput, FitOptions, InstrumentNoise, MOST_RUNS_OF_INSTRUMENT, ToldOfNoise, told_of_noise,
};
use crate::ingest::derived;
use crate::pipeline::{Context, PipelineError};
use crate::store::FitTask;

/// A run that tells of the noise of its instrument, fitted as campaign.toml states whatever is asked for it.
#[derive(Debug)]
pub(crate) struct Telling {
    task: FitTask,
    options: FitOptions<'static>,
    /// Of all that it tells by.
    pub(crate) hash: String,
}

/// By instrument the runs that tell of it.
pub(crate) struct Instruments(BTreeMap<Option<String>, Arc<[Telling]>>);

impl Instruments {
    /// Of each instrument the first runs by their start, as many as the largest power of two that there are: a run more changes what
    /// is known of it, and so the fits of all its runs, only where their number doubles. Runs that name no instrument are those of
    /// one: who has two says so, and one run in ten may have another noise than its instrument anyway.
    pub(crate) fn of(campaign: &Campaign, tasks: &[FitTask]) -> Result<Instruments, PipelineError> {
        let open = AskedFit::default();
        let options = choose(&open, campaign, &open)?.options;
        let mut by_instrument: BTreeMap<Option<String>, Vec<&FitTask>> = BTreeMap::new();
        for task in tasks
            .iter()
            .filter(|task| is_weighed_by_kinds(task, &options, &[]))
        {
            by_instrument
                .entry(task.instrument.clone())
                .or_default()
                .push(task);
        }
        let tellers = by_instrument.into_iter().map(|(instrument, mut tasks)| {
            // Of those without a start the name decides, which mostly grows with time: one that comes later changes nothing.
            tasks.sort_by_key(|task| (task.started_at.is_none(), &task.started_at, &task.path));
            tasks.truncate(MOST_RUNS_OF_INSTRUMENT.min(1 << tasks.len().ilog2()));
            let telling = tasks.into_iter().map(|task| Telling {
                task: task.clone(),
                options,
                hash: input_hash(task, &options, &[]),
            });
            (instrument, telling.collect())
        });
        Ok(Instruments(tellers.collect()))
    }

    /// The runs that tell of the instrument of a run; it may be one of them.
    pub(crate) fn tellers(&self, task: &FitTask) -> Arc<[Telling]> {
        self.0.get(&task.instrument).cloned().unwrap_or_default()
    }
}

impl Telling {
    /// Whether it is that run.
    pub(crate) fn is(&self, task: &FitTask) -> bool {
        self.task.run_id == task.run_id
    }

    /// Nothing where no fit can be made of it, or a fault of the program stops it: the fit of the run says which.
    fn told(&self, context: &Context) -> Result<ToldOfNoise, PipelineError> {
        let measured = context.store.channels(self.task.run_id)?;
        let told = || {
            let channels = derived::responses(&measured, self.task.length_cm, Some(&self.task.drive));
            let input = FitInput {
                channels: &channels,
                drive: &self.task.drive,
                area_cm2: self.task.area_cm2,
            };
            told_of_noise(&input, &self.options).unwrap_or_default()
        };
        Ok(caught(told).unwrap_or_default())
    }
}

/// What other runs tell of the noise of a run's instrument, and which: what its fit depends on beside its own readings.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct NoiseOfOthers {
    /// Of each run that told, the hash of all that it told by.
    pub made_from: Vec<String>,
    /// What they told.
    pub noise: InstrumentNoise,
}

/// What other runs tell of the noise of every run that is fitted by itself, by its name.
///
/// # Errors
/// The database cannot be read, or campaign.toml asks for a fit that cannot be.
pub fn noise_of_others(context: &Context) -> Result<BTreeMap<String, NoiseOfOthers>, PipelineError> {
    let told = Told::default();
    let runs = fit_plan(context, &AskedFit::default())?.single.into_iter();
    runs.map(|run| Ok((run.task.path.clone(), told.to(context, &run)?)))
        .collect()
}

/// What runs told, each asked once.
#[derive(Default)]
pub(crate) struct Told(Mutex<BTreeMap<String, Arc<ToldOfNoise>>>);

impl Told {
    /// What the other runs of its instrument tell a run.
    ///
    /// # Errors
    /// The database cannot be read.
    pub(crate) fn to(&self, context: &Context, run: &Planned) -> Result<NoiseOfOthers, PipelineError> {
        let mut of_others = NoiseOfOthers::default();
        for other in run.others() {
            of_others.noise.learn(&*self.by(context, other)?);
            of_others.made_from.push(other.hash.clone());
        }
        Ok(of_others)
    }

    fn by(&self, context: &Context, run: &Telling) -> Result<Arc<ToldOfNoise>, PipelineError> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(told) = known.get(&run.hash) {
            return Ok(told.clone());
        }
        let told = Arc::new(run.told(context)?);
        known.insert(run.hash.clone(), told.clone());
        Ok(told)
    }
}
