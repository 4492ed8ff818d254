//! Criteria by which models of the same readings are held against each other.

use super::RunAtHand;
use crate::domain::{ChannelNoise, Fit};
use crate::model::ModelChoice;
use crate::numerics::correlation::{long_run_ratio, readings_per_independent};

/// How well a fit describes its readings for the parameters that it took: the smaller the better.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criteria {
    /// Parameters that were searched; zeros of the instruments, which every model has, are not counted.
    pub parameters: usize,
    /// Akaike's information criterion, -2 ln L + 2 k.
    pub aic: f64,
    /// Bayesian information criterion, -2 ln L + k ln n.
    pub bic: f64,
}

/// The criteria of a fit under the noise that was found without the model, as `ieap compare` has them: what noise of that
/// size and memory makes of its residuals, n in independent readings. What all fits of the readings have in common is left
/// out, so that only differences mean something. None where the noise is not known.
pub fn criteria(fit: &Fit, run: &RunAtHand) -> Option<Criteria> {
    let model = ModelChoice::parse(&fit.model).ok()?.base;
    let searched = model.parameters.iter().filter(|of| !of.derived);
    let parameters = searched
        .filter(|of| fit.parameter(of.key).is_some_and(|own| own.value.is_some()))
        .count();
    let (mut misfit, mut independent) = (0.0, 0.0);
    for own in &fit.noise {
        let readings = own.readings as f64 / memory(own, run).max(1.0);
        misfit += readings * (own.residual_rms / own.standard_deviation).powi(2);
        independent += readings;
    }
    let k = parameters as f64;
    (!fit.noise.is_empty() && misfit.is_finite()).then(|| Criteria {
        parameters,
        aic: misfit + 2.0 * k,
        bic: misfit + k * independent.max(2.0).ln(),
    })
}

/// Variance of a long sum per reading over that of a reading; 1 for white noise.
fn memory(noise: &ChannelNoise, run: &RunAtHand) -> f64 {
    let Some(lasts_s) = noise.character.correlation_time_s else {
        return long_run_ratio(&noise.character.autoregression);
    };
    let times = run.channels.iter().find(|own| own.quantity == noise.quantity);
    let ends = times.and_then(|own| Some(own.time_s.last()? - own.time_s.first()?));
    let apart_s = ends.unwrap_or(f64::INFINITY) / noise.readings as f64;
    readings_per_independent((-apart_s / lasts_s).exp())
}
