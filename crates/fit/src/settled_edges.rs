//! Edges found with the circuit, from the current: what two edges and more tell of each other.

use ieap_domain::quantiles::{CHI_SQUARE_95_OF_ONE, NORMAL_95};
use ieap_domain::{ChannelNoise, Drive, range_of};
use ieap_numerics::least_squares::Levenberg;
use ieap_numerics::sums;
use ieap_numerics::symmetric::Symmetric;

use crate::coupled::Current;
use crate::edges::{EdgeTimes, Shift};
use crate::electrical::Electrical;
use crate::error::FitError;
use crate::in_two_steps;
use crate::line::Line;
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
    if let [shift] = middle.edges.shifts() {
        let (low_s, high_s) = shift.limits_s();
        return Ok(of_one(input, options, &middle.edges, (low_s, high_s)).unwrap_or(middle));
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

/// Parts of its range at which one edge is tried first.
const TRIED: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];

/// One edge alone: of a current it is as good anywhere, for what it is off by the branches take up, but the bending begins with
/// it. None where neither tells more than the readings beside it.
fn of_one(
    input: &FitInput,
    options: &FitOptions,
    edges: &EdgeTimes,
    (low_s, high_s): (f64, f64),
) -> Option<Settled> {
    let left = |by_s: f64| -> Option<Vec<(f64, f64)>> {
        let drive = edges.shifted(&[by_s]);
        let fit = in_two_steps(
            &FitInput {
                drive: &drive,
                ..*input
            },
            options,
        )?;
        let of = |noise: &ChannelNoise| {
            let memory = noise.residual_autocorrelation.clamp(0.0, MOST_MEMORY);
            let variance = noise.residual_rms.powi(2);
            (
                variance * noise.readings as f64,
                variance * (1.0 + memory) / (1.0 - memory),
            )
        };
        Some(fit.noise.iter().map(of).collect())
    };
    let tried: Vec<f64> = TRIED
        .iter()
        .map(|part| 0.5 * ((1.0 + part) * high_s + (1.0 - part) * low_s))
        .collect();
    let found: Vec<Vec<(f64, f64)>> = tried.iter().map(|by_s| left(*by_s)).collect::<Option<_>>()?;
    // In variances of the noise where the model leaves least.
    let least = |k: usize| {
        found
            .iter()
            .filter_map(|own| Some(own.get(k)?.1))
            .fold(f64::INFINITY, f64::min)
    };
    let noise: Vec<f64> = (0..found[0].len()).map(least).collect();
    let square = |own: &[(f64, f64)]| {
        own.iter()
            .zip(&noise)
            .map(|(own, noise)| own.0 / noise)
            .sum::<f64>()
    };
    let squares: Vec<f64> = found.iter().map(|own| square(own)).collect();
    let (low, high) = range_of(squares.iter().copied());
    if high - low < CHI_SQUARE_95_OF_ONE {
        return None;
    }
    let at = |by_s: f64| left(by_s).map_or(f64::INFINITY, |own| square(&own));
    let line = Line::of(&tried, at, |_| CHI_SQUARE_95_OF_ONE)?;
    Some(Settled {
        edges: edges.moved(&[line.best]),
        open: vec![vec![(line.high - line.low) / (2.0 * NORMAL_95)]],
    })
}

/// Memory of what is left beyond which it is no noise. Chosen.
const MOST_MEMORY: f64 = 0.9;

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
    let best = (0..Shift::PLACES)
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
