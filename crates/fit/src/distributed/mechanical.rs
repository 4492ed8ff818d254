//! Phase 3: mu and lambda from the curvatures, with the electrical parameters fixed and their uncertainty carried along.

use ieap_domain::quantiles::CHI_SQUARE_95;
use ieap_numerics::line::halved;
use ieap_numerics::symmetric::Symmetric;

use super::described::{Described, model_of};
use super::input::DistributedInput;
use super::readings::{Kind, Readings};
use super::squares::{Fitted, StripProblem, product};

/// Rates of relaxation tried before the search.
const RATES: usize = 24;

/// What the curvatures say.
#[derive(Debug, Clone)]
pub(super) struct Mechanical {
    /// mu, 1/C.
    pub mu_per_c: f64,
    /// The minimum in (mu / scale, ln lambda).
    pub fitted: Fitted,
    /// Scale of the first parameter, 1/C.
    pub scale: f64,
    /// Upper bound of lambda, 1/s, where it cannot be told from zero.
    pub rate_below_per_s: Option<f64>,
}

impl Mechanical {
    /// From a minimum in (mu / scale, ln lambda).
    pub fn of(
        input: &DistributedInput,
        readings: &Readings,
        electrical: &[f64],
        fitted: Fitted,
        scale: f64,
    ) -> Mechanical {
        Mechanical {
            mu_per_c: fitted.at[0] * scale,
            rate_below_per_s: bound_of_rate(input, readings, electrical, &fitted),
            fitted,
            scale,
        }
    }
}

/// Curvatures against mu in units of `scale` and the logarithm of lambda.
fn problem<'a>(
    input: &'a DistributedInput<'a>,
    readings: &'a Readings,
    electrical: &'a [f64],
    scale: f64,
) -> StripProblem<'a> {
    StripProblem::new(input, readings, &[Kind::Curvature], 2, move |at| Described {
        model: model_of(&input.strip, electrical, at[1].exp()),
        mu_per_c: at[0] * scale,
        contact_break: None,
    })
}

/// Phase 3.
pub(super) fn fit_mechanical(
    input: &DistributedInput,
    readings: &Readings,
    electrical: &Fitted,
) -> Mechanical {
    let (mu, rate) = start(input, readings, &electrical.at);
    let scale = if mu == 0.0 { 1.0 } else { mu };
    let scaled = problem(input, readings, &electrical.at, scale);
    let mut fitted = scaled.search(&[1.0, rate]);
    fitted.covariance = with_carried(&fitted, &scaled, input, readings, electrical, scale);
    Mechanical::of(input, readings, &electrical.at, fitted, scale)
}

/// Logarithms of the slowest and fastest rate that the record can show.
pub(super) fn rates(readings: &Readings) -> (f64, f64) {
    let duration_s = readings.duration_s();
    let shortest_s = readings
        .of(Kind::Curvature)
        .flat_map(|group| group.time_s.windows(2).map(|pair| pair[1] - pair[0]))
        .fold(duration_s, f64::min);
    (
        (1e-4 / duration_s).ln(),
        (3.0 / shortest_s.max(1e-9 * duration_s)).ln(),
    )
}

/// The best mu and logarithm of lambda of a grid.
fn start(input: &DistributedInput, readings: &Readings, electrical: &[f64]) -> (f64, f64) {
    let problem = problem(input, readings, electrical, 1.0);
    let (low, high) = rates(readings);
    let tried = (0..RATES).map(|k| {
        let rate = low + (high - low) * k as f64 / (RATES - 1) as f64;
        let (mu, square) = problem.best_scale(&[1.0, rate]);
        (square, mu, rate)
    });
    let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or((0.0, low), |(_, mu, rate)| (mu, rate))
}

/// The covariance with what the uncertainty of the electrical parameters does to the mechanical ones: with J the slopes
/// by the mechanical and E those by the electrical parameters, the mechanical ones move by -(J'J)^-1 J'E.
fn with_carried(
    fitted: &Fitted,
    problem: &StripProblem,
    input: &DistributedInput,
    readings: &Readings,
    electrical: &Fitted,
    scale: f64,
) -> Symmetric {
    let (mine, theirs) = (problem.parameters(), electrical.at.len());
    let own = problem.slopes(&fitted.at);
    let by_theirs = StripProblem::new(input, readings, &[Kind::Curvature], theirs, |at| Described {
        model: model_of(&input.strip, at, fitted.at[1].exp()),
        mu_per_c: fitted.at[0] * scale,
        contact_break: None,
    })
    .slopes(&electrical.at);
    let inverse = problem.inverse_normal(&own);
    let cross = |row: usize, column: usize| product(&own[row], &by_theirs[column]);
    let moves: Vec<Vec<f64>> = (0..mine)
        .map(|row| {
            (0..theirs)
                .map(|k| -(0..mine).map(|j| inverse.get(row, j) * cross(j, k)).sum::<f64>())
                .collect()
        })
        .collect();
    let carried = |row: usize, column: usize| electrical.covariance.form(&moves[row], &moves[column]);
    Symmetric::from_fn(mine, |row, column| {
        fitted.covariance.get(row, column) + carried(row, column)
    })
}

/// Largest rate whose sum of squares is within 95 % of that without relaxation, where the record does not tell
/// the rate from zero.
fn bound_of_rate(
    input: &DistributedInput,
    readings: &Readings,
    electrical: &[f64],
    fitted: &Fitted,
) -> Option<f64> {
    let (low, _) = rates(readings);
    let problem = problem(input, readings, electrical, 1.0);
    let least = problem.best_scale(&[1.0, fitted.at[1]]).1;
    let limit = least + CHI_SQUARE_95[0] * fitted.inflation[1];
    if problem.best_scale(&[1.0, low]).1 > limit {
        return None;
    }
    let is_within = |rate: f64| problem.best_scale(&[1.0, rate]).1 <= limit;
    let (_, outside) = halved(low, fitted.at[1].max(low) + 12.0, 40, is_within);
    Some(outside.exp())
}
