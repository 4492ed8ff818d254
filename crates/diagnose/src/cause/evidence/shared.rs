//! Runs that share some parameters and have others of their own, fitted in full.

use ieap_numerics::least_squares::{Bounds, Levenberg, Local, Problem};

use crate::fitting::fitted::{Fitted, LONG};
use crate::fitting::problem::ExtendedProblem;

/// Fall of the sum of squares that ends the search.
const SETTLE: f64 = 1e-2;
/// Searches of [`LONG`] evaluations at most.
const SEARCHES: usize = 4;

/// Where the runs' parameters lie.
pub(super) struct Shared {
    /// Coordinates of every run.
    pub(super) at: Vec<Vec<f64>>,
    /// Standard errors of the coordinates of every run.
    pub(super) standard_errors: Vec<Vec<f64>>,
    pub(super) square: f64,
}

/// Where a run finds its coordinates: shared ones first, then its own.
struct Layout<'a> {
    parameters: usize,
    own: &'a [usize],
}

impl Layout<'_> {
    fn place(&self, run: usize, k: usize) -> usize {
        match self.own.iter().position(|own| *own == k) {
            Some(at) => self.parameters + run * self.own.len() + at,
            None => k,
        }
    }

    fn order(&self, runs: usize) -> usize {
        self.parameters + runs * self.own.len()
    }

    fn of_run(&self, run: usize, at: &[f64]) -> Vec<f64> {
        (0..self.parameters).map(|k| at[self.place(run, k)]).collect()
    }
}

/// Fits the base to those runs, the coordinates `own` free in each, from the places `starts` of these runs by themselves.
pub(super) fn fit(base: &Fitted, own: &[usize], runs: &[usize], starts: &[Vec<f64>]) -> Shared {
    let parameters = base.problem.base_len();
    let layout = Layout { parameters, own };
    let problems: Vec<ExtendedProblem> = runs.iter().map(|&run| base.problem.over(vec![run])).collect();
    let order = layout.order(starts.len());
    let (mut at, mut bounds) = (vec![0.0; order], Bounds::even(order, 0.0, 0.0));
    for (run, start) in starts.iter().enumerate() {
        for (k, own) in start.iter().enumerate().take(parameters) {
            let place = layout.place(run, k);
            // What is shared begins in the middle of the runs' own places.
            let parts = if place == k { starts.len() as f64 } else { 1.0 };
            at[place] += own / parts;
            let (low, high) = base.problem.limits_of(k);
            bounds.set(place, low, high);
        }
    }
    // What is own of every run has no place among the shared ones.
    for &k in own {
        bounds.set(k, 0.0, 0.0);
        at[k] = 0.0;
    }
    let together = Together {
        problems,
        layout,
        bounds,
    };
    let (method, layout) = (Levenberg::by_diagonal(LONG, SETTLE), &together.layout);
    let mut bottom = method.search(&together, &at);
    for _ in 1..SEARCHES {
        let before = bottom.local.square;
        bottom = method.search(&together, &bottom.at);
        if before - bottom.local.square < SETTLE {
            break;
        }
    }
    let inverse = bottom.local.normal.inverse(1e-12);
    let runs: Vec<Vec<f64>> = (0..starts.len())
        .map(|run| layout.of_run(run, &bottom.at))
        .collect();
    let error = |run: usize, k: usize| inverse.error(layout.place(run, k));
    Shared {
        standard_errors: (0..starts.len())
            .map(|run| (0..parameters).map(|k| error(run, k)).collect())
            .collect(),
        at: runs,
        square: bottom.local.square,
    }
}

/// All runs with their shared and their own coordinates.
struct Together<'a, 'g> {
    problems: Vec<ExtendedProblem<'g>>,
    layout: Layout<'a>,
    bounds: Bounds,
}

impl Problem for Together<'_, '_> {
    fn bounds(&self) -> Bounds {
        self.bounds.clone()
    }

    fn local(&self, at: &[f64], _: f64) -> Local {
        let mut all = Local::zero(at.len());
        let layout = &self.layout;
        for (run, problem) in self.problems.iter().enumerate() {
            let own = problem.slope(&layout.of_run(run, at)).0;
            all.square += own.square;
            for a in 0..layout.parameters {
                let place = layout.place(run, a);
                all.descent[place] += own.descent[a];
                for b in 0..layout.parameters {
                    all.normal.add(place, layout.place(run, b), own.normal.get(a, b));
                }
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_find_their_own_parameters_behind_the_shared_ones() {
        let layout = Layout {
            parameters: 3,
            own: &[1],
        };
        let at = [10.0, 0.0, 12.0, 21.0, 31.0];
        assert_eq!(layout.order(2), 5);
        assert_eq!(layout.of_run(0, &at), [10.0, 21.0, 12.0]);
        assert_eq!(layout.of_run(1, &at), [10.0, 31.0, 12.0]);
    }
}
