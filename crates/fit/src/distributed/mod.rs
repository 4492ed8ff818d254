//! Identification of the distributed model from the current and from voltages and curvatures measured along the strip,
//! in the thesis's three phases or jointly.
//!
//! Phases: R_e is given as exact, given as one more reading with its error, or fitted; C, R_c and R_ss follow from the voltages along the strip and the current; mu and
//! lambda from the curvatures, with those fixed. Jointly all follow from all readings, each weighted by its noise, as
//! they must where curvatures are all there is.

mod along;
mod break_search;
mod common_error;
mod contact_break;
mod contradiction;
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
mod policy;
mod readings;
mod residual_noise;
mod response;
mod squares;
#[cfg(test)]
mod tests;
mod unevenness;

use ieap_domain::{Channel, Fit, Level};

use crate::edges::EdgeTimes;
use crate::edges::Settled;
use crate::error::FitError;
use crate::options::Steps;
use crate::outliers::{Cleaned, without_outliers};
use crate::widened;
pub use decision::{Bounded, Decision, LumpedOrDistributed};
pub use given_error::given_resistance;
use identified::{Identified, RELATIVE_OHM_PER_SQ};
pub use input::{DistributedInput, Strip};
use policy::FEWEST_READINGS;
pub use policy::UNEVEN_BELOW;
use readings::{Kind, Readings};
pub use unevenness::Unevenness;

/// Id of the model in the registry.
pub const MODEL_ID: &str = "distributed";

/// Fits a run with the distributed model.
///
/// Joint fits take every reading at once. They are also made where curvatures are the only thing along the strip that
/// was measured, which has no phases. Edges of the drive that only readings tell of are taken in the middle of where they may
/// be, and what is left open of them widens the intervals.
///
/// # Errors
/// [`FitError`] where there is nothing along the strip to fit, the strip has no size, or the drive is not one of
/// held voltages.
pub fn fit_distributed(input: &DistributedInput, steps: Steps) -> Result<Fit, FitError> {
    let cleaned = without_outliers(input.channels, input.drive);
    let channels = left_out_together(&cleaned);
    let input = &DistributedInput {
        channels: &channels,
        ..*input
    };
    let settled = Settled::in_the_middle(input.drive);
    let placed = DistributedInput {
        drive: settled.edges.drive(),
        ..*input
    };
    let mut fit = fit_placed(&placed, steps)?;
    if !settled.open.is_empty() {
        widened::widen(&mut fit, &settled, None, |drive| {
            let moved = DistributedInput { drive, ..*input };
            Some(estimates::parameters(&identify(&moved, steps).ok()?))
        });
    }
    fit.issues
        .extend(cleaned.issues(|channel| readings::kind_of(channel, input.strip.length_cm).is_some()));
    Ok(fit)
}

/// The channels, those that were sampled together without any reading at a time at which one of them is off: places err
/// alike, and are compared at the same times.
fn left_out_together(cleaned: &Cleaned) -> Vec<Channel> {
    let along = |channel: &&Channel| channel.position_mm.is_some();
    let with_others = |channel: &Channel| {
        let is_together = |other: &&Channel| {
            other.quantity == channel.quantity && other.time_s == channel.time_s && along(&channel)
        };
        let others = cleaned.channels.iter().filter(along).filter(is_together);
        let mut excluded: Vec<u32> = others.flat_map(|other| other.excluded.iter().copied()).collect();
        excluded.extend(channel.excluded.iter());
        excluded.sort_unstable();
        excluded.dedup();
        Channel {
            excluded: excluded.into(),
            ..channel.clone()
        }
    };
    if cleaned.left_out_s.iter().all(Vec::is_empty) {
        return cleaned.channels.clone();
    }
    cleaned.channels.iter().map(with_others).collect()
}

/// Fits a run whose edges are where its drive has them.
///
/// A break is looked for beside an R_e that the readings themselves determine, where they can: what a probe read wrong is
/// none. Where they show one, theirs are the parameters, for the probe read one side of it or both.
fn fit_placed(input: &DistributedInput, steps: Steps) -> Result<Fit, FitError> {
    let found = identify(input, steps)?;
    // Places tell of the electrodes through curvatures, too, which the phases do not ask for it.
    let joint = match (steps, &found.mechanical) {
        (Steps::TwoStep, Some(_)) => identify(input, Steps::Simultaneous)?,
        _ => found.clone(),
    };
    let alone = by_readings_alone(input)?;
    let mut broken = alone.clone().unwrap_or_else(|| joint.clone());
    break_search::look(&mut broken);
    let is_broken = broken.contact_break.is_some();
    let mut fit = if is_broken {
        outcome::fit(&broken, &Decision::of(&broken))
    } else {
        outcome::fit(&found, &Decision::of(&joint))
    };
    let told = alone.map(|alone| if is_broken { broken } else { alone });
    fit.issues.extend(contradiction::issue(input, told.as_ref()));
    Ok(fit)
}

/// The strip with an R_e that follows from the readings, where one is given that a current would tell as well.
fn by_readings_alone<'a>(input: &DistributedInput<'a>) -> Result<Option<Identified<'a>>, FitError> {
    let given = input.strip.electrode_resistance_ohm_per_sq.is_some();
    let tells = given && Readings::new(input).count(Kind::Current) >= FEWEST_READINGS;
    let unprobed = DistributedInput {
        strip: input.strip.unprobed(),
        ..*input
    };
    tells
        .then(|| identify(&unprobed, Steps::Simultaneous))
        .transpose()
}

/// What a run says of lumped and distributed; none where nothing along the strip can be fitted.
pub fn decide(input: &DistributedInput) -> Option<Decision> {
    let channels = left_out_together(&without_outliers(input.channels, input.drive));
    let input = &DistributedInput {
        channels: &channels,
        ..*input
    };
    let edges = EdgeTimes::of(input.drive);
    let placed = DistributedInput {
        drive: edges.drive(),
        ..*input
    };
    let found = identify(&placed, Steps::Simultaneous).ok()?;
    Some(Decision::of(&found))
}

fn identify<'a>(input: &DistributedInput<'a>, steps: Steps) -> Result<Identified<'a>, FitError> {
    check(input)?;
    let readings = Readings::new(input);
    let is_relative = input.strip.electrode_resistance_ohm_per_sq.is_none()
        && readings.count(Kind::Current) < FEWEST_READINGS;
    let mut input = *input;
    if is_relative {
        input.strip.electrode_resistance_ohm_per_sq = Some(RELATIVE_OHM_PER_SQ);
    }
    let electrical = readings.count(Kind::Voltage) + readings.count(Kind::Current) >= FEWEST_READINGS;
    let bends = readings.count(Kind::Curvature) >= FEWEST_READINGS;
    let (electrical, mechanical, method) = match (electrical, bends) {
        (false, false) => {
            return Err(FitError::NothingAlong {
                found: readings.counts().into_iter().max().unwrap_or(0),
                needed: FEWEST_READINGS,
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
