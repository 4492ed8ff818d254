//! The deepest minimum of a group of runs.

use crate::joint::dense::{Bottom, descend};
use crate::joint::problem::{JointProblem, Over, Slot};
use crate::joint::readings::RunReadings;
use crate::joint::start::{Start, problem};
use ieap_numerics::levenberg::Stop;

use super::options::LIMIT;

/// Evaluations over all readings.
const POLISH_LIMIT: u64 = 12;
/// Starts that are tried.
const STARTS: usize = 4;

/// The deepest minimum over the condensed readings, polished over all of them.
pub(super) fn search<'a>(
    runs: Vec<RunReadings<'a>>,
    starts: &[Start],
    shared: &[usize],
) -> (JointProblem<'a>, Bottom, u64) {
    let (problem, first) = problem(runs, starts, shared);
    let mut evaluations = 0;
    let mut best: Option<Bottom> = None;
    for at in start_places(&problem, starts, first).iter().take(STARTS) {
        let found = problem.descend(at, LIMIT, 1e-4);
        evaluations += found.evaluations;
        if best
            .as_ref()
            .is_none_or(|best| found.slope.square < best.slope.square)
        {
            best = Some(found);
        }
    }
    let at = best.map(|best| best.at).unwrap_or_default();
    let mut bottom = descend(&at, &problem.low, &problem.high, POLISH_LIMIT, 1e-6, |at| {
        problem.slope(at, Over::Whole)
    });
    evaluations += bottom.evaluations;
    if bottom.stop == Stop::EvaluationLimit {
        // What is left is below the accuracy of the condensed search, which converged.
        let further = descend(&bottom.at, &problem.low, &problem.high, LIMIT, 1e-4, |at| {
            problem.slope(at, Over::Whole)
        });
        evaluations += further.evaluations;
        bottom = further;
    }
    (problem, bottom, evaluations)
}

/// Places to start from: the shared parameters as each of the runs has them, and their mean.
fn start_places(problem: &JointProblem, starts: &[Start], first: Vec<f64>) -> Vec<Vec<f64>> {
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
    let places: Vec<Vec<f64>> = (0..starts.len()).map(|run| with(&first, run)).collect();
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
        .zip(&first)
        .map(|((sum, count), v)| if *count > 0.0 { sum / count } else { *v });
    let mut all = vec![mean.collect::<Vec<f64>>()];
    all.extend(places);
    all.dedup();
    all
}
