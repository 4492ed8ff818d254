//! The two steps with what follows from them: a run fitted in the simplest way, and whether the likelihood of both responses
//! says it better.

use ieap_domain::Fit;
use ieap_model::rival_law;

use crate::joint::policy::MISFIT_FACTOR;
use crate::joint::readings::{Response, RunReadings};
use crate::joint::single::{self, Judged};
use crate::options::{FitInput, FitOptions};
use crate::sampled::Sampled;
use crate::two_steps::{Identified, OfStep, Readings, identify, needed};
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
