//! How a way to make the run comes out: simulated with its noise, fitted, and counted.

use rayon::prelude::*;

use super::document::PlannedParameter;
use super::subject::Subject;
use super::trial::Trial;
use crate::domain::{Channel, Estimate, Fit, Quantity};
use crate::fit::{FitInput, fit_run};
use crate::model::ParameterDescription;
use crate::pipeline::Observer;
use crate::truth::noise;

/// What the fits of all draws say of each parameter, in the order of the model.
pub(super) fn judged(
    subject: &Subject,
    trial: &Trial,
    (draws, seed): (usize, u64),
    observer: &dyn Observer,
) -> Vec<PlannedParameter> {
    let fitted = |draw: usize| {
        // Where in an interval the drive begins nobody chooses: every part of it comes alike.
        let phase = (draw as f64 + 0.5) / draws as f64;
        let fit = fit_of_draw(subject, trial, phase, (seed, draw));
        observer.advance();
        fit.map(|fit| matched(subject, &fit))
    };
    let fits: Vec<Result<Vec<Estimate>, String>> = (0..draws).into_par_iter().map(fitted).collect();
    let known = subject.known();
    let of = |(at, (described, value)): (usize, &(ParameterDescription, f64))| {
        let estimates = fits.iter().map(|fit| match fit {
            Ok(estimates) => estimates[at].clone(),
            Err(reason) => Estimate::not_determined(reason.clone()),
        });
        PlannedParameter::of(described, *value, &estimates.collect::<Vec<_>>())
    };
    known.iter().enumerate().map(of).collect()
}

/// One simulated run, fitted as the pipeline fits it.
fn fit_of_draw(
    subject: &Subject,
    trial: &Trial,
    phase: f64,
    (seed, draw): (u64, usize),
) -> Result<Fit, String> {
    let (time_s, bending_s) = (
        trial.times(trial.every_s, phase),
        trial.times(trial.bending_every_s, phase),
    );
    let stream = 2 * draw as u64;
    let current = subject.model.current_a(&trial.drive, subject.area_cm2, &time_s);
    let current = noise(&current, &subject.current_noise, seed, stream);
    let drive = trial.told(&time_s);
    let mut channels = vec![Channel::new(Quantity::Current, time_s.into(), current.into())];
    if let Some(of_bending) = &subject.curvature_noise {
        let curvature = subject
            .model
            .curvature_per_cm(&trial.drive, subject.area_cm2, &bending_s);
        let curvature = noise(&curvature, of_bending, seed, stream + 1);
        channels.push(Channel::new(
            Quantity::Curvature,
            bending_s.into(),
            curvature.into(),
        ));
    }
    let input = FitInput {
        channels: &channels,
        drive: &drive,
        area_cm2: subject.area_cm2,
    };
    fit_run(&input, &subject.options).map_err(|error| error.to_string())
}

/// The estimates of a fit for the parameters that were simulated: a fit that sees fewer branches calls the first one that
/// it sees 1, whichever of the strip's it is.
fn matched(subject: &Subject, fit: &Fit) -> Vec<Estimate> {
    let taus: Vec<f64> = subject.taus_s();
    let seen: Vec<(usize, Option<f64>)> = (0..subject.options.model.branches)
        .map(|k| (k, tau_s(fit, k)))
        .collect();
    let apart = |tau_s: f64, of: usize| (tau_s / taus[of]).ln().abs();
    let nearest = |tau_s: f64| (0..taus.len()).min_by(|a, b| apart(tau_s, *a).total_cmp(&apart(tau_s, *b)));
    let branch = |of: usize| {
        let by_time = seen.iter().filter_map(|(k, tau)| Some((*k, (*tau)?)));
        let own = by_time.filter(|(_, tau)| nearest(*tau) == Some(of));
        let found = own.min_by(|a, b| apart(a.1, of).total_cmp(&apart(b.1, of)));
        // A branch without a time of its own can only be the one of its number.
        found
            .map(|(k, _)| k)
            .or_else(|| seen.get(of).filter(|(_, tau)| tau.is_none()).map(|(k, _)| *k))
    };
    let estimate = |(described, _): &(ParameterDescription, f64)| {
        let key = match subject.branch_of(described.key) {
            None => Some(described.key.to_owned()),
            Some(of) => branch(of).map(|k| described.key.replacen(char::is_numeric, &(k + 1).to_string(), 1)),
        };
        let found = key.and_then(|key| fit.parameter(&key).cloned());
        found.unwrap_or_else(|| Estimate::not_determined("the fit sees no such branch"))
    };
    subject.known().iter().map(estimate).collect()
}

/// Time constant of a fit's branch, where both of its values are determined.
fn tau_s(fit: &Fit, branch: usize) -> Option<f64> {
    let value = |key: String| fit.parameter(&key)?.value;
    let (r, c) = (
        format!("r{}_ohm_cm2", branch + 1),
        format!("c{}_f_per_cm2", branch + 1),
    );
    Some(value(r)? * value(c)?)
}
