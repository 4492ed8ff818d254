//! How many digits of the certified values the kernel finds, from both official starts.

use super::{Difficulty, Problem, problems};
use crate::least_squares::{Bounds, Damping, Levenberg, Local, Minimum, Problem as LeastSquares, Settle};
use ieap_domain::number::fixed;

/// Digits to which NIST states its values.
const STATED: f64 = 11.0;

/// A problem over its readings.
struct Searched {
    problem: &'static Problem,
    rows: Vec<(Vec<f64>, f64)>,
}

impl LeastSquares for Searched {
    fn bounds(&self) -> Bounds {
        Bounds::even(self.problem.certified.len(), -1e9, 1e9)
    }

    fn local(&self, b: &[f64], _: f64) -> Local {
        let n = b.len();
        let mut local = Local::zero(n);
        let mut slopes = vec![0.0; n];
        for (x, y) in &self.rows {
            let residual = y - self.problem.model.at(b, x, &mut slopes);
            local.square += residual * residual;
            for row in 0..n {
                local.descent[row] += slopes[row] * residual;
                for column in 0..=row {
                    let sum = local.normal.get(row, column) + slopes[row] * slopes[column];
                    local.normal.set(row, column, sum);
                }
            }
        }
        local
    }
}

impl Searched {
    fn new(problem: &'static Problem) -> Searched {
        Searched {
            rows: problem.readings.rows(),
            problem,
        }
    }

    fn solve(&self, start: &[f64]) -> Minimum {
        let size: f64 = self.rows.iter().map(|(_, y)| y * y).sum();
        let from = |start: &[f64], resolution: f64| {
            let method = Levenberg {
                damping: Damping::Region { first_radius: 10.0 },
                limit: 3000,
                settle: Settle::Part(0.0),
                resolution,
                smallest_move: 0.0,
            };
            method.search(self, start)
        };
        let coarse = from(start, size * f64::EPSILON);
        // Rounded readings, of relative error epsilon, move a sum S of squared residuals by 2 epsilon sqrt(S size):
        // known only where the search has come down.
        let rounding = 2.0 * f64::EPSILON * (coarse.local.square * size).sqrt();
        let fine = from(&coarse.at, rounding.min(size * f64::EPSILON));
        Minimum {
            evaluations: coarse.evaluations + fine.evaluations,
            ..fine
        }
    }
}

/// Correct digits of the worst parameter (logarithm of its relative error), 11 at most.
fn digits(found: &[f64], certified: &[f64]) -> f64 {
    let each = found.iter().zip(certified).map(|(found, certified)| {
        let error = ((found - certified) / certified).abs();
        if error.is_nan() { 0.0 } else { -error.log10() }
    });
    each.fold(STATED, f64::min).max(0.0)
}

#[test]
fn certified_values_are_found_from_both_starts() {
    let mut short = Vec::new();
    for problem in problems() {
        let searched = Searched::new(problem);
        let needed = if problem.difficulty == Difficulty::Higher {
            6.0
        } else {
            8.0
        };
        for (which, start) in problem.starts.into_iter().enumerate() {
            let found = searched.solve(start);
            let digits = digits(&found.at, problem.certified);
            let line = format!(
                "{:22} {:?} start {}: {:>4} digits, {} evaluations, {:?}",
                problem.source,
                problem.difficulty,
                which + 1,
                fixed(digits, 1),
                found.evaluations,
                found.stop
            );
            println!("{line}");
            if digits < needed {
                short.push(format!("{line}\n{:?}", found.at));
            }
        }
    }
    assert!(short.is_empty(), "{short:#?}");
}

#[test]
fn the_data_give_the_certified_sum_of_squares() {
    for problem in problems() {
        // Residuals of Lanczos1 are rounding of its 13 digits; its sum says nothing in double precision.
        if problem.square < 1e-20 {
            continue;
        }
        let square = Searched::new(problem)
            .local(problem.certified, f64::INFINITY)
            .square;
        assert!(
            (square / problem.square - 1.0).abs() < 1e-8,
            "{}: {square} {}",
            problem.source,
            problem.square
        );
    }
}

#[test]
fn derivatives_are_differences() {
    for problem in problems() {
        let b = problem.starts[1];
        let (mut slopes, mut unused) = (vec![0.0; b.len()], vec![0.0; b.len()]);
        for (x, _) in problem.readings.rows() {
            problem.model.at(b, &x, &mut slopes);
            for k in 0..b.len() {
                let step = 1e-6 * b[k];
                let mut moved = |by: f64| {
                    let mut there = b.to_vec();
                    there[k] += by;
                    problem.model.at(&there, &x, &mut unused)
                };
                let difference = (moved(step) - moved(-step)) / (2.0 * step);
                let size = difference.abs() + (moved(0.0) / b[k]).abs();
                assert!(
                    (slopes[k] - difference).abs() <= 1e-6 * size,
                    "{} b{}",
                    problem.source,
                    k + 1
                );
            }
        }
    }
}
