//! What the residuals of a fit say of its noise, and the covariance of its parameters under that noise.

use crate::numerics::correlation::{Autoregression, slow_excess};
use crate::numerics::decay::{BLOCK, Column};
use crate::numerics::gram::{Gram, dot};
use crate::numerics::student::quantile_95;
use crate::numerics::symmetric::{CAPACITY, Symmetric};

use super::sampled::Sampled;

/// Eigenvalue of the scaled normal matrix below which a direction counts as lost.
const LOST: f64 = 1e-13;

/// Residuals of one response with what they say of the noise.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Residuals {
    /// Fitted values at the readings used.
    pub(super) fitted: Vec<f64>,
    /// Measured minus fitted.
    pub(super) residuals: Vec<f64>,
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
    pub(super) fn new(sampled: &Sampled, fitted: Vec<f64>, parameters: usize) -> Residuals {
        let residuals: Vec<f64> = sampled.values.iter().zip(&fitted).map(|(y, f)| y - f).collect();
        let (mut square, mut product, mut last) = (0.0, 0.0, 0.0);
        for &r in &residuals {
            square += r * r;
            product += r * last;
            last = r;
        }
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
    middle: Symmetric,
    correlation: f64,
    remembered: [f64; CAPACITY],
}

impl CovarianceSums {
    pub(super) fn new(columns: usize, correlation: f64) -> CovarianceSums {
        CovarianceSums {
            gram: Gram::new(columns),
            middle: Symmetric::zero(columns),
            correlation,
            remembered: [0.0; CAPACITY],
        }
    }

    /// Adds a block of `len` readings whose design columns, times `scales`, are the Jacobian's.
    pub(super) fn add(&mut self, len: usize, columns: &[Column], scales: &[f64; CAPACITY]) {
        let mut scaled = [[0.0; BLOCK]; CAPACITY];
        let mut memory = [[0.0; BLOCK]; CAPACITY];
        for (k, column) in columns.iter().enumerate() {
            let mut z = self.remembered[k];
            for t in 0..len {
                let value = scales[k] * column[t];
                scaled[k][t] = value;
                z = self.correlation * z + value;
                memory[k][t] = z;
            }
            self.remembered[k] = z;
        }
        let n = columns.len();
        self.gram.add(&scaled[..n], &[0.0; BLOCK]);
        for row in 0..n {
            for column in 0..=row {
                let both = dot(&scaled[row], &memory[column]) + dot(&memory[row], &scaled[column]);
                self.middle.set(row, column, self.middle.get(row, column) + both);
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
        let middle = Symmetric::from_fn(n, |row, column| {
            self.middle.get(row, column) - self.gram.matrix.get(row, column)
        });
        let sandwich = inverse.sandwich(&middle);
        Symmetric::from_fn(n, |row, column| variance * sandwich.get(row, column))
    }
}
