//! Runs whose voltage moves all the time: how models are fitted to them, and what they leave open.
//!
//! They are fitted in two steps, with the errors that the covariance of the residuals gives and, where the sum of squares
//! bends, that its rise at the ends gives. What judges steps further (noise without the circuit, as sums of
//! exponentials between edges) does not know of them.

use ieap_model::LumpedModel;

use crate::options::{FitInput, FitOptions};
use crate::outliers::Cleaned;
use crate::parabola;
use crate::two_steps::{Identified, Readings, identify};

/// Counts what changes fits of moving voltages and of no others.
/// - 2: the bending is open where the capacitance is.
/// - 3: rival and extended models, and comparisons.
/// - 4: what is off in every period of a wave alike counts once.
pub const MOVING_VERSION: u32 = 4;

/// Follows the sum of squares where the covariance alone would mislead, and says where a branch may hide.
pub(crate) fn look_closer(input: &FitInput, options: &FitOptions, identified: &mut Identified) {
    let Ok((sampled, electrical)) = identified.current.as_mut() else {
        return;
    };
    let found = electrical.conductances_a_per_v.len();
    electrical.hides_branch = found > 0 && found < options.model.branches;
    if let Some(ends) = parabola::ends(input.drive, sampled, electrical) {
        electrical.ends = ends;
    } else {
        electrical.bends = electrical.in_doubt || !parabola::is_narrow(electrical);
    }
}

/// Where both steps end on a run of which the current shows a branch at least, whatever of it the readings determine: a place
/// from which a search of several runs begins, and no result. It has the branches that the current shows, the coupling 0 where
/// no bending follows.
pub fn least_squares_place(input: &FitInput, options: &FitOptions) -> Option<LumpedModel> {
    let cleaned = Cleaned::of(input);
    let input = &cleaned.input(input);
    let found = identify(input, options, Readings::new(input).ok()?, None);
    let (_, electrical) = found.current.ok()?;
    let bending = found.curvature.map_or((0.0, 0.0), |(_, bending)| {
        (bending.coupling_per_c_cm, bending.rate_per_s)
    });
    let place = electrical.model(bending.0, bending.1);
    (!place.branches.is_empty()).then_some(place)
}
