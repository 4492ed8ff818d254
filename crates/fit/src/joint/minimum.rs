//! The deepest minimum of one run: where the search starts, and how much the circuit leaves there.

use crate::circuit::Circuit;
use crate::electrical::Electrical;
use crate::search::{CoarseLook, Limits, Search, search};

use ieap_domain::quantiles::NORMAL_ONE_SIDED_99;
use ieap_numerics::chance::reduced_chi_square_limit;
use ieap_numerics::least_squares::Minimum;

use super::problem::{JointProblem, Slot};
use super::readings::RunReadings;
use super::start::{Start, problem};

/// Evaluations of one search.
pub(super) const LIMIT: u64 = 100;
/// Fall of the sum of squares at which a search settles.
pub(super) const SETTLE: f64 = 1e-4;

/// Where a search may start: what step one found, and the best pair of time constants whatever the evidence.
pub(super) fn electrical_starts(
    current: &RunReadings,
    electrical: &Electrical,
    branches: usize,
) -> Vec<Start> {
    let mut starts = vec![Start::of(electrical, branches)];
    let Some(response) = &current.current else {
        return starts;
    };
    if let Some(limits) = Limits::of(&response.sampled) {
        let circuit = Circuit {
            drive: current.drive,
            sampled: &response.sampled,
            with_offset: electrical.offset_a.is_some(),
        };
        let compressed = response.sampled.compressed();
        let circuit = Circuit {
            sampled: &compressed,
            ..circuit
        };
        let look = CoarseLook::new(&circuit, limits);
        let found = search(&circuit, branches, &look, Search::default(), 1e-3).solution;
        let total: f64 = found.conductances_a_per_v.iter().sum();
        if total > 0.0 {
            let area = current.area_cm2;
            let pair = |k: usize| {
                let conductance = found.conductances_a_per_v[k].max(0.02 * total);
                (
                    area / conductance,
                    conductance * found.log_time_constants[k].exp() / area,
                )
            };
            let pairs: Vec<(f64, f64)> = (0..branches).map(pair).collect();
            let mut start = Start::new(&pairs, found.conductances_a_per_v[branches] / area);
            start.searched = starts[0].searched.clone();
            let offset = start.layout().current_offset();
            start.local[offset] = found.offset_a;
            starts.push(start);
        }
    }
    starts
}

/// The deepest minimum from any of the starts, branches in order of their time constants.
pub(crate) fn minimum<'a>(run: &RunReadings<'a>, starts: &[Start]) -> Option<(JointProblem<'a>, Minimum)> {
    let (problem, _) = problem(vec![run.clone()], &starts[..1], &[]);
    let places = starts.iter().map(|start| coordinates(&problem, start));
    let best = Minimum::lowest(places.map(|at| problem.search(&at, LIMIT, SETTLE)))?;
    Some((problem, best))
}

/// Coordinates of a start within an existing problem of one run.
fn coordinates(problem: &JointProblem, start: &Start) -> Vec<f64> {
    let mut at = vec![0.0; problem.bounds.count()];
    for (local, slot) in problem.slots[0].iter().enumerate() {
        if let Slot::Searched(k) = *slot {
            at[k] = start.local[local] / problem.units[local];
        }
    }
    at
}

/// Factor (1 at least) on standard errors: root of the sum of squares that the circuit leaves of what sums of
/// exponentials could explain, per degree of freedom, where it is beyond chance.
pub(crate) fn excess(problem: &JointProblem, bottom: &Minimum) -> f64 {
    let mut out = Vec::new();
    let mut rows = 0;
    for run in 0..problem.runs.len() {
        let local = problem.of_run(run, &bottom.at);
        out.clear();
        problem.runs[run].condensed(&problem.model(&local), problem.offsets(&local), &mut out);
        rows += out.len();
    }
    let freedom = rows as f64 - bottom.at.len() as f64;
    if freedom < 1.0 {
        return 1.0;
    }
    let ratio = (bottom.local.square - problem.beside(&bottom.at)) / freedom;
    let limit = reduced_chi_square_limit(freedom, NORMAL_ONE_SIDED_99);
    if ratio > limit { ratio.sqrt() } else { 1.0 }
}
