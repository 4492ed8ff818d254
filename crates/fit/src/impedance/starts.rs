//! Where searches of a circuit begin: the best of many places that are drawn over what the spectrum shows.

use ieap_model::impedance::Scale;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::policy::{DRAWN, DRAWN_BEYOND, LEAST_DRAWN_EXPONENT, SEED, STARTS};
use super::search::Simulated;

/// The places with the lowest sums of squares, the lowest first. The same spectrum and circuit give the same ones.
pub(super) fn starts(problem: &Simulated<'_>) -> Vec<Vec<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let parameters = &problem.circuit.parameters;
    let limits: Vec<(f64, f64)> = parameters
        .iter()
        .map(|parameter| match parameter.scale {
            Scale::Exponent => (LEAST_DRAWN_EXPONENT, 1.0),
            scale => problem.range(scale, DRAWN_BEYOND),
        })
        .collect();
    let mut all: Vec<(f64, Vec<f64>)> = (0..DRAWN * parameters.len())
        .map(|_| {
            let drawn = limits.iter().map(|(low, high)| random.random_range(*low..*high));
            let at = levelled(problem, drawn.collect());
            (problem.square(&at), at)
        })
        .filter(|(square, _)| square.is_finite())
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().take(STARTS).map(|(_, at)| at).collect()
}

/// The place with all resistances made larger, and all that stores smaller, by what brings |Z| to that of the spectrum
/// in the mean of its logarithm: one dimension less to search.
fn levelled(problem: &Simulated<'_>, mut at: Vec<f64>) -> Vec<f64> {
    let shift = problem.mean_log_ratio(&at);
    if !shift.is_finite() {
        return at;
    }
    for (k, parameter) in problem.circuit.parameters.iter().enumerate() {
        at[k] += match parameter.scale {
            Scale::Resistance | Scale::Inductance => shift,
            Scale::Storage => -shift,
            Scale::Time | Scale::Exponent => 0.0,
        };
        at[k] = problem.bounds.nearest(k, at[k]);
    }
    at
}
