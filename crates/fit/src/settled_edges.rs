//! Edges found with the circuit, from the current: what two edges and more tell of each other.

use ieap_domain::Drive;
use ieap_numerics::least_squares::Levenberg;
use ieap_numerics::sums;
use ieap_numerics::symmetric::Symmetric;

use crate::coupled::Current;
use crate::edges::{EdgeTimes, Shift};
use crate::electrical::Electrical;
use crate::error::FitError;
use crate::options::{FitInput, FitOptions};
use crate::sampled::Sampled;
use crate::search::Limits;
use crate::two_steps::{Readings, identify};

/// Evaluations of a search for edges, and the part of the sum of squares at which it settles.
const LIMIT: u64 = 60;
const SETTLE: f64 = 1e-9;

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
    let placed = FitInput {
        drive: middle.edges.drive(),
        ..*input
    };
    let identified = identify(&placed, options, Readings::new(&placed)?);
    let found = identified
        .current
        .as_ref()
        .ok()
        .filter(|(_, electrical)| !electrical.conductances_a_per_v.is_empty())
        .and_then(|(sampled, electrical)| searched(&middle.edges, sampled, electrical));
    Ok(found.unwrap_or(middle))
}

fn searched(edges: &EdgeTimes, sampled: &Sampled, electrical: &Electrical) -> Option<Settled> {
    let limits = Limits::of(sampled)?;
    let short = sampled.compressed();
    let mut conductances = electrical.conductances_a_per_v.clone();
    conductances.push(electrical.steady_a_per_v);
    let logs: Vec<f64> = electrical.time_constants_s.iter().map(|tau| tau.ln()).collect();
    let variance = electrical
        .residuals
        .long_run_variance(sums::peak(&sampled.values));
    let (current, start) = Current::about(
        edges,
        &short,
        &conductances,
        &logs,
        (limits.low, limits.high),
        variance.sqrt(),
    );
    let circuit = start.len() - edges.shifts().len();
    let rounding = 4.0 * f64::EPSILON * sampled.square();
    let begun_at = |place: usize| {
        let mut start = start.clone();
        for (own, shift) in start[circuit..].iter_mut().zip(edges.shifts()) {
            *own = shift.begun_at_s()[place];
        }
        Levenberg::by_region(LIMIT, SETTLE, rounding).search(&current, &start)
    };
    // One edge alone is as good anywhere: what it is off by the branches take up.
    let places = if edges.shifts().len() > 1 {
        Shift::PLACES
    } else {
        1
    };
    let best = (0..places)
        .map(begun_at)
        .filter(|found| found.local.square.is_finite())
        .min_by(|a, b| a.local.square.total_cmp(&b.local.square))?;
    let known = best.local.normal;
    let information = Symmetric::from_fn(start.len(), |a, b| known.get(a, b) / variance);
    let covariance = information.floored_inverse(1e-13);
    let shifts: Vec<usize> = (circuit..start.len()).collect();
    let (sizes, vectors) = covariance.part(&shifts).eigen();
    let open = sizes.iter().enumerate().map(|(place, size)| {
        let sd = size.max(0.0).sqrt();
        vectors.iter().map(|of_shift| sd * of_shift[place]).collect()
    });
    Some(Settled {
        open: open.collect(),
        edges: edges.moved(&best.at[circuit..]),
    })
}
