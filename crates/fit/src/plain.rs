//! The two steps with what follows from them: a run fitted in the simplest way, and whether the likelihood of both responses
//! says it better.

use ieap_domain::Fit;
use ieap_model::rival_law;

use crate::bending::Bending;
use crate::electrical::Electrical;
use crate::instrument_noise::InstrumentNoise;
use crate::joint::policy::MISFIT_FACTOR;
use crate::joint::readings::{Response, RunReadings};
use crate::joint::single::{self, Judged};
use crate::joint::start::Start;
use crate::kind_of_noise::ToldOfNoise;
use crate::options::{FitInput, FitOptions, NoiseBy};
use crate::sampled::Sampled;
use crate::two_steps::{Identified, OfStep, Readings, identify, needed};
use crate::uncertainty::Residuals;
use crate::{bending_alone, law, outcome, parabola, unseen_charge};

/// A run in two steps, of its bending alone, or by the law of a rival, for its estimates and no further; none where there is
/// nothing to fit. The circuit may be known for another place of the `step`.
pub(crate) fn in_two_steps(input: &FitInput, options: &FitOptions, step: Option<&OfStep>) -> Option<Fit> {
    let readings = Readings::new(input).ok()?;
    if let Some(law) = rival_law(options.model.id) {
        return Some(law::fit(input, options, law, readings));
    }
    let mut identified = identify(input, options, readings, step);
    unseen_charge::look(input, options, &mut identified);
    let alone = bent_alone(input, options, &identified);
    Some(alone.unwrap_or_else(|| outcome::for_its_estimates(input, options, &identified)))
}

/// The fit of the curvature where the current tells of no circuit; none where there are too few readings of it.
pub(crate) fn bent_alone(input: &FitInput, options: &FitOptions, identified: &Identified) -> Option<Fit> {
    let why = identified.current.as_ref().err()?;
    let curvature = identified.unfitted_curvature.as_ref()?;
    let enough = curvature.after_step() >= needed(options.model);
    enough.then(|| bending_alone::fit(input, options, curvature.clone(), why))?
}

/// Fits both responses at once, with intervals by profile likelihood, where the covariance of the two steps would
/// mislead; estimates, curves and residuals are then those of that fit.
pub(crate) fn judge(input: &FitInput, options: &FitOptions, identified: &mut Identified) -> Option<Judged> {
    let (current, electrical) = identified.current.as_mut().ok()?;
    if electrical.unseen.is_some() {
        // Estimated by itself, beside what the likelihood of the readings tells.
        return None;
    }
    let bending = identified.curvature.as_ref().ok();
    let branches = options.model.branches;
    if let NoiseBy::Kinds(known) = options.noise
        && options.is_weighed_by_kinds()
        && !electrical.conductances_a_per_v.is_empty()
    {
        return by_kinds(input, branches, (current, electrical), bending, known);
    }
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
    single::judge(
        &readings,
        electrical,
        bending.map(|(_, bending)| bending),
        branches,
        parabolic,
    )
}

/// The same, weighted by noise of every kind that the readings allow.
fn by_kinds(
    input: &FitInput,
    branches: usize,
    (current, electrical): (&Sampled, &Electrical),
    bending: Option<&(Sampled, Bending)>,
    known: Option<&InstrumentNoise>,
) -> Option<Judged> {
    let (readings, start) = weighed_by_kinds(input, (current, electrical), bending, known)?;
    let bending = bending.map(|(_, bending)| bending);
    let settled = parabola::is_settled(electrical, bending, branches);
    let narrow = settled.then(|| single::narrow(&readings, &start)).flatten();
    narrow.or_else(|| single::judge(&readings, electrical, bending, branches, false))
}

/// The readings beside what two steps have found, and where these put the search. What they tell of each kind of noise does not
/// depend on what is `known` of it.
fn weighed_by_kinds<'a>(
    input: &FitInput<'a>,
    (current, electrical): (&Sampled, &Electrical),
    bending: Option<&(Sampled, Bending)>,
    known: Option<&InstrumentNoise>,
) -> Option<(RunReadings<'a>, Start)> {
    let mut start = Start::of(electrical, electrical.conductances_a_per_v.len());
    if let Some((_, bending)) = bending {
        start = start.with_bending(bending);
    }
    let nothing = InstrumentNoise::default();
    let known = known.unwrap_or(&nothing);
    let response = |sampled: &Sampled, residuals: &Residuals, bends: bool| {
        let left = &residuals.residuals;
        let columns = |time_s: &[f64]| start.columns(input.drive, input.area_cm2, bends, time_s);
        Response::by_kinds(sampled.clone(), left, columns, known.channel(bends))
    };
    let readings = RunReadings {
        drive: input.drive,
        area_cm2: input.area_cm2,
        current: Some(response(current, &electrical.residuals, false)?),
        curvature: match bending {
            Some((curvature, bending)) => Some(response(curvature, &bending.residuals, true)?),
            None => None,
        },
    };
    Some((readings, start))
}

/// What a run in two steps tells of its instrument's noise; none where it is not weighed by that.
pub(crate) fn told_of_noise(input: &FitInput, identified: &Identified) -> Option<ToldOfNoise> {
    let (current, electrical) = identified.current.as_ref().ok()?;
    if electrical.unseen.is_some() || electrical.conductances_a_per_v.is_empty() {
        return None;
    }
    let bending = identified.curvature.as_ref().ok();
    let (readings, _) = weighed_by_kinds(input, (current, electrical), bending, None)?;
    Some(readings.told_of_noise())
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
