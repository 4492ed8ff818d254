//! What runs under a sine or a chirp say of current and bending against frequency. Nothing of it is stored: it follows from
//! the readings and the current fits whenever it is read.

use crate::analysis::frequency::{FrequencyPoint, FrequencyRun, PerVolt, frequency_run};
use crate::domain::{Drive, Fit, RunRecord};
use crate::model::LumpedModel;
use crate::numerics::complex::Complex;
use crate::pipeline::campaign::batch::compute;
use crate::pipeline::campaign::readings;
use crate::pipeline::{Context, PipelineError};

/// Those of the runs whose voltage is a sine or a chirp, in their order.
///
/// # Errors
/// The database cannot be read.
pub fn frequency_runs(context: &Context, runs: &[RunRecord]) -> Result<Vec<FrequencyRun>, PipelineError> {
    let moves = |run: &&RunRecord| run.drive.as_ref().is_some_and(Drive::moves);
    let moving: Vec<&RunRecord> = runs.iter().filter(moves).collect();
    let load = |context: &Context, run: &&RunRecord| readings::of_run(context, run);
    let found = compute(context, &moving, load, |run, channels| {
        let model = run
            .fit
            .as_ref()
            .zip(run.area_cm2)
            .and_then(|(fit, area_cm2)| modelled(fit, area_cm2));
        match &model {
            Some(model) => frequency_run(run, &channels, Some(model)),
            None => frequency_run(run, &channels, None),
        }
    })?;
    Ok(found.into_iter().flatten().collect())
}

/// The transfer functions of a fit with a lumped model; none where it leaves a branch open.
fn modelled(fit: &Fit, area_cm2: f64) -> Option<impl Fn(f64) -> FrequencyPoint> {
    let value = |key: &str| fit.parameter(key).and_then(|estimate| estimate.value);
    // A steady current that is too small to be seen is none.
    let model = LumpedModel::of_parameters(value);
    let stated = |k: &usize| fit.parameter(&format!("r{k}_ohm_cm2")).is_some();
    let is_whole = (1..).take_while(stated).count() == model.branches.len();
    let exact = |value: Complex| Some(PerVolt { value, half_95: 0.0 });
    (is_whole && !model.branches.is_empty()).then_some(move |frequency_hz: f64| FrequencyPoint {
        frequency_hz,
        current: exact(model.admittance_a_per_v(area_cm2, frequency_hz)),
        curvature: exact(model.curvature_per_cm_v(area_cm2, frequency_hz))
            .filter(|_| model.charge_to_curvature_per_c_cm != 0.0),
    })
}
