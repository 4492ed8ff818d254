//! The identified parameters as a `Fit`: estimates, noise, curves and issues.

mod issues;
mod response;

use std::borrow::Cow;

use ieap_domain::{ChannelNoise, Drive, Estimate, Fit, Parameter, Quantity, RunCurve};
use ieap_model::FitModel;
use ieap_numerics::least_squares::Stop;

use super::estimates::{CHARGE_OPEN, CHARGE_UNSEEN, HIDES_BRANCH, bending_estimate, electrical_estimate};
use super::group::Found;
use super::joint::feature::Feature;
use super::joint::readings::RunReadings;
use super::joint::single::Judged;
use super::joint_estimates::{self, judged_estimate};
use super::sampled::Sampled;
use super::uncertainty::Residuals;
use crate::factors::only_with_their_factors;
use crate::nuisances;
use crate::options::{FitInput, FitOptions, NoiseBy};
use crate::two_steps::Identified;
use crate::zero::Zero;

use issues::issues;
pub(super) use issues::{bent_at_rest, not_converged, parameter_issues};
use response::{Response, Wanted};

/// Puts everything together.
pub(super) fn fit(
    input: &FitInput,
    options: &FitOptions,
    identified: &Identified,
    judged: Option<&Judged>,
) -> Fit {
    with(input, options, identified, judged, Wanted::of(options))
}

/// The same without what only people look at: the character of the noise, and curves.
pub(super) fn for_its_estimates(input: &FitInput, options: &FitOptions, identified: &Identified) -> Fit {
    with(input, options, identified, None, Wanted::ESTIMATES)
}

fn with(
    input: &FitInput,
    options: &FitOptions,
    identified: &Identified,
    judged: Option<&Judged>,
    wanted: Wanted,
) -> Fit {
    let model = options.model;
    let mut parameters = parameters(input, model, identified, judged);
    only_with_their_factors(&mut parameters);
    let step_s = input
        .drive
        .segments
        .first()
        .map_or(0.0, |segment| segment.start_s());
    let current = identified.current.as_ref().ok();
    let curvature = identified.curvature.as_ref().ok();
    let [judged_current, judged_curvature] = judged.map_or([None, None], |judged| {
        [judged.fitted[0].as_ref(), judged.fitted[1].as_ref()]
    });
    let mut responses: Vec<Response> = Vec::new();
    if let Some((sampled, electrical)) = current {
        let circuit = 2 * judged.map_or(0, |judged| judged.branches) + 1;
        responses.push(Response::new(
            Quantity::Current,
            sampled,
            Some(&*settled(sampled, &electrical.residuals, judged_current, circuit)),
            step_s,
            wanted,
        ));
    }
    if let Some((sampled, bending)) = curvature {
        responses.push(Response::new(
            Quantity::Curvature,
            sampled,
            Some(&*settled(sampled, &bending.residuals, judged_curvature, 2)),
            step_s,
            wanted,
        ));
    }
    if let (Some(_), NoiseBy::Kinds(Some(known))) = (judged, options.noise) {
        for response in &mut responses {
            response.noise.character.runs_of_instrument = known.runs();
        }
    }
    let n_samples = responses.iter().map(|response| response.noise.readings).sum();
    if let Some(sampled) = identified
        .unfitted_curvature
        .as_ref()
        .filter(|sampled| sampled.len() > 0)
    {
        responses.push(Response::new(Quantity::Curvature, sampled, None, step_s, wanted));
    }
    Fit {
        extended: None,
        model: model.id.to_owned(),
        model_version: model.version,
        method: method(options, judged),
        converged: current.is_none_or(|(_, e)| e.stop.converged())
            && curvature.is_none_or(|(_, b)| b.stop.converged())
            && judged.is_none_or(|judged| judged.stop.converged())
            && (current.is_some() || curvature.is_some()),
        why_stopped: why_stopped(identified, judged),
        n_samples,
        r_squared_current: r_squared(&responses, Quantity::Current),
        r_squared_curvature: r_squared(&responses, Quantity::Curvature),
        issues: issues(input.drive, identified, &parameters, judged),
        evaluations: judged.map_or(0, |judged| judged.evaluations)
            + current.map_or(0, |(_, e)| e.evaluations)
            + curvature.map_or(0, |(_, b)| b.evaluations),
        parameters,
        nuisances: nuisances::of_steps(
            current.map(|(_, electrical)| electrical),
            curvature.map(|(_, bending)| bending),
            judged,
        ),
        noise: responses.iter().map(|response| response.noise.clone()).collect(),
        curves: responses.into_iter().map(|response| response.curve).collect(),
        along: Vec::new(),
    }
}

fn r_squared(responses: &[Response], quantity: Quantity) -> Option<f64> {
    let mut noises = responses.iter().map(|response| &response.noise);
    noises.find(|noise| noise.quantity == quantity)?.r_squared
}

/// How the minimum was searched.
fn method(options: &FitOptions, judged: Option<&Judged>) -> String {
    let steps = format!("two-step {}", options.method.name());
    match judged {
        None => steps,
        Some(Judged {
            fitted: [_, Some(_)], ..
        }) => format!("{steps}, then both responses at once, weighted by the noise"),
        Some(_) => format!("{steps}, then weighted by the noise"),
    }
}

/// Residuals at the place that the estimates stand for: of the step itself, or of what was fitted after it.
fn settled<'a>(
    sampled: &Sampled,
    of_step: &'a Residuals,
    fitted: Option<&Vec<f64>>,
    searched: usize,
) -> Cow<'a, Residuals> {
    match fitted {
        Some(fitted) => Cow::Owned(Residuals::new(sampled, fitted.clone(), searched)),
        None => Cow::Borrowed(of_step),
    }
}

fn parameters(
    input: &FitInput,
    model: &FitModel,
    identified: &Identified,
    judged: Option<&Judged>,
) -> Vec<Parameter> {
    let estimate = |key: &str| {
        let feature = Feature::of_key(key, model.branches)?;
        if let Some(estimate) = judged.and_then(|judged| judged_estimate(feature, judged, input.drive)) {
            return Some(estimate);
        }
        let bending = identified
            .curvature
            .as_ref()
            .map(|(_, bending)| bending)
            .map_err(String::as_str);
        let electrical = || match &identified.current {
            Ok((_, electrical)) => electrical_estimate(feature, electrical, input.drive),
            Err(reason) => Some(Estimate::not_determined(reason.as_str())),
        };
        let is_too_fast = matches!(&identified.current, Ok((_, electrical)) if electrical.is_too_fast());
        if is_too_fast && feature == Feature::Coupling && bending.is_ok() {
            return Some(Estimate::not_determined(CHARGE_UNSEEN));
        }
        // The charge that bends the strip is that of a circuit.
        let bending = match charge_open(input.drive, identified) {
            Some(why) => bending.and(Err(why)),
            None => bending,
        };
        bending_estimate(feature, bending).or_else(electrical)
    };
    let with_estimate = |key: &str| {
        Some(Parameter {
            key: key.to_owned(),
            estimate: estimate(key)?,
        })
    };
    model
        .parameters
        .iter()
        .filter_map(|description| with_estimate(description.key))
        .collect()
}

/// Why a voltage that moves leaves the capacitance open, and with it the charge that bends the strip; none where it does not.
/// After a step the charge is seen where it ends, whatever the branches are.
pub(super) fn charge_open(drive: &Drive, identified: &Identified) -> Option<&'static str> {
    let (_, electrical) = identified.current.as_ref().ok()?;
    if electrical.hides_branch {
        return Some(HIDES_BRANCH);
    }
    let capacitance = electrical_estimate(Feature::TotalCapacitance, electrical, drive);
    let is_open = drive.moves() && capacitance.is_none_or(|estimate| estimate.value.is_none());
    is_open.then_some(CHARGE_OPEN)
}

/// Parameters of a joint fit in the model's order.
pub(super) fn joint_parameters(model: &FitModel, features: &[Found], drive: &Drive) -> Vec<Parameter> {
    let of = |key: &str| {
        let feature = Feature::of_key(key, model.branches)?;
        let found = features.iter().find(|(own, ..)| *own == feature);
        let missing = || Estimate::not_determined("nothing in the run tells of it");
        Some(Parameter {
            key: key.to_owned(),
            estimate: found.map_or_else(missing, |(_, interval, partner)| {
                joint_estimates::estimate(feature, interval, drive, *partner)
            }),
        })
    };
    model
        .parameters
        .iter()
        .filter_map(|description| of(description.key))
        .collect()
}

/// Noise and curve of one response under a model of `searched` parameters that gives `fitted` at its readings.
pub(super) fn judged_response(
    quantity: Quantity,
    sampled: &Sampled,
    fitted: Vec<f64>,
    drive: &Drive,
    searched: usize,
) -> (ChannelNoise, RunCurve) {
    let step_s = drive.segments.first().map_or(0.0, |segment| segment.start_s());
    let residuals = Residuals::new(sampled, fitted, searched);
    let response = Response::new(quantity, sampled, Some(&residuals), step_s, Wanted::NOISE);
    (response.noise, response.curve)
}

/// One run of a joint fit.
pub(super) fn joint_fit(
    input: &FitInput,
    model: &'static FitModel,
    run: &RunReadings,
    fitted: [Option<Vec<f64>>; 2],
    (mut parameters, zeros): (Vec<Parameter>, [Option<Zero>; 2]),
    (stop, evaluations): (Stop, u64),
) -> Fit {
    only_with_their_factors(&mut parameters);
    let step_s = input
        .drive
        .segments
        .first()
        .map_or(0.0, |segment| segment.start_s());
    let count = 2 * model.branches + 1;
    let quantities = [(Quantity::Current, count), (Quantity::Curvature, 2)];
    let responses: Vec<Response> = [&run.current, &run.curvature]
        .into_iter()
        .zip(fitted)
        .zip(quantities)
        .filter_map(|((response, fitted), (quantity, count))| {
            let sampled = &response.as_ref()?.sampled;
            let residuals = Residuals::new(sampled, fitted?, count);
            Some(Response::new(
                quantity,
                sampled,
                Some(&residuals),
                step_s,
                Wanted::NOISE,
            ))
        })
        .collect();
    let mut issues = parameter_issues(&parameters);
    if !stop.converged() {
        issues.push(not_converged(stop));
    }
    Fit {
        extended: None,
        model: model.id.to_owned(),
        model_version: model.version,
        method: "simultaneous least squares, weighted by the noise".to_owned(),
        converged: stop.converged(),
        why_stopped: stop.words().to_owned(),
        n_samples: run.len(),
        r_squared_current: r_squared(&responses, Quantity::Current),
        r_squared_curvature: r_squared(&responses, Quantity::Curvature),
        issues,
        evaluations,
        parameters,
        nuisances: (responses.iter().map(|response| response.noise.quantity))
            .map(|quantity| {
                let place = usize::from(quantity == Quantity::Curvature);
                nuisances::zero(quantity, zeros[place])
            })
            .chain(nuisances::memories(run.memories()))
            .collect(),
        noise: responses.iter().map(|response| response.noise.clone()).collect(),
        curves: responses.into_iter().map(|response| response.curve).collect(),
        along: Vec::new(),
    }
}

/// Why the search of the electrical parameters stopped.
pub(super) fn current_words(identified: &Identified) -> String {
    match &identified.current {
        Ok((_, electrical)) => format!("current: {}", electrical.stop.words()),
        Err(reason) => format!("current: not fitted, {reason}"),
    }
}

fn why_stopped(identified: &Identified, judged: Option<&Judged>) -> String {
    let current = current_words(identified);
    let curvature = match &identified.curvature {
        Ok((_, bending)) => format!("curvature: {}", bending.stop.words()),
        Err(reason) => format!("curvature: not fitted, {reason}"),
    };
    let afterwards = judged.map_or_else(String::new, |judged| {
        format!("; weighted by the noise: {}", judged.stop.words())
    });
    format!("{current}; {curvature}{afterwards}")
}
