//! What runs say without a model, and trains cycle by cycle. Nothing of it is stored: it follows from the readings whenever
//! it is read.

use rayon::prelude::*;

use crate::analysis::cycles::{CycleRun, cycle_run};
use crate::analysis::model_free::{ModelFree, model_free};
use crate::analysis::stiffness::sample_modulus;
use crate::domain::tag::keys;
use crate::domain::{Channel, Quantity, RunRecord};
use crate::ingest::derived;
use crate::pipeline::campaign::standing;
use crate::pipeline::{Context, PipelineError};

/// Runs whose readings are in memory together.
const TOGETHER: usize = 32;

/// What runs say without a model.
#[derive(Debug, Default)]
pub struct WithoutModel {
    /// Steps.
    pub steps: Vec<ModelFree>,
    /// Trains.
    pub trains: Vec<CycleRun>,
}

/// What the runs with a drive say, in their order.
///
/// # Errors
/// The database cannot be read.
pub fn without_model(context: &Context, runs: &[RunRecord]) -> Result<WithoutModel, PipelineError> {
    let campaign = &context.campaign;
    let (logs, _) = standing::modulus_logs(context)?;
    let driven: Vec<&RunRecord> = runs.iter().filter(|run| run.drive.is_some()).collect();
    let mut found = WithoutModel::default();
    for some in driven.chunks(TOGETHER) {
        let read: Vec<(&RunRecord, Vec<Channel>)> = some
            .iter()
            .map(|run| Ok((*run, channels(context, run)?)))
            .collect::<Result<_, PipelineError>>()?;
        let sample = |run: &RunRecord| run.tag(keys::SAMPLE).and_then(|id| campaign.sample(id));
        let of = |(run, channels): &(&RunRecord, Vec<Channel>)| {
            let (sample, humidity) = (sample(run), run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT));
            let (modulus_mpa, _) = sample_modulus(&logs, campaign, sample, humidity);
            let step = model_free(run, channels, sample, &modulus_mpa);
            (step, cycle_run(run, channels))
        };
        for (step, train) in read.par_iter().map(of).collect::<Vec<_>>() {
            found.steps.extend(step);
            found.trains.extend(train);
        }
    }
    Ok(found)
}

/// The channels of the strip as a whole.
fn channels(context: &Context, run: &RunRecord) -> Result<Vec<Channel>, PipelineError> {
    let sample = run.tag(keys::SAMPLE).and_then(|id| context.campaign.sample(id));
    let length_cm = sample
        .and_then(|sample| sample.length_mm)
        .map(|length_mm| length_mm / 10.0);
    let mut channels = derived::responses(&context.store.channels(run.id)?, length_cm);
    let density = channels
        .iter()
        .find(|channel| channel.is_whole(Quantity::CurrentDensity));
    let current = density
        .zip(run.area_cm2)
        .map(|(density, area_cm2)| density.as_current(area_cm2));
    channels.extend(current);
    Ok(channels)
}
