//! Identification of a run with a model, in two steps as in the thesis: the electrical parameters from the
//! current; then, with those fixed, coupling and relaxation rate from the curvature.
//!
//! A fit is a pure function of its input and options, the seed of a random method among them: the same readings
//! give the same bytes.

mod bending;
mod bending_alone;
mod circuit;
mod coupled;
mod described;
pub mod distributed;
mod edges;
mod electrical;
mod error;
mod estimates;
mod factors;
mod given;
mod group;
pub mod impedance;
mod instrument_noise;
mod interval_rule;
mod joint;
mod joint_estimates;
mod kind_of_noise;
mod law;
mod means;
mod moving;
mod noise_again;
mod nuisances;
mod open_zero;
mod options;
mod outcome;
mod outliers;
mod own_clock;
mod parabola;
mod plain;
mod policy;
mod propagated_error;
mod sampled;
mod search;
mod settled_edges;
mod shown;
mod strain;
mod two_steps;
mod uncertainty;
mod unseen_charge;
mod whitened;
mod widened;
mod zero;

use ieap_domain::{Drive, Fit, Issue, KnownParameter};
use ieap_model::rival_law;

pub use described::{Described, Left, Noise, describe};
pub use edges::{EdgeTimes, Shift};
pub use error::FitError;
pub use given::{BaseKnowledge, Predict, fit_of_run};
pub use group::known::can_be_known;
pub use group::reductions::{Circuit, Reduction, Reductions, reductions};
pub use group::step_and_spectrum::{StepAndSpectrum, step_and_spectrum};
pub use group::{
    Bootstrap, GroupFit, GroupOptions, Intervals, Resampled, Sharing, can_join_group, shareable,
};

pub use instrument_noise::InstrumentNoise;
pub use kind_of_noise::{KindEvidence, NoiseForm, NoiseKind, ToldOfNoise};
pub use moving::{MOVING_VERSION, least_squares_place};
pub use noise_again::{FoundAgain, NoiseAgain, Pair, Scaled};
pub use options::{FitInput, FitOptions, NoiseBy, Steps};
pub use outliers::{
    Cleaned, FEWEST_FOR_SPREAD, READINGS_AFTER_EDGE, READINGS_BEFORE_EDGE, READINGS_OF_SURROUNDINGS,
    left_out_in_words, without_outliers,
};
pub use own_clock::{Aligned, aligned};
pub use policy::MOST_RUNS_OF_INSTRUMENT;
pub use whitened::WhitenedChannel;

use plain::{bent_alone, in_two_steps, judge};
use two_steps::{OfStep, Readings, identify};

#[cfg(test)]
mod any_input;
#[cfg(test)]
mod tests;

/// Fits a run. Edges of the drive that only readings tell of are sought between these; what is left open of them widens the
/// intervals. Single readings far off their neighbours are left out, as of every fit ([`without_outliers`]).
///
/// What the data leave open is reported in the fit: an estimate without a value, or with a bound, says why.
///
/// ```
/// use ieap_domain::{Channel, Drive, Quantity};
/// use ieap_fit::{FitInput, FitOptions, fit_run};
///
/// // 1 V from 0 s on, on 30 Ohm cm2 in series with 0.1 F/cm2; 0.1 cm2 of it, and a converter of 0.1 uA.
/// let time_s: Vec<f64> = (-5..60).map(f64::from).collect();
/// let charging = |t: &f64| if *t < 0.0 { 0.0 } else { 0.1 / 30.0 * (-t / 3.0).exp() + 1e-5 };
/// let current_a: Vec<f64> = time_s.iter().map(|t| (charging(t) * 1e7).round() / 1e7).collect();
/// let channels = [Channel::new(Quantity::Current, time_s.into(), current_a.into())];
/// let input = FitInput {
///     channels: &channels,
///     drive: &Drive::step(1.0),
///     area_cm2: 0.1,
/// };
/// let fit = fit_run(&input, &FitOptions::for_model("lumped-1")?)?;
/// let r1 = fit.parameter("r1_ohm_cm2").ok_or("lumped-1 has it")?;
/// assert!(r1.value.is_some_and(|value| (value - 30.0).abs() < 0.5), "{r1:?}");
/// // Nothing bends here: what only bending tells has no value, and a reason.
/// let lambda = fit.parameter("lambda_per_s").ok_or("lumped-1 has it")?;
/// assert!(lambda.value.is_none() && lambda.reason.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FitError`] where there is nothing to fit: no response channel, too few readings after the step, an area
/// or a drive that is none.
pub fn fit_run(input: &FitInput, options: &FitOptions) -> Result<Fit, FitError> {
    let cleaned = Cleaned::of(input);
    let mut fit = fit_cleaned(&cleaned.input(input), options)?;
    fit.issues.extend(cleaned.issues_of_whole());
    Ok(fit)
}

fn fit_cleaned(input: &FitInput, options: &FitOptions) -> Result<Fit, FitError> {
    let readings = Readings::new(input)?;
    readings.check(input, options)?;
    let aligned = match aligned(input, options) {
        Ok(Some(aligned)) => aligned,
        Ok(None) => return fit_on_one_clock(input, options),
        Err(open) => {
            let mut fit = fit_on_one_clock(input, options)?;
            fit.issues.push(open);
            return Ok(fit);
        }
    };
    let mut fit = fit_on_one_clock(
        &FitInput {
            channels: &aligned.channels,
            ..*input
        },
        options,
    )?;
    own_clock::widen(&mut fit, input, &aligned, |input| {
        in_two_steps(input, options, None)
    });
    Ok(fit)
}

/// What a run tells of the noise of its instrument, by the model and the method of `options`: nothing where a fit of it would not be
/// weighed by [kinds of noise](NoiseBy::Kinds). It does not depend on what is known of the instrument.
///
/// # Errors
/// Those of a fit of the run.
pub fn told_of_noise(input: &FitInput, options: &FitOptions) -> Result<ToldOfNoise, FitError> {
    if !options.is_weighed_by_kinds() || input.drive.moves() {
        return Ok(ToldOfNoise::default());
    }
    let cleaned = Cleaned::of(input);
    let input = cleaned.input(input);
    Readings::new(&input)?.check(&input, options)?;
    // Where clocks cannot be brought together the fit takes them as they are, and says so.
    let aligned = aligned(&input, options).unwrap_or_default();
    let input = FitInput {
        channels: aligned.as_ref().map_or(input.channels, |own| &own.channels),
        ..input
    };
    let (settled, step) = settled_edges::settled(&input, options)?;
    let placed = FitInput {
        drive: settled.edges.drive(),
        ..input
    };
    let mut identified = identify(&placed, options, Readings::new(&placed)?, step.as_ref());
    unseen_charge::look(&placed, options, &mut identified);
    Ok(plain::told_of_noise(&placed, &identified).unwrap_or_default())
}

/// Fits a run whose channels are on one clock.
fn fit_on_one_clock(input: &FitInput, options: &FitOptions) -> Result<Fit, FitError> {
    let mut fit = fit_on_one_zero(input, options)?;
    let here = widened::values(&fit.parameters);
    open_zero::widen(&mut fit, input, here, |moved| {
        Some(fit_on_one_zero(moved, options).ok()?.parameters)
    });
    Ok(fit)
}

/// The same where the zero of a sensor is.
fn fit_on_one_zero(input: &FitInput, options: &FitOptions) -> Result<Fit, FitError> {
    let (settled, step) = settled_edges::settled(input, options)?;
    let placed = FitInput {
        drive: settled.edges.drive(),
        ..*input
    };
    let (mut fit, is_plain) = fit_placed(&placed, options, step.as_ref())?;
    fit.nuisances.extend(nuisances::edges(&settled, input.drive));
    if !settled.open.is_empty() {
        let here = is_plain.then(|| widened::values(&fit.parameters));
        widened::widen(&mut fit, &settled, here, |drive| {
            Some(in_two_steps(&FitInput { drive, ..*input }, options, step.as_ref())?.parameters)
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
    let cleaned = Cleaned::of(input);
    let input = &cleaned.input(input);
    let (settled, _) = settled_edges::settled(input, options)?;
    let with = |drive: &Drive| group::known::fit(&FitInput { drive, ..*input }, options.model, known);
    let mut fit = with(settled.edges.drive())?;
    fit.nuisances.extend(nuisances::edges(&settled, input.drive));
    if !settled.open.is_empty() {
        widened::widen(&mut fit, &settled, None, |drive| {
            Some(with(drive).ok()?.parameters)
        });
    }
    fit.issues.extend(cleaned.issues_of_whole());
    Ok(fit)
}

/// Fits all runs at once, current and curvature weighted by their noise. Edges that only readings tell of are sought between
/// these with all that the runs share, and clocks of bending beside that of the voltage; what is left open of both widens the
/// intervals.
///
/// # Errors
/// [`FitError`] where there is no run, a key cannot be shared, or a run gives nothing to start from.
pub fn fit_group(inputs: &[FitInput], options: &GroupOptions) -> Result<GroupFit, FitError> {
    let own = FitOptions {
        model: options.model,
        ..FitOptions::default()
    };
    let cleaned: Vec<Cleaned> = inputs.iter().map(Cleaned::of).collect();
    let each = inputs.iter().zip(&cleaned);
    let inputs: Vec<FitInput> = each.map(|(input, cleaned)| cleaned.input(input)).collect();
    let aligned: Vec<Result<Option<Aligned>, Issue>> =
        inputs.iter().map(|input| aligned(input, &own)).collect();
    let on_one_clock = inputs.iter().zip(&aligned).map(|(input, aligned)| FitInput {
        channels: match aligned {
            Ok(Some(aligned)) => &aligned.channels,
            _ => input.channels,
        },
        ..*input
    });
    let mut group = group::fit_on_one_clock(&on_one_clock.collect::<Vec<_>>(), options)?;
    for ((fit, input), aligned) in group.runs.iter_mut().zip(&inputs).zip(&aligned) {
        match aligned {
            Ok(Some(aligned)) => {
                own_clock::widen(fit, input, aligned, |input| in_two_steps(input, &own, None))
            }
            Ok(None) => {}
            Err(open) => fit.issues.push(open.clone()),
        }
        let of_input = |input: &FitInput| Some(in_two_steps(input, &own, None)?.parameters);
        let here = of_input(input).map_or_else(Default::default, |found| widened::values(&found));
        open_zero::widen(fit, input, here, of_input);
    }
    for (fit, cleaned) in group.runs.iter_mut().zip(&cleaned) {
        fit.issues.extend(cleaned.issues_of_whole());
    }
    Ok(group)
}

/// The drive of a run with its edges where [`fit_run`] takes them to be: those that only readings tell of are sought between
/// these.
///
/// # Errors
/// As [`fit_run`].
pub fn placed_drive(input: &FitInput, options: &FitOptions) -> Result<Drive, FitError> {
    let cleaned = Cleaned::of(input);
    let (settled, _) = settled_edges::settled(&cleaned.input(input), options)?;
    Ok(settled.edges.drive().clone())
}

/// Fits a run whose edges are where its drive has them; its circuit may be known for another place of the `step`. Beside
/// the fit whether its estimates are those of [`in_two_steps`].
fn fit_placed(
    input: &FitInput,
    options: &FitOptions,
    step: Option<&OfStep>,
) -> Result<(Fit, bool), FitError> {
    let readings = Readings::new(input)?;
    if let Some(law) = rival_law(options.model.id) {
        return Ok((law::fit(input, options, law, readings), true));
    }
    let mut identified = identify(input, options, readings, step);
    if input.drive.moves() {
        moving::look_closer(input, options, &mut identified);
        return Ok((outcome::fit(input, options, &identified, None), false));
    }
    if options.steps == Steps::Simultaneous && identified.current.is_ok() {
        let group = group::fit_placed(&[*input], &GroupOptions::sharing_all(options.model))?;
        if let Some(fit) = group.runs.into_iter().next() {
            return Ok((fit, false));
        }
    }
    if let Some(fit) = bent_alone(input, options, &identified) {
        return Ok((fit, true));
    }
    unseen_charge::look(input, options, &mut identified);
    let judged = judge(input, options, &mut identified);
    let fit = outcome::fit(input, options, &identified, judged.as_ref());
    let current = identified.current.as_ref().ok();
    let is_plain = judged.is_none() && current.is_none_or(|(_, circuit)| circuit.ends.is_empty());
    Ok((fit, is_plain))
}
