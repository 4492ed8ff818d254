//! The current as a separable problem: time constants enter nonlinearly, conductances linearly.
//!
//! Branch k carries `c_k (V - v_k(t))` with conductance `c_k = A/R_k`; while the source holds a voltage,
//! `V - v_k` is `a_j e^(-t/tau_k)`, where the amplitude `a_j` of segment j follows from tau_k alone.

use ieap_domain::{Drive, Level};
use ieap_numerics::active_set::nonnegative;
use ieap_numerics::decay::{BLOCK, Block, Column, Decay};
use ieap_numerics::gram::{CAPACITY, Gram};
use ieap_numerics::least_squares::Local;
use ieap_numerics::symmetric::Symmetric;

use super::sampled::{Remainder, Sampled};

/// Pivot, relative to the diagonal, below which columns count as dependent.
const DEPENDENT: f64 = 1e-11;

/// The design of the current for given time constants.
pub(super) struct Circuit<'a> {
    pub(super) drive: &'a Drive,
    pub(super) sampled: &'a Sampled,
    /// Whether the instrument's zero is fitted too.
    pub(super) with_offset: bool,
}

/// A solution: time constants with the conductances that fit best to them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Solution {
    /// Logarithms of the time constants in s.
    pub(super) log_time_constants: Vec<f64>,
    /// Conductances of the branches, then the steady one, A/V.
    pub(super) conductances_a_per_v: Vec<f64>,
    /// Offset of the instrument's zero, A; 0 where none is fitted.
    pub(super) offset_a: f64,
    /// Sum of squared residuals, A2.
    pub(super) square: f64,
}

impl Circuit<'_> {
    /// Columns of every block: branches, steady resistor, then the derivatives of the branches with respect
    /// to the logarithms of their time constants (all per conductance), ones where an offset is fitted; and the
    /// measured values.
    pub(super) fn each_block(
        &self,
        log_time_constants: &[f64],
        mut visit: impl FnMut(&Block, &[Column], &Column),
    ) {
        let n = log_time_constants.len();
        let rates: Vec<f64> = log_time_constants.iter().map(|log| (-log).exp()).collect();
        let mut decays: Vec<Decay> = rates.iter().map(|&rate| Decay::new(rate)).collect();
        let amplitudes: Vec<Vec<(f64, f64)>> =
            rates.iter().map(|&rate| amplitudes(self.drive, rate)).collect();
        let mut columns = vec![[0.0; BLOCK]; self.columns(n)];
        let mut y = [0.0; BLOCK];
        for (segment, block) in &self.sampled.blocks {
            let level_v = held_voltage(self.drive, *segment);
            columns[n][..block.len].fill(level_v);
            columns[n][block.len..].fill(0.0);
            let (branches, rest) = columns.split_at_mut(n);
            let slopes = &mut rest[1..];
            for k in 0..n {
                let Some(segment) = *segment else {
                    branches[k].fill(0.0);
                    slopes[k].fill(0.0);
                    continue;
                };
                let (amplitude, slope) = amplitudes[k][segment];
                decays[k].fill(block, &self.sampled.elapsed_s, &mut branches[k]);
                let elapsed_s = &self.sampled.elapsed_s[block.first..block.first + block.len];
                slopes[k][block.len..].fill(0.0);
                let per_second = amplitude * rates[k];
                for ((value, derivative), t) in branches[k].iter_mut().zip(&mut slopes[k]).zip(elapsed_s) {
                    *derivative = (slope + per_second * t) * *value;
                    *value *= amplitude;
                }
            }
            if self.with_offset {
                columns[2 * n + 1] = Sampled::ones(block);
            }
            for column in &mut columns {
                self.sampled.weigh(block, column);
            }
            self.sampled.fill_values(block, &mut y);
            visit(block, &columns, &y);
        }
    }

    /// Number of columns for `n` branches.
    pub(super) fn columns(&self, n: usize) -> usize {
        2 * n + 1 + usize::from(self.with_offset)
    }

    fn gram(&self, log_time_constants: &[f64]) -> Gram {
        let mut gram = Gram::new(self.columns(log_time_constants.len()));
        self.each_block(log_time_constants, |block, columns, y| {
            gram.add_first(block.len, columns, y)
        });
        gram.square = self.sampled.square();
        gram
    }

    /// J'J for columns times `scales`.
    pub(super) fn normal(&self, log_time_constants: &[f64], scales: &[f64; CAPACITY]) -> Symmetric {
        let gram = self.gram(log_time_constants);
        Symmetric::from_fn(gram.matrix.order(), |row, column| {
            scales[row] * scales[column] * gram.matrix.get(row, column)
        })
    }

    /// The sums with the offset, which may have either sign, eliminated; it is the last column.
    fn without_offset(&self, gram: &Gram) -> Gram {
        if self.with_offset {
            gram.eliminate_last()
        } else {
            gram.clone()
        }
    }

    /// Best conductances for the time constants.
    pub(super) fn solve(&self, log_time_constants: &[f64]) -> Solution {
        let whole = self.gram(log_time_constants);
        let n = log_time_constants.len();
        let gram = self.without_offset(&whole);
        let x = conductances(&gram, n);
        let offset_a = if self.with_offset {
            let last = 2 * n + 1;
            (whole.right[last] - whole.matrix.times(&x)[last]) / whole.matrix.get(last, last)
        } else {
            0.0
        };
        Solution {
            log_time_constants: log_time_constants.to_vec(),
            square: gram.residual_square(&x),
            conductances_a_per_v: x,
            offset_a,
        }
    }

    /// Sum of squares with the conductances eliminated, from the residuals themselves: finer than the sum that
    /// `projected` takes from products.
    pub(super) fn projected_square(&self, log_time_constants: &[f64]) -> f64 {
        let solution = self.solve(log_time_constants);
        let conductances_a_per_v = &solution.conductances_a_per_v;
        let mut left = Remainder::default();
        self.each_block(log_time_constants, |block, columns, y| {
            left.add(&y[..block.len], |k| {
                let terms = conductances_a_per_v.iter().zip(columns);
                let offset = if self.with_offset {
                    solution.offset_a * columns[columns.len() - 1][k]
                } else {
                    0.0
                };
                terms.map(|(c, column)| c * column[k]).sum::<f64>() + offset
            });
        });
        left.square(self.sampled)
    }

    /// Sum of squares with the conductances eliminated, and its local model (Kaufman's variable projection).
    pub(super) fn projected(&self, log_time_constants: &[f64]) -> Local {
        let n = log_time_constants.len();
        let gram = self.without_offset(&self.gram(log_time_constants));
        let x = conductances(&gram, n);
        let residual = gram.matrix.times(&x);
        let active: Vec<usize> = (0..=n).filter(|&k| x[k] > 0.0).collect();
        let factor = gram.matrix.part(&active).cholesky(0.0);
        let mut descent = vec![0.0; n];
        let mut solved = vec![vec![0.0; active.len()]; n];
        for k in 0..n {
            descent[k] = x[k] * (gram.right[n + 1 + k] - residual[n + 1 + k]);
            let coupling: Vec<f64> = active.iter().map(|&a| gram.matrix.get(a, n + 1 + k)).collect();
            if let Some(factor) = &factor {
                solved[k] = factor.solve(&coupling);
            }
        }
        let normal = Symmetric::from_fn(n, |row, column| {
            let coupling = active.iter().enumerate();
            let projected: f64 = coupling
                .map(|(j, &a)| gram.matrix.get(a, n + 1 + row) * solved[column][j])
                .sum();
            x[row] * x[column] * (gram.matrix.get(n + 1 + row, n + 1 + column) - projected)
        });
        Local {
            square: gram.residual_square(&x),
            descent,
            normal,
        }
    }
}

/// Conductances of the branches and the steady one, none negative, that leave the least sum of squares.
fn conductances(gram: &Gram, branches: usize) -> Vec<f64> {
    nonnegative(
        &gram.matrix.first(branches + 1),
        &gram.right[..=branches],
        DEPENDENT,
    )
}

/// Voltage that the source holds in a segment, V; zero while the circuit is open.
pub(super) fn held_voltage(drive: &Drive, segment: Option<usize>) -> f64 {
    segment.map_or(drive.baseline_v, |index| {
        drive.segments[index].level.volts().unwrap_or(0.0)
    })
}

/// V - v_k at the start of each segment and its derivative with respect to ln tau_k. Through an open circuit
/// the branch is taken to keep its voltage, which is true for R_ss without end and one branch; drives where
/// that matters are searched further by `coupled`.
fn amplitudes(drive: &Drive, rate_per_s: f64) -> Vec<(f64, f64)> {
    let (mut branch_v, mut slope) = (drive.baseline_v, 0.0);
    let mut found = Vec::with_capacity(drive.segments.len());
    for (index, segment) in drive.segments.iter().enumerate() {
        let Level::Voltage(level_v) = segment.level else {
            found.push((0.0, 0.0));
            continue;
        };
        let amplitude = level_v - branch_v;
        found.push((amplitude, -slope));
        if let Some(next) = drive.segments.get(index + 1) {
            let x = rate_per_s * (next.start_s() - segment.start_s());
            let left = (-x).exp();
            branch_v = level_v - amplitude * left;
            slope = left * (slope - amplitude * x);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::{Channel, Quantity, Segment};
    use ieap_model::{Branch, LumpedModel};
    use ieap_numerics::least_squares::{Bounds, Levenberg, Problem};

    struct OneBranch<'a>(&'a Circuit<'a>);

    impl Problem for OneBranch<'_> {
        fn bounds(&self) -> Bounds {
            Bounds::even(1, -5.0, 10.0)
        }

        fn local(&self, at: &[f64], _: f64) -> Local {
            self.0.projected(at)
        }
    }

    fn drive() -> Drive {
        let segment = |start_s, level_v| Segment::at(start_s, Level::Voltage(level_v));
        Drive {
            baseline_v: 0.3,
            segments: vec![segment(0.0, 2.0), segment(70.0, -1.0), segment(150.0, 0.0)],
        }
    }

    #[test]
    fn columns_are_the_current_of_the_model_and_derivatives_are_differences() {
        let time_s: std::sync::Arc<[f64]> = (0..400).map(|k| k as f64 * 0.7 - 20.0).collect();
        let model = LumpedModel {
            branches: vec![Branch {
                resistance_ohm_cm2: 300.0,
                capacitance_f_per_cm2: 0.1,
            }],
            steady_state_resistance_ohm_cm2: 4000.0,
            charge_to_curvature_per_c_cm: 1.0,
            relaxation_rate_per_s: 0.0,
        };
        let current_a = model.current_a(&drive(), 0.2, &time_s);
        let channel = Channel::new(Quantity::Current, time_s, current_a.clone().into());
        let drive = drive();
        let sampled = Sampled::new(&channel, &drive, false);
        let circuit = Circuit {
            drive: &drive,
            sampled: &sampled,
            with_offset: false,
        };
        let column = |log_tau: f64, which: usize| {
            let mut values: Vec<f64> = Vec::new();
            circuit.each_block(&[log_tau], |block, columns, _| {
                values.extend(&columns[which][..block.len])
            });
            values
        };
        let log_tau = 30.0_f64.ln();
        let (branch, steady, slope) = (column(log_tau, 0), column(log_tau, 1), column(log_tau, 2));
        let (above, below) = (column(log_tau + 1e-5, 0), column(log_tau - 1e-5, 0));
        for k in 0..branch.len() {
            let built: f64 = 0.2 * (branch[k] / 300.0 + steady[k] / 4000.0);
            assert!((built - current_a[k]).abs() < 1e-15_f64, "{k}");
            assert!((slope[k] - (above[k] - below[k]) / 2e-5).abs() < 1e-8, "{k}");
        }
        let found = Levenberg::by_region(60, 1e-10, 0.0).search(&OneBranch(&circuit), &[12.0_f64.ln()]);
        assert!((found.at[0] - log_tau).abs() < 1e-8, "{found:?}");
        let solution = circuit.solve(&found.at);
        assert!((solution.conductances_a_per_v[0] / (0.2 / 300.0) - 1.0).abs() < 1e-8);
    }
}
