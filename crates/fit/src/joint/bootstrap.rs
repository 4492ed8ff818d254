//! A third opinion on uncertainty: fits of readings whose residuals were drawn again in blocks.

use ieap_numerics::sums::standard_deviation;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::feature::Feature;
use super::problem::JointProblem;
use super::readings::{Response, RunReadings};
use crate::joint::policy::FEWEST_REFITS;

/// Draws residuals anew in circular blocks of length `block` and adds them to the fitted values, every
/// response of every run on its own; refits `replicates` times from the minimum.
///
/// The outcome depends on `seed` only. It gives for every replicate the values of `features` of `run`, those
/// replicates left out whose search found no finite minimum.
pub(crate) fn replicate(
    problem: &JointProblem,
    at: &[f64],
    features: &[(usize, Feature)],
    seed: u64,
    replicates: usize,
) -> Vec<Vec<f64>> {
    let fitted: Vec<[Option<Vec<f64>>; 2]> = (0..problem.runs.len())
        .map(|run| {
            let local = problem.of_run(run, at);
            problem.runs[run].fitted(&problem.model(&local), problem.offsets(&local))
        })
        .collect();
    let one = |replicate: usize| {
        // One generator per replicate: the outcome is the same in whatever order they are made.
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(replicate as u64);
        let mut again = problem.clone();
        for (run, fitted) in again.runs.iter_mut().zip(&fitted) {
            redraw(run, fitted, &mut rng);
        }
        let found = again.search(at, 60, 1e-3);
        let of =
            |&(run, feature): &(usize, Feature)| feature.of(problem.layout, &problem.of_run(run, &found.at));
        let values: Vec<f64> = features.iter().map(of).collect();
        (found.local.square.is_finite() && values.iter().all(|v| v.is_finite())).then_some(values)
    };
    let refits: Vec<Option<Vec<f64>>> = (0..replicates).into_par_iter().map(one).collect();
    refits.into_iter().flatten().collect()
}

fn redraw(run: &mut RunReadings, fitted: &[Option<Vec<f64>>; 2], rng: &mut ChaCha8Rng) {
    let responses = [&mut run.current, &mut run.curvature];
    for (response, fitted) in responses.into_iter().zip(fitted) {
        if let (Some(response), Some(fitted)) = (response, fitted) {
            *response = redrawn(response, fitted, rng);
        }
    }
}

fn redrawn(response: &Response, fitted: &[f64], rng: &mut ChaCha8Rng) -> Response {
    let sd = &response.noise.sd;
    let unit: Vec<f64> = (response.sampled.values.iter().zip(fitted).zip(sd))
        .map(|((y, f), sd)| (y - f) / sd)
        .collect();
    let n = unit.len();
    let block = block_length(n, n as f64 / response.effective_readings());
    let mut values = Vec::with_capacity(n);
    while values.len() < n {
        let first = rng.random_range(0..n);
        for k in 0..block.min(n - values.len()) {
            let to = values.len();
            values.push(fitted[to] + sd[to] * unit[(first + k) % n]);
        }
    }
    response.with_values(values)
}

/// Block length: several times the memory of the noise, and the root-like growth that the theory asks for.
fn block_length(n: usize, crowding: f64) -> usize {
    let growth = (n as f64).powf(1.0 / 3.0);
    ((growth * crowding).ceil() as usize).clamp(1, (n / 4).max(1))
}

/// The 2.5 % and 97.5 % points and the standard deviation of values; none for fewer than [`FEWEST_REFITS`].
pub(crate) fn spread(values: &mut [f64]) -> Option<(f64, f64, f64)> {
    if values.len() < FEWEST_REFITS {
        return None;
    }
    values.sort_unstable_by(f64::total_cmp);
    let count = values.len() as f64;
    let point = |share: f64| {
        let place = share * (count - 1.0);
        let below = place.floor() as usize;
        let next = (below + 1).min(values.len() - 1);
        values[below] + (values[next] - values[below]) * (place - below as f64)
    };
    Some((point(0.025), point(0.975), standard_deviation(values)))
}
