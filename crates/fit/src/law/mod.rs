//! Fits of rival models: the circuit of two branches from the current, as for lumped-2; then, with that fixed, the
//! rival's law of bending from the curvature. So all models answer the same question with the same charge.

mod identified;
mod landscape;
mod stated;
#[cfg(test)]
mod tests;

use ieap_domain::{Fit, Issue, Parameter, Quantity};
use ieap_model::BendingLaw;

use super::electrical::Electrical;
use super::moving;
use super::outcome::{self, bent_at_rest, current_words, judged_response, not_converged, parameter_issues};
use super::sampled::Sampled;
use crate::nuisances;
use crate::options::{FitInput, FitOptions, Steps};
use crate::plain::judge;
use crate::two_steps::{Identified, Readings, identify, needed};
use crate::zero::Zero;
pub(super) use identified::{Bent, identify_law};
use stated::{not_known, stated};

/// The law with the readings that it was fitted to, or why there is none with the readings to draw.
type Outcome = Result<(Sampled, Bent), Box<Unfitted>>;

/// What a fit says of the intervals of its bending: those of lumped models may be of another kind.
const INTERVALS: &str = "; intervals of the bending from the covariance at the minimum";

/// Readings that no law was fitted to, and why.
struct Unfitted {
    sampled: Option<Sampled>,
    why: String,
}

/// Fits a run with the rival model of `options`.
pub(super) fn fit(
    input: &FitInput,
    options: &FitOptions,
    law: &'static dyn BendingLaw,
    readings: Readings,
) -> Fit {
    let Readings { current, curvature } = readings;
    let of_current = Readings {
        current,
        curvature: None,
    };
    let mut identified = identify(input, options, of_current, None);
    let outcome = bend(input, options, law, &identified.current, curvature);
    if let Err(unfitted) = &outcome {
        identified.unfitted_curvature.clone_from(&unfitted.sampled);
        identified.curvature = Err(unfitted.why.clone());
    }
    let judged = if input.drive.moves() {
        moving::look_closer(input, options, &mut identified);
        None
    } else {
        judge(input, options, &mut identified)
    };
    let mut fit = outcome::fit(input, options, &identified, judged.as_ref());
    add_law(&mut fit, input, law, &identified, &outcome);
    fit.method.push_str(INTERVALS);
    fit.parameters = in_order(fit.parameters, options);
    if options.steps == Steps::Simultaneous {
        let words = format!(
            "{} is fitted in two steps only: the current first, then the curvature",
            options.model.id
        );
        fit.issues.push(Issue::note("two-steps-only", words));
    }
    fit
}

/// Fits the law to the curvature, given the circuit.
fn bend(
    input: &FitInput,
    options: &FitOptions,
    law: &'static dyn BendingLaw,
    current: &Result<(Sampled, Electrical), String>,
    curvature: Option<Sampled>,
) -> Outcome {
    let Some(sampled) = curvature else {
        return Err(Box::new(Unfitted {
            sampled: None,
            why: "the run has no curvature channel".to_owned(),
        }));
    };
    let refused = match (current, law.refuses(input.drive)) {
        (_, Some(why)) => Some(format!("{} does not describe this run: {why}", options.model.id)),
        (Err(why), _) => Some(format!("the charge that bends the strip is not known: {why}")),
        (Ok((_, electrical)), _) if electrical.conductances_a_per_v.is_empty() => {
            Some("the current shows no charge that could bend the strip".to_owned())
        }
        _ if sampled.after_step() < needed(options.model) => Some(format!(
            "the curvature has {} usable readings after the step, {} are needed",
            sampled.after_step(),
            needed(options.model)
        )),
        _ => None,
    };
    match (refused, current) {
        (None, Ok((_, electrical))) => {
            let bent = identify_law(law, input.drive, electrical, &sampled, options.search());
            Ok((sampled, bent))
        }
        (why, _) => Err(Box::new(Unfitted {
            sampled: Some(sampled),
            why: why.unwrap_or_default(),
        })),
    }
}

/// Adds what the law says to a fit of the current.
fn add_law(
    fit: &mut Fit,
    input: &FitInput,
    law: &'static dyn BendingLaw,
    identified: &Identified,
    outcome: &Outcome,
) {
    let (sampled, bent) = match outcome {
        Ok(found) => found,
        Err(unfitted) => {
            let why = &unfitted.why;
            let missing: Vec<Parameter> = law.reported().iter().map(|own| not_known(own, why)).collect();
            fit.issues.extend(parameter_issues(&missing));
            fit.parameters.extend(missing);
            return;
        }
    };
    let parameters = match outcome::charge_open(input.drive, identified) {
        Some(why) => law.reported().iter().map(|own| not_known(own, why)).collect(),
        None => stated(law, bent),
    };
    fit.issues.extend(parameter_issues(&parameters));
    fit.parameters.extend(parameters);
    fit.nuisances
        .push(nuisances::zero(Quantity::Curvature, bent.zero));
    fit.nuisances
        .extend(nuisances::memories([None, Some(bent.residuals.memory())]));
    fit.issues
        .extend(bent.zero.filter(Zero::is_plain).map(bent_at_rest));
    if !bent.stop.converged() {
        fit.issues.push(not_converged(bent.stop));
    }
    let fitted = bent.residuals.fitted.to_vec();
    let (noise, curve) = judged_response(Quantity::Curvature, sampled, fitted, input.drive, bent.searched());
    fit.why_stopped = format!("{}; curvature: {}", current_words(identified), bent.stop.words());
    fit.converged &= bent.stop.converged();
    fit.n_samples += noise.readings;
    fit.r_squared_curvature = noise.r_squared;
    fit.evaluations += bent.evaluations;
    fit.noise.push(noise);
    fit.curves.push(curve);
}

/// The parameters in the order of the registry.
fn in_order(found: Vec<Parameter>, options: &FitOptions) -> Vec<Parameter> {
    let of = |key: &str| found.iter().find(|own| own.key == key).cloned();
    options
        .model
        .parameters
        .iter()
        .filter_map(|about| of(about.key))
        .collect()
}
