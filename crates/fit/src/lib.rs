//! Identification of a run with a model, in two steps as in the thesis: the electrical parameters from the
//! current; then, with those fixed, coupling and relaxation rate from the curvature.
//!
//! A fit is a pure function of its input and options, the seed of a random method among them: the same readings
//! give the same bytes.

mod bending;
mod bending_alone;
mod carried;
mod circuit;
mod coupled;
mod described;
pub mod distributed;
mod edges;
mod electrical;
mod error;
mod estimates;
mod given;
mod group;
pub mod impedance;
mod interval_rule;
mod joint;
mod joint_estimates;
mod law;
mod line;
mod means;
mod moving;
mod noise_again;
mod options;
mod outcome;
mod own_clock;
mod parabola;
mod policy;
mod sampled;
mod search;
mod settled_edges;
mod strain;
mod two_steps;
mod uncertainty;
mod unseen_charge;
mod unseen_start;
mod whitened;
mod widened;

use crate::joint::policy::MISFIT_FACTOR;
use ieap_domain::{Drive, Fit, KnownParameter};
use ieap_model::rival_law;

pub use described::{Described, Left, Noise, describe};
pub use edges::{EdgeTimes, Shift};
pub use error::FitError;
pub use given::{BaseKnowledge, Predict, fit_of_run};
pub use group::known::can_be_known;
pub use group::reductions::{Circuit, Reduction, Reductions, reductions};
pub use group::step_and_spectrum::{StepAndSpectrum, step_and_spectrum};
pub use group::{
    Bootstrap, GroupFit, GroupOptions, Intervals, Resampled, Sharing, can_join_group, fit_group, shareable,
};

pub use moving::{MOVING_VERSION, least_squares_place};
pub use noise_again::{FoundAgain, NoiseAgain, Pair, Scaled};
pub use options::{FitInput, FitOptions, Steps};
pub use own_clock::{Aligned, aligned};
pub use whitened::WhitenedChannel;

use joint::readings::{Response, RunReadings};
use joint::single::Judged;
use sampled::Sampled;
use two_steps::{Identified, Readings, identify, needed};

#[cfg(test)]
mod any_input;
#[cfg(test)]
mod tests;

/// Fits a run. Edges of the drive that only readings tell of are sought between these; what is left open of them widens the
/// intervals.
///
/// What the data leave open is reported in the fit: an estimate without a value, or with a bound, says why.
///
/// # Errors
/// [`FitError`] where there is nothing to fit: no response channel, too few readings after the step, an area
/// or a drive that is none.
pub fn fit_run(input: &FitInput, options: &FitOptions) -> Result<Fit, FitError> {
    let readings = Readings::new(input)?;
    readings.check(input, options)?;
    let Some(aligned) = aligned(input, options) else {
        return fit_on_one_clock(input, options);
    };
    let mut fit = fit_on_one_clock(
        &FitInput {
            channels: &aligned.channels,
            ..*input
        },
        options,
    )?;
    own_clock::widen(&mut fit, input, options, &aligned);
    Ok(fit)
}

fn fit_on_one_clock(input: &FitInput, options: &FitOptions) -> Result<Fit, FitError> {
    if unseen_start::is_unseen(input.drive) {
        return unseen_start::fit(input, options, |input| fit_seen(input, options));
    }
    fit_seen(input, options)
}

/// Fits a run whose edges are stated or lie between readings.
fn fit_seen(input: &FitInput, options: &FitOptions) -> Result<Fit, FitError> {
    let settled = settled_edges::settled(input, options)?;
    let placed = FitInput {
        drive: settled.edges.drive(),
        ..*input
    };
    let mut fit = fit_placed(&placed, options)?;
    if !settled.open.is_empty() {
        widened::widen(&mut fit, &settled, |drive| {
            Some(in_two_steps(&FitInput { drive, ..*input }, options)?.parameters)
        });
    }
    Ok(fit)
}

/// The same of a run of which something is known beforehand; with nothing known it is [`fit_run`].
///
/// Both responses are then fitted at once, and the fit says what was taken as known, and where the readings contradict it.
///
/// # Errors
/// As [`fit_run`]; or [`FitError::Known`]: what is said to be known is none of a lumped model's parameters or cannot be, or
/// the run's voltage moves all the time.
pub fn fit_knowing(
    input: &FitInput,
    options: &FitOptions,
    known: &[KnownParameter],
) -> Result<Fit, FitError> {
    if known.is_empty() {
        return fit_run(input, options);
    }
    if input.drive.moves() {
        return Err(FitError::Known {
            found: known[0].to_string(),
            reason: "the voltage moves all the time; leave it out, or fit a run of steps or pulses"
                .to_owned(),
        });
    }
    let settled = settled_edges::settled(input, options)?;
    let with = |drive: &Drive| group::known::fit(&FitInput { drive, ..*input }, options.model, known);
    let mut fit = with(settled.edges.drive())?;
    if !settled.open.is_empty() {
        widened::widen(&mut fit, &settled, |drive| Some(with(drive).ok()?.parameters));
    }
    Ok(fit)
}

/// The drive of a run with its edges where [`fit_run`] takes them to be: those that only readings tell of are sought between
/// these.
///
/// # Errors
/// As [`fit_run`].
pub fn placed_drive(input: &FitInput, options: &FitOptions) -> Result<Drive, FitError> {
    Ok(settled_edges::settled(input, options)?.edges.drive().clone())
}

/// A run in two steps, of its bending alone, or by the law of a rival, and nothing further; none where there is nothing to fit.
fn in_two_steps(input: &FitInput, options: &FitOptions) -> Option<Fit> {
    let readings = Readings::new(input).ok()?;
    if let Some(law) = rival_law(options.model.id) {
        return Some(law::fit(input, options, law, readings));
    }
    let mut identified = identify(input, options, readings);
    unseen_charge::look(input, options, &mut identified);
    let alone = bending_alone(input, options, &identified);
    Some(alone.unwrap_or_else(|| outcome::fit(input, options, &identified, None)))
}

/// The fit of the curvature where the current tells of no circuit; none where there are too few readings of it.
fn bending_alone(input: &FitInput, options: &FitOptions, identified: &Identified) -> Option<Fit> {
    let why = identified.current.as_ref().err()?;
    let curvature = identified.unfitted_curvature.as_ref()?;
    let enough = curvature.after_step() >= needed(options.model);
    enough.then(|| bending_alone::fit(input, options, curvature.clone(), why))?
}

/// Fits a run whose edges are where its drive has them.
fn fit_placed(input: &FitInput, options: &FitOptions) -> Result<Fit, FitError> {
    let readings = Readings::new(input)?;
    if let Some(law) = rival_law(options.model.id) {
        return Ok(law::fit(input, options, law, readings));
    }
    let mut identified = identify(input, options, readings);
    if input.drive.moves() {
        moving::look_closer(input, options, &mut identified);
        return Ok(outcome::fit(input, options, &identified, None));
    }
    if options.steps == Steps::Simultaneous && identified.current.is_ok() {
        let group = group::fit_placed(&[*input], &GroupOptions::sharing_all(options.model))?;
        if let Some(fit) = group.runs.into_iter().next() {
            return Ok(fit);
        }
    }
    if let Some(fit) = bending_alone(input, options, &identified) {
        return Ok(fit);
    }
    unseen_charge::look(input, options, &mut identified);
    let judged = judge(input, options, &mut identified);
    Ok(outcome::fit(input, options, &identified, judged.as_ref()))
}

/// Fits both responses at once, with intervals by profile likelihood, where the covariance of the two steps would
/// mislead; estimates, curves and residuals are then those of that fit.
fn judge(input: &FitInput, options: &FitOptions, identified: &mut Identified) -> Option<Judged> {
    let (current, electrical) = identified.current.as_mut().ok()?;
    if electrical.unseen.is_some() {
        // Estimated by itself, beside what the likelihood of the readings tells.
        return None;
    }
    let bending = identified.curvature.as_ref().ok();
    let branches = options.model.branches;
    let settled = parabola::is_settled(electrical, bending.map(|(_, bending)| bending), branches);
    let parabolic = settled && parabola::is_narrow(electrical);
    let even = current.is_even() && bending.is_none_or(|(curvature, _)| curvature.is_even());
    let misfit = misfits(current, electrical.residuals.square)
        || bending.is_some_and(|(curvature, bending)| misfits(curvature, bending.residuals.square));
    if electrical.conductances_a_per_v.is_empty() || parabolic && even || misfit {
        return None;
    }
    if settled
        && even
        && let Some(ends) = parabola::ends(input.drive, current, electrical)
    {
        electrical.ends = ends;
        return None;
    }
    let readings = RunReadings {
        drive: input.drive,
        area_cm2: input.area_cm2,
        current: Some(Response::beside_fit(
            current.clone(),
            &electrical.residuals.residuals,
        )),
        curvature: bending.map(|(curvature, bending)| {
            Response::beside_fit(curvature.clone(), &bending.residuals.residuals)
        }),
    };
    joint::single::judge(
        &readings,
        electrical,
        bending.map(|(_, bending)| bending),
        branches,
        parabolic,
    )
}

/// Whether the model plainly does not describe the readings. A likelihood that knows noise only would then state
/// intervals far too narrow, about another place than the curve that is drawn; those of the two steps are
/// widened by what the model leaves.
fn misfits(sampled: &Sampled, square: f64) -> bool {
    let rms = (square / sampled.len().max(1) as f64).sqrt();
    sampled
        .scatter
        .as_ref()
        .is_some_and(|noise| rms > MISFIT_FACTOR * noise.standard_deviation)
}
