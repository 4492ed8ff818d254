//! Edges found with all that a run tells: its circuit and its bending, beside where the edges may be.

use ieap_domain::Drive;

use crate::edges::EdgeTimes;
use crate::error::FitError;
use crate::group;
use crate::options::{FitInput, FitOptions};

/// Edges where the readings have them, with what is left open of them.
pub(crate) struct Settled {
    pub(crate) edges: EdgeTimes,
    /// Independent ways in which all edges may still be off together, one standard deviation each, s.
    pub(crate) open: Vec<Vec<f64>>,
}

impl Settled {
    /// Each edge in the middle of where it may be, with all of its range open.
    pub(crate) fn in_the_middle(drive: &Drive) -> Settled {
        let edges = EdgeTimes::of(drive);
        Settled {
            open: edges.open_ways(),
            edges,
        }
    }
}

/// The edges of a run. Where it has no current that tells of a circuit they stay in the middle of where they may be, each with
/// all of its range open.
///
/// # Errors
/// As [`crate::fit_run`].
pub(crate) fn settled(input: &FitInput, options: &FitOptions) -> Result<Settled, FitError> {
    let middle = Settled::in_the_middle(input.drive);
    if !middle.edges.is_open() {
        return Ok(middle);
    }
    Ok(group::settled(input, options, &middle.edges).unwrap_or(middle))
}
