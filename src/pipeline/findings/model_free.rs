//! What runs say without a model, and trains cycle by cycle. No table holds it: it follows from the readings, and a report
//! keeps it for the next one (`analysis::cache`).

use crate::analysis::cache::{Cache, Hash};
use crate::analysis::cycles::{CycleRun, cycle_run};
use crate::analysis::model_free::curves::{StepCurves, step_curves};
use crate::analysis::model_free::{ModelFree, model_free};
use crate::analysis::stiffness::sample_modulus;
use crate::domain::tag::keys;
use crate::domain::{Channel, Estimate, ModulusLog, Quantity, RunRecord, Sample};
use crate::pipeline::campaign::batch::compute;
use crate::pipeline::campaign::{readings, standing};
use crate::pipeline::{Context, PipelineError};
use crate::store::StateOfRun;

/// What runs say without a model.
#[derive(Debug, Default)]
pub struct WithoutModel {
    /// Steps.
    pub steps: Vec<ModelFree>,
    /// Trains.
    pub trains: Vec<CycleRun>,
}

/// What one run says: as a step, and as a train.
type Said = (Option<ModelFree>, Option<CycleRun>);

/// A run that is asked.
struct Asked<'a> {
    run: &'a RunRecord,
    sample: Option<&'a Sample>,
    /// Of the strip at the humidity of the run.
    modulus_mpa: Estimate,
    /// The hash of what its answer is made from, where that is known.
    hash: Option<String>,
}

/// What the runs with a drive say, in their order; what one said before is taken from `kept`.
///
/// # Errors
/// The database cannot be read.
pub fn without_model(
    context: &Context,
    runs: &[RunRecord],
    kept: &Cache,
) -> Result<WithoutModel, PipelineError> {
    let (logs, _) = standing::modulus_logs(context)?;
    let driven = runs.iter().filter(|run| run.drive.is_some());
    let states = context.store.states_of_runs()?;
    let asked: Vec<Asked> = driven
        .map(|run| asked(context, run, (&logs, states.get(&run.id))))
        .collect();
    // A run that said it before needs no readings.
    let load = |context: &Context, asked: &Asked| {
        let known: Option<Said> = asked.hash.as_deref().and_then(|hash| kept.earlier(hash));
        known.map_or_else(|| channels(context, asked.run).map(Err), |said| Ok(Ok(said)))
    };
    let said = compute(context, &asked, load, |asked, read| match read {
        Ok(said) => said,
        Err(channels) => asked.answer(&channels, kept),
    })?;
    let (steps, trains): (Vec<_>, Vec<_>) = said.into_iter().unzip();
    Ok(WithoutModel {
        steps: steps.into_iter().flatten().collect(),
        trains: trains.into_iter().flatten().collect(),
    })
}

/// Current and bending of the runs after their steps, in their order, at times that all have in common; what was read before
/// is taken from `kept`.
///
/// # Errors
/// The database cannot be read.
pub fn curves_after_steps(
    context: &Context,
    runs: &[RunRecord],
    kept: &Cache,
) -> Result<Vec<StepCurves>, PipelineError> {
    let states = context.store.states_of_runs()?;
    let load = |context: &Context, run: &RunRecord| {
        if run.drive.is_none() {
            return Ok((None, Ok(StepCurves::default())));
        }
        let sample = run.tag(keys::SAMPLE).and_then(|id| context.campaign.sample(id));
        let hash = (states.get(&run.id)).map(|state| {
            Hash::default()
                .with(&"curves")
                .with(&state.run)
                .with(&sample)
                .text()
        });
        match hash.as_deref().and_then(|hash| kept.earlier(hash)) {
            Some(known) => Ok((hash, Ok(known))),
            None => Ok((hash, Err(channels(context, run)?))),
        }
    };
    compute(context, runs, load, |run, (hash, read)| {
        read.unwrap_or_else(|channels| {
            let curves = step_curves(run, &channels);
            if let Some(hash) = hash {
                kept.put(&hash, &curves);
            }
            curves
        })
    })
}

fn asked<'a>(
    context: &'a Context,
    run: &'a RunRecord,
    (logs, state): (&[ModulusLog], Option<&StateOfRun>),
) -> Asked<'a> {
    let campaign = &context.campaign;
    let sample = run.tag(keys::SAMPLE).and_then(|id| campaign.sample(id));
    let humidity = run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT);
    let (modulus_mpa, _) = sample_modulus(logs, campaign, sample, humidity);
    let hash = state.map(|state| {
        let hash = Hash::default().with(&"without a model").with(&state.run);
        hash.with(&sample).with(&modulus_mpa).text()
    });
    Asked {
        run,
        sample,
        modulus_mpa,
        hash,
    }
}

impl Asked<'_> {
    fn answer(&self, channels: &[Channel], kept: &Cache) -> Said {
        let step = model_free(self.run, channels, self.sample, &self.modulus_mpa);
        let said = (step, cycle_run(self.run, channels));
        if let Some(hash) = &self.hash {
            kept.put(hash, &said);
        }
        said
    }
}

/// The channels of the strip as a whole.
fn channels(context: &Context, run: &RunRecord) -> Result<Vec<Channel>, PipelineError> {
    let mut channels = readings::of_run(context, run)?;
    let density = channels
        .iter()
        .find(|channel| channel.is_whole(Quantity::CurrentDensity));
    let current = density
        .zip(run.area_cm2)
        .map(|(density, area_cm2)| density.as_current(area_cm2));
    channels.extend(current);
    Ok(channels)
}
