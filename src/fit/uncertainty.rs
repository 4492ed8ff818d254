//! What the residuals of a fit say of its noise, and the covariance of its parameters under that noise.

use crate::numerics::column_memory::LongColumn;
use crate::numerics::correlation::{Autoregression, slow_excess};
use crate::numerics::decay::{BLOCK, Column};
use crate::numerics::gram::{Gram, dot};
use crate::numerics::student::quantile_95;
use crate::numerics::sums;
use crate::numerics::symmetric::{CAPACITY, Symmetric};

use super::sampled::Sampled;

/// Eigenvalue of the scaled normal matrix below which a direction counts as lost.
const LOST: f64 = 1e-13;

/// Residuals of one response with what they say of the noise.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Residuals {
    /// Fitted values at the readings used.
    pub(super) fitted: LongColumn,
    /// Measured minus fitted.
    pub(super) residuals: LongColumn,
    /// Sum of their squares.
    pub(super) square: f64,
    /// Variance and lag-1 correlation.
    pub(super) noise: Autoregression,
    /// Factor for slow misfit beyond the autoregression.
    pub(super) excess: f64,
    /// Half-width of a 95 % interval in standard errors.
    pub(super) quantile: f64,
}

impl Residuals {
    /// From fitted values at all readings of `sampled`, of a fit with `parameters` parameters.
    pub(super) fn new(sampled: &Sampled, fitted: impl Into<LongColumn>, parameters: usize) -> Residuals {
        let fitted = fitted.into();
        let mut residuals = LongColumn::with_capacity(fitted.len());
        residuals.extend(sampled.values.iter().zip(&*fitted).map(|(y, f)| y - f));
        let (square, product) = (sums::square(&residuals), sums::lagged(&residuals));
        let readings = residuals.len() as f64;
        let noise = Autoregression::from_sums(square, product, readings, parameters as f64);
        let excess = slow_excess(&residuals, noise.long_run_variance(), parameters);
        let freedom = noise.effective_readings(readings) - parameters as f64;
        Residuals {
            fitted,
            residuals,
            square,
            noise,
            excess,
            quantile: quantile_95(freedom.max(2.0)),
        }
    }

    /// Variance of a long sum per reading, not below what rounding of numbers of size `peak` leaves.
    pub(super) fn long_run_variance(&self, peak: f64) -> f64 {
        let all = self.noise.long_run_variance().max(self.noise.variance) * self.excess;
        all.max((1e-9 * peak).powi(2))
    }
}

/// Sums for the covariance of least squares under noise that is a first-order autoregression:
/// `(J'J)^-1 J' Omega J (J'J)^-1`, with `Omega_st = rho^|s-t|` summed by one recursion along the record.
pub(super) struct CovarianceSums {
    /// J'J.
    pub(super) gram: Gram,
    /// Whether J'J was given and need not be summed.
    is_known: bool,
    /// Z'Z, where z_t = rho z_(t-1) + J_t.
    remembering: Symmetric,
    correlation: f64,
    remembered: [f64; CAPACITY],
}

impl CovarianceSums {
    pub(super) fn new(columns: usize, correlation: f64) -> CovarianceSums {
        CovarianceSums {
            gram: Gram::new(columns),
            is_known: false,
            remembering: Symmetric::zero(columns),
            correlation,
            remembered: [0.0; CAPACITY],
        }
    }

    /// The same where J'J is known already.
    pub(super) fn with_normal(normal: Symmetric, correlation: f64) -> CovarianceSums {
        let mut sums = CovarianceSums::new(normal.order(), correlation);
        sums.gram.matrix = normal;
        sums.is_known = true;
        sums
    }

    /// Adds a block of `len` readings whose design columns, times `scales`, are the Jacobian's.
    pub(super) fn add(&mut self, len: usize, columns: &[Column], scales: &[f64; CAPACITY]) {
        let mut memory = [[0.0; BLOCK]; CAPACITY];
        for (k, column) in columns.iter().enumerate() {
            let out = &mut memory[k];
            for (value, entry) in out[..len].iter_mut().zip(column) {
                *value = scales[k] * entry;
            }
            out[0] += self.correlation * self.remembered[k];
            remember(self.correlation, out);
            self.remembered[k] = out[len - 1];
            out[len..].fill(0.0);
        }
        for row in 0..columns.len() {
            for column in 0..=row {
                let sum = self.remembering.get(row, column) + dot(&memory[row], &memory[column]);
                self.remembering.set(row, column, sum);
                if !self.is_known {
                    let product = scales[row] * scales[column] * dot(&columns[row], &columns[column]);
                    let sum = self.gram.matrix.get(row, column) + product;
                    self.gram.matrix.set(row, column, sum);
                }
            }
        }
    }

    /// Adds whole columns of the Jacobian.
    pub(super) fn add_dense(&mut self, columns: &[&[f64]]) {
        let readings = columns.first().map_or(0, |column| column.len());
        let mut block = vec![[0.0; BLOCK]; columns.len()];
        for start in (0..readings).step_by(BLOCK) {
            let len = BLOCK.min(readings - start);
            for (out, column) in block.iter_mut().zip(columns) {
                out[..len].copy_from_slice(&column[start..start + len]);
                out[len..].fill(0.0);
            }
            self.add(len, &block, &[1.0; CAPACITY]);
        }
    }

    /// The covariance. Where the data lose a direction altogether the plain inverse with that direction held
    /// at rounding is taken, so that its variance is huge and combinations that do not need it stay small.
    pub(super) fn covariance(&self, residuals: &Residuals) -> Symmetric {
        let n = self.gram.matrix.order();
        let inverse = self.gram.matrix.floored_inverse(LOST);
        let lost = (0..n).any(|k| inverse.get(k, k) * self.gram.matrix.get(k, k) > 0.01 / LOST);
        let variance = residuals.noise.variance * residuals.excess;
        if lost {
            let memory =
                residuals.noise.long_run_variance().max(residuals.noise.variance) / residuals.noise.variance;
            let memory = if memory.is_finite() { memory } else { 1.0 };
            return Symmetric::from_fn(n, |row, column| variance * memory * inverse.get(row, column));
        }
        // With J_t = z_t - rho z_(t-1) the double sum telescopes to (1 - rho^2) Z'Z + rho^2 z_n z_n'.
        let rho_square = self.correlation * self.correlation;
        let middle = Symmetric::from_fn(n, |row, column| {
            (1.0 - rho_square) * self.remembering.get(row, column)
                + rho_square * self.remembered[row] * self.remembered[column]
        });
        let sandwich = inverse.sandwich(&middle);
        Symmetric::from_fn(n, |row, column| variance * sandwich.get(row, column))
    }
}

/// What comes before a block while its values are summed up.
const LEAD: usize = 8;

/// Replaces v by z with z_t = rho z_(t-1) + v_t, in steps that double: eight values depend on the eight before.
fn remember(correlation: f64, values: &mut Column) {
    let (mut one, mut two) = ([0.0; BLOCK + LEAD], [0.0; BLOCK + LEAD]);
    one[LEAD..].copy_from_slice(values);
    let square = correlation * correlation;
    double::<1>(correlation, &one, &mut two);
    double::<2>(square, &two, &mut one);
    double::<4>(square * square, &one, &mut two);
    let power = square * square * square * square;
    for start in (LEAD..BLOCK + LEAD).step_by(LEAD) {
        for lane in 0..LEAD {
            two[start + lane] += power * two[start + lane - LEAD];
        }
    }
    values.copy_from_slice(&two[LEAD..]);
}

/// Adds to each value `power` times the one `REACH` before it.
fn double<const REACH: usize>(power: f64, from: &[f64; BLOCK + LEAD], to: &mut [f64; BLOCK + LEAD]) {
    for t in LEAD..BLOCK + LEAD {
        to[t] = from[t] + power * from[t - REACH];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_telescoped_sum_is_the_double_sum() {
        let columns: [Column; 2] = [
            std::array::from_fn(|k| (-0.1 * k as f64).exp()),
            std::array::from_fn(|k| (k as f64 * 0.7).sin()),
        ];
        let mut scales = [0.0; CAPACITY];
        scales[..2].copy_from_slice(&[2.0, 0.5]);
        for rho in [-0.5_f64, 0.0, 0.3, 0.97] {
            let mut sums = CovarianceSums::new(2, rho);
            sums.add(BLOCK, &columns, &scales);
            let jacobian = |row: usize, t: usize| scales[row] * columns[row][t];
            let direct = Symmetric::from_fn(2, |a, b| {
                let pairs = (0..BLOCK).flat_map(|s| (0..BLOCK).map(move |t| (s, t)));
                pairs
                    .map(|(s, t)| jacobian(a, s) * rho.powi(s.abs_diff(t) as i32) * jacobian(b, t))
                    .sum()
            });
            let residuals = Residuals {
                fitted: LongColumn::default(),
                residuals: LongColumn::default(),
                square: 1.0,
                noise: Autoregression {
                    variance: 1.0,
                    correlation: rho,
                },
                excess: 1.0,
                quantile: 2.0,
            };
            let expected = sums.gram.matrix.floored_inverse(LOST).sandwich(&direct);
            let found = sums.covariance(&residuals);
            for (a, b) in [(0, 0), (1, 0), (1, 1)] {
                let near = (found.get(a, b) - expected.get(a, b)).abs();
                assert!(
                    near < 1e-12 * expected.get(a, a).abs().max(expected.get(b, b).abs()),
                    "{rho}"
                );
            }
        }
    }
}
