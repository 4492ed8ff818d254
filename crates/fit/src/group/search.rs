//! The deepest minimum of a group of runs.

use crate::joint::problem::{JointProblem, Slot};
use crate::joint::readings::RunReadings;
use crate::joint::start::{Start, problem};
use ieap_numerics::least_squares::Minimum;

use super::options::LIMIT;

/// Starts that are tried.
const STARTS: usize = 4;

/// The deepest minimum.
pub(super) fn search<'a>(
    runs: Vec<RunReadings<'a>>,
    starts: &[Start],
    shared: &[usize],
) -> (JointProblem<'a>, Minimum, u64) {
    let (problem, first) = problem(runs, starts, shared);
    let (bottom, evaluations) = deepest(&problem, starts, first);
    (problem, bottom, evaluations)
}

/// The same of a problem that is there; `first` is the place that the starts stand for.
pub(super) fn deepest(problem: &JointProblem, starts: &[Start], first: Vec<f64>) -> (Minimum, u64) {
    let mut evaluations = 0;
    let places = start_places(problem, starts, &first);
    let searched = places.iter().take(STARTS);
    let searched = searched.map(|at| problem.search(at, LIMIT, 1e-4));
    let best = Minimum::lowest(searched.inspect(|found| evaluations += found.evaluations));
    let at = best.map_or(first, |best| best.at);
    let bottom = problem.search(&at, LIMIT, 1e-6);
    let evaluations = evaluations + bottom.evaluations;
    (bottom, evaluations)
}

/// Places to start from: the shared parameters as each of the runs has them, and their mean.
fn start_places(problem: &JointProblem, starts: &[Start], first: &[f64]) -> Vec<Vec<f64>> {
    let value = |run: usize, local: usize| starts[run].local[local] / problem.units[local];
    let with = |base: &[f64], run: usize| {
        let mut at = base.to_vec();
        for (local, slot) in problem.slots[run].iter().enumerate() {
            if let Slot::Searched(k) = *slot {
                at[k] = value(run, local);
            }
        }
        at
    };
    let places: Vec<Vec<f64>> = (0..starts.len()).map(|run| with(first, run)).collect();
    let mut sums = vec![(0.0, 0.0); first.len()];
    for (run, slots) in problem.slots.iter().enumerate() {
        for (local, slot) in slots.iter().enumerate() {
            if let Slot::Searched(k) = *slot
                && starts[run].searched[local]
            {
                sums[k].0 += value(run, local);
                sums[k].1 += 1.0;
            }
        }
    }
    let mean = sums
        .iter()
        .zip(first)
        .map(|((sum, count), v)| if *count > 0.0 { sum / count } else { *v });
    let mut all = vec![mean.collect::<Vec<f64>>()];
    all.extend(places);
    all.dedup();
    all
}
