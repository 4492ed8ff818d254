//! Identification of the distributed model from the current and from voltages and curvatures measured along the strip,
//! in the thesis's three phases or jointly.
//!
//! Phases: R_e is given or fitted; C, R_c and R_ss follow from the voltages along the strip and the current; mu and
//! lambda from the curvatures, with those fixed. Jointly all follow from all readings, each weighted by its noise, as
//! they must where curvatures are all there is.

mod along;
mod break_search;
mod common_error;
mod contact_break;
mod decision;
mod described;
mod electrical;
mod estimates;
mod given_error;
mod identified;
mod input;
mod jointly;
mod left_out;
mod mechanical;
mod outcome;
#[cfg(test)]
mod places_tests;
mod readings;
mod residual_noise;
mod response;
mod squares;
#[cfg(test)]
mod tests;
mod unevenness;

use ieap_domain::{Fit, Level};

use crate::error::FitError;
use crate::options::Steps;
pub use decision::{Bounded, CLAIMED, Decision, LumpedOrDistributed};
pub use given_error::given_resistance;
use identified::{Identified, RELATIVE_OHM_PER_SQ};
pub use input::{DistributedInput, Strip};
use readings::{Kind, Readings};
pub use unevenness::Unevenness;

/// Id of the model in the registry.
pub const MODEL_ID: &str = "distributed";

/// Readings that each phase needs at least.
const LEAST_READINGS: usize = 12;

/// Fits a run with the distributed model.
///
/// Joint fits take every reading at once. They are also made where curvatures are the only thing along the strip that
/// was measured, which has no phases.
///
/// # Errors
/// [`FitError`] where there is nothing along the strip to fit, the strip has no size, or the drive is not one of
/// held voltages.
pub fn fit_distributed(input: &DistributedInput, steps: Steps) -> Result<Fit, FitError> {
    let fit = fit_as_given(input, steps)?;
    let strip = input.strip;
    let (given, error) = (
        strip.electrode_resistance_ohm_per_sq,
        strip.electrode_resistance_error_ohm_per_sq,
    );
    let Some((given, error)) = given.zip(error.filter(|error| error.is_finite() && *error > 0.0)) else {
        return Ok(fit);
    };
    let with = |factor: f64| {
        let mut moved = *input;
        moved.strip.electrode_resistance_ohm_per_sq = Some(given * factor);
        fit_as_given(&moved, steps)
    };
    let factor = (error / given).exp();
    let (lower, higher) = (with(factor.recip())?, with(factor)?);
    Ok(given_error::widened(fit, given, error, [&lower, &higher]))
}

/// The fit with the resistance taken as exact where it is given.
fn fit_as_given(input: &DistributedInput, steps: Steps) -> Result<Fit, FitError> {
    let found = identify(input, steps)?;
    // Places tell of the electrodes through curvatures, too, which the phases do not ask for it.
    let mut joint = match (steps, &found.mechanical) {
        (Steps::TwoStep, Some(_)) => identify(input, Steps::Simultaneous)?,
        _ => found.clone(),
    };
    break_search::look(&mut joint);
    let decision = Decision::of(&joint);
    Ok(match joint.contact_break {
        Some(_) => outcome::fit(&joint, &decision),
        None => outcome::fit(&found, &decision),
    })
}

/// What a run says of lumped and distributed; none where nothing along the strip can be fitted.
pub fn decide(input: &DistributedInput) -> Option<Decision> {
    let found = identify(input, Steps::Simultaneous).ok()?;
    Some(Decision::of(&found))
}

fn identify<'a>(input: &DistributedInput<'a>, steps: Steps) -> Result<Identified<'a>, FitError> {
    check(input)?;
    let readings = Readings::new(input);
    let is_relative = input.strip.electrode_resistance_ohm_per_sq.is_none()
        && readings.count(Kind::Current) < LEAST_READINGS;
    let mut input = *input;
    if is_relative {
        input.strip.electrode_resistance_ohm_per_sq = Some(RELATIVE_OHM_PER_SQ);
    }
    let electrical = readings.count(Kind::Voltage) + readings.count(Kind::Current) >= LEAST_READINGS;
    let bends = readings.count(Kind::Curvature) >= LEAST_READINGS;
    let (electrical, mechanical, method) = match (electrical, bends) {
        (false, false) => {
            return Err(FitError::NothingAlong {
                found: readings.counts().into_iter().max().unwrap_or(0),
                needed: LEAST_READINGS,
            });
        }
        (true, _) => {
            let electrical = electrical::fit(&input, &readings);
            let mechanical = bends.then(|| mechanical::fit_mechanical(&input, &readings, &electrical));
            match (mechanical, steps) {
                (Some(mechanical), Steps::Simultaneous) => {
                    let (electrical, mechanical) =
                        jointly::refine(&input, &readings, &electrical, &mechanical);
                    (electrical, Some(mechanical), JOINTLY)
                }
                (mechanical, _) => (electrical, mechanical, PHASES),
            }
        }
        (false, true) => {
            let (electrical, mechanical) = jointly::from_curvatures(&input, &readings);
            (electrical, Some(mechanical), JOINTLY)
        }
    };
    Ok(Identified {
        input,
        readings,
        is_relative,
        electrical,
        mechanical,
        contact_break: None,
        method,
    })
}

const PHASES: &str = "three phases, closed form along the strip";
const JOINTLY: &str = "jointly, closed form along the strip";

fn check(input: &DistributedInput) -> Result<(), FitError> {
    let Strip {
        length_cm,
        width_cm,
        electrode_resistance_ohm_per_sq,
        ..
    } = input.strip;
    let positive = |x: f64| x.is_finite() && x > 0.0;
    if !positive(length_cm) || !positive(width_cm) {
        return Err(FitError::Area {
            found_cm2: length_cm * width_cm,
        });
    }
    if let Some(found) = electrode_resistance_ohm_per_sq.filter(|&r| !positive(r)) {
        return Err(FitError::ElectrodeResistance {
            found_ohm_per_sq: found,
        });
    }
    if input.drive.moves() {
        return Err(FitError::Moves { model: "distributed" });
    }
    if input.drive.segments.iter().any(|s| s.level == Level::OpenCircuit) {
        return Err(FitError::OpenCircuitAlong);
    }
    Ok(())
}
