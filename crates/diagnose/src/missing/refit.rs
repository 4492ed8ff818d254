//! Base and a law fitted together, with what is known of the law's weights before: along slopes that were taken once, then anew.

use ieap_numerics::least_squares::{Bounds, Levenberg, Local, Problem};
use ieap_numerics::sums::dot;
use ieap_numerics::symmetric::Symmetric;

use crate::fitting::problem::{ExtendedProblem, local_of};

/// Evaluations along slopes that are held, and of slopes anew.
const HELD: u64 = 14;
const ANEW: u64 = 4;
/// Fall of the sum of squares that ends a search, and as a part of what is beyond noise.
const SETTLE: f64 = 0.05;
const SETTLE_PART: f64 = 1e-3;

/// A model at its most probable place.
#[derive(Clone)]
pub(crate) struct Refit<'g> {
    pub(crate) problem: ExtendedProblem<'g>,
    /// Precision of each of the last coordinates before any reading.
    pub(crate) known: Vec<f64>,
    pub(crate) at: Vec<f64>,
    /// Sum of squares of the readings alone.
    pub(crate) square: f64,
    /// Derivatives of the residuals there.
    pub(crate) columns: Vec<Vec<f64>>,
}

impl<'g> Refit<'g> {
    /// From a place with the derivatives of the residuals about it.
    pub(crate) fn of(
        problem: ExtendedProblem<'g>,
        known: Vec<f64>,
        start: &[f64],
        columns: Vec<Vec<f64>>,
    ) -> Option<Refit<'g>> {
        let settle = SETTLE + SETTLE_PART * (problem.square(start) - problem.group.rows() as f64).max(0.0);
        let along = |columns: Option<&[Vec<f64>]>, from: &[f64], limit| {
            let searched = Searched {
                problem: &problem,
                known: &known,
                columns,
            };
            Levenberg::by_diagonal(limit, settle).search(&searched, from).at
        };
        let at = along(Some(&columns), start, HELD);
        let at = along(None, &at, ANEW);
        let (_, columns) = problem.slope(&at);
        let square = problem.square(&at);
        square.is_finite().then_some(Refit {
            problem,
            known,
            at,
            square,
            columns,
        })
    }

    /// Penalised sum of squares.
    pub(crate) fn penalised(&self) -> f64 {
        self.square + penalty(&self.known, &self.at)
    }

    /// Where it lies without some rows, along the slopes that it has.
    pub(crate) fn without(&self, out: &[bool]) -> Vec<f64> {
        let problem = self.problem.without(out);
        let keep = |column: &Vec<f64>| -> Vec<f64> {
            let rows = column.iter().zip(out);
            rows.map(|(v, is_out)| if *is_out { 0.0 } else { *v }).collect()
        };
        let columns: Vec<Vec<f64>> = self.columns.iter().map(keep).collect();
        let searched = Searched {
            problem: &problem,
            known: &self.known,
            columns: Some(&columns),
        };
        Levenberg::by_diagonal(HELD, SETTLE)
            .search(&searched, &self.at)
            .at
    }
}

fn penalty(known: &[f64], at: &[f64]) -> f64 {
    let last = &at[at.len() - known.len()..];
    known.iter().zip(last).map(|(known, at)| known * at * at).sum()
}

fn add_known(local: &mut Local, known: &[f64], at: &[f64]) {
    let diagonal = Symmetric::from_fn(known.len(), |a, b| if a == b { known[a] } else { 0.0 });
    local.add_known_before(&diagonal, 1.0, at);
}

/// The problem with what is known before; along `columns` where they are held.
struct Searched<'p, 'g> {
    problem: &'p ExtendedProblem<'g>,
    known: &'p [f64],
    columns: Option<&'p [Vec<f64>]>,
}

impl Problem for Searched<'_, '_> {
    fn bounds(&self) -> Bounds {
        self.problem.bounds().clone()
    }

    fn local(&self, at: &[f64], most: f64) -> Local {
        let mut here = Vec::new();
        self.problem.residuals(at, &mut here);
        let square = dot(&here, &here) + penalty(self.known, at);
        if square > most || !square.is_finite() {
            return Local::refused(square, at.len());
        }
        let mut local = match self.columns {
            Some(columns) => local_of(&here, &columns.iter().collect::<Vec<_>>()),
            None => self.problem.slope(at).0,
        };
        add_known(&mut local, self.known, at);
        local
    }
}
