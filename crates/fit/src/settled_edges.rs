//! Edges found with all that a run tells: its circuit and its bending, beside where the edges may be.

use ieap_domain::Channel;

use crate::edges::Settled;
use crate::error::FitError;
use crate::group;
use crate::options::{FitInput, FitOptions};

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
    // A bending on a clock of its own has no part in where the edges are.
    let others: Vec<Channel> = input
        .channels
        .iter()
        .filter(|channel| !channel.own_clock)
        .cloned()
        .collect();
    let on_one_clock = FitInput {
        channels: &others,
        ..*input
    };
    Ok(group::settled(&on_one_clock, options, &middle.edges).unwrap_or(middle))
}
