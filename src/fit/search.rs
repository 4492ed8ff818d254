//! Where the time constants lie: a coarse look at every pair, then descent from the best few places.

use crate::numerics::gram::Gram;
use crate::numerics::levenberg::Stop;
use crate::numerics::nonnegative::nonnegative_least_squares;
use crate::numerics::symmetric::Symmetric;

use super::circuit::{Circuit, Solution};
use super::sampled::Sampled;

/// Time constants in the coarse look.
const GRID: usize = 16;
/// Places from which the search descends.
const DESCENTS: usize = 2;
/// Part of the sum of squares at which a descent over groups settles: the last one goes over all readings.
const SETTLE_COARSE: f64 = 1e-3;
/// Evaluations allowed to one descent.
const LIMIT: u64 = 80;

/// Limits of the time constants, logarithms of s: a third of the sampling interval, and a hundred records.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limits {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Limits {
    /// Limits that the sampling sets; none where no time passes.
    pub(super) fn of(sampled: &Sampled) -> Option<Limits> {
        let (shortest_s, longest_s) = sampled.time_scales_s();
        let (low, high) = ((shortest_s / 3.0).ln(), (longest_s * 100.0).ln());
        (low.is_finite() && high.is_finite() && high > low).then_some(Limits { low, high })
    }
}

/// The best solution found and the way there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    pub(super) solution: Solution,
    pub(super) stop: Stop,
    pub(super) evaluations: u64,
}

/// Fits `branches` (0, 1 or 2) R-C branches to the current.
pub(super) fn search(
    full: &Circuit,
    grouped: &Sampled,
    branches: usize,
    limits: Limits,
    settle: f64,
) -> Found {
    if branches == 0 {
        return Found {
            solution: full.solve(&[]),
            stop: Stop::Converged,
            evaluations: 1,
        };
    }
    let coarse = Circuit {
        sampled: grouped,
        ..*full
    };
    let mut evaluations = 0;
    let mut best: Option<(f64, Vec<f64>)> = None;
    for start in starts(&coarse, branches, limits) {
        let found = coarse.minimise(&start, limits.low, limits.high, LIMIT, SETTLE_COARSE);
        evaluations += found.evaluations;
        let square = found.local.square;
        if best.as_ref().is_none_or(|(least, _)| square < *least) {
            best = Some((square, found.at[..branches].to_vec()));
        }
    }
    let start = best.map_or_else(|| vec![(limits.low + limits.high) / 2.0; branches], |(_, at)| at);
    let found = full.minimise(&start, limits.low, limits.high, LIMIT, settle);
    Found {
        solution: full.solve(&found.at[..branches]),
        stop: found.stop,
        evaluations: evaluations + found.evaluations,
    }
}

/// The most promising places of the coarse look, no two of them neighbours.
fn starts(coarse: &Circuit, branches: usize, limits: Limits) -> Vec<Vec<f64>> {
    // Above ten records the look tells nothing that it does not tell at ten.
    let high = limits.high - 10.0_f64.ln();
    let at = |k: usize| limits.low + (high - limits.low) * (k as f64 + 0.5) / GRID as f64;
    let table = products(coarse, &(0..GRID).map(at).collect::<Vec<f64>>());
    let mut places: Vec<(f64, usize, usize)> = Vec::new();
    for slow in 0..GRID {
        for fast in if branches == 1 { slow..slow + 1 } else { 0..slow } {
            let own = if branches == 1 {
                vec![slow, GRID]
            } else {
                vec![fast, slow, GRID]
            };
            places.push((table.square_of(&own), fast, slow));
        }
    }
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut chosen: Vec<(usize, usize)> = Vec::new();
    for (_, fast, slow) in places {
        if chosen
            .iter()
            .all(|&(f, s)| f.abs_diff(fast).max(s.abs_diff(slow)) > 1)
        {
            chosen.push((fast, slow));
        }
        if chosen.len() == DESCENTS {
            break;
        }
    }
    (chosen.into_iter())
        .map(|(fast, slow)| {
            if branches == 1 {
                vec![at(slow)]
            } else {
                vec![at(fast), at(slow)]
            }
        })
        .collect()
}

/// Inner products of the columns of every time constant of the coarse look; the steady column stands last.
struct Products {
    matrix: Vec<[f64; GRID + 1]>,
    right: [f64; GRID + 1],
    square: f64,
}

impl Products {
    /// Least sum of squares that the columns `own` leave.
    fn square_of(&self, own: &[usize]) -> f64 {
        let mut gram = Gram::new(own.len());
        gram.matrix = Symmetric::from_fn(own.len(), |row, column| self.matrix[own[row]][own[column]]);
        for (k, &column) in own.iter().enumerate() {
            gram.right[k] = self.right[column];
        }
        gram.square = self.square;
        gram.residual_square(&nonnegative_least_squares(&gram, own.len()))
    }
}

fn products(coarse: &Circuit, log_time_constants: &[f64]) -> Products {
    let mut columns: Vec<Vec<f64>> = Vec::with_capacity(GRID + 1);
    let mut y: Vec<f64> = Vec::new();
    for (k, &log) in log_time_constants.iter().enumerate() {
        let (mut own, mut steady) = (Vec::new(), Vec::new());
        coarse.each_block(&[log], |block, block_columns, values| {
            own.extend_from_slice(&block_columns[0][..block.len]);
            if k + 1 == GRID {
                steady.extend_from_slice(&block_columns[1][..block.len]);
                y.extend_from_slice(&values[..block.len]);
            }
        });
        columns.push(own);
        if k + 1 == GRID {
            columns.push(steady);
        }
    }
    let dot = |a: &[f64], b: &[f64]| {
        let mut sums = [0.0; 4];
        let (left, right) = (a.chunks_exact(4), b.chunks_exact(4));
        let rest: f64 = left
            .remainder()
            .iter()
            .zip(right.remainder())
            .map(|(a, b)| a * b)
            .sum();
        for (left, right) in left.zip(right) {
            for lane in 0..4 {
                sums[lane] += left[lane] * right[lane];
            }
        }
        sums.iter().sum::<f64>() + rest
    };
    let mut table = Products {
        matrix: vec![[0.0; GRID + 1]; GRID + 1],
        right: [0.0; GRID + 1],
        square: dot(&y, &y),
    };
    for row in 0..=GRID {
        for column in 0..=row {
            let product = dot(&columns[row], &columns[column]);
            table.matrix[row][column] = product;
            table.matrix[column][row] = product;
        }
        table.right[row] = dot(&columns[row], &y);
    }
    table
}
