//! Least squares with a few columns, and what a weighted sum of readings is worth under noise that remembers.

use super::correlation::Autoregression;
use super::sums;
use super::symmetric::{Cholesky, Symmetric};

/// A least-squares solution.
#[derive(Debug, Clone)]
pub struct LeastSquares {
    columns: Vec<Vec<f64>>,
    factor: Cholesky,
    /// One coefficient a column.
    pub coefficients: Vec<f64>,
    /// What is left of the readings.
    pub residuals: Vec<f64>,
}

impl LeastSquares {
    /// Fits `readings` by `columns` of equal length. None where columns depend on each other or
    /// there are more of them than readings.
    pub fn of(columns: Vec<Vec<f64>>, readings: &[f64]) -> Option<LeastSquares> {
        let n = columns.len();
        if readings.len() < n {
            return None;
        }
        let normal = Symmetric::from_fn(n, |row, column| sums::dot(&columns[row], &columns[column]));
        let factor = normal.cholesky(1e-12)?;
        let right: Vec<f64> = columns.iter().map(|column| sums::dot(column, readings)).collect();
        let coefficients = factor.solve(&right);
        let mut residuals = readings.to_vec();
        for (column, coefficient) in columns.iter().zip(&coefficients) {
            sums::add(&mut residuals, -coefficient, column);
        }
        Some(LeastSquares {
            columns,
            factor,
            coefficients,
            residuals,
        })
    }

    /// Sum of the squared residuals.
    pub fn square(&self) -> f64 {
        sums::square(&self.residuals)
    }

    /// Noise of the readings, as the residuals show it.
    pub fn noise(&self) -> Autoregression {
        Autoregression::of(&self.residuals, self.columns.len())
    }

    /// The weights of the readings in the combination SUM c_k coefficient_k.
    pub fn weights(&self, combination: &[f64]) -> Vec<f64> {
        sums::combined(&self.columns, &self.factor.solve(combination))
    }

    /// Entry k, k of the inverse of the normal matrix: variance of a coefficient under white noise of variance 1.
    pub fn inverse_diagonal(&self, k: usize) -> f64 {
        let mut unit = vec![0.0; self.columns.len()];
        unit[k] = 1.0;
        self.factor.solve(&unit)[k]
    }
}

/// Variance of SUM w_i y_i where neighbouring readings are correlated as `noise` says.
pub fn variance_of_sum(weights: &[f64], noise: &Autoregression) -> f64 {
    let (mut own, mut cross, mut carried) = (0.0, 0.0, 0.0);
    for &weight in weights {
        own += weight * weight;
        cross += weight * carried;
        carried = noise.correlation * (carried + weight);
    }
    (noise.variance * (own + 2.0 * cross)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_comes_back_with_its_weights() {
        let x: Vec<f64> = (0..9).map(f64::from).collect();
        let y: Vec<f64> = x.iter().map(|x| 3.0 - 0.5 * x).collect();
        let fit = LeastSquares::of(vec![vec![1.0; 9], x.clone()], &y).unwrap();
        assert!((fit.coefficients[0] - 3.0).abs() < 1e-12 && fit.square() < 1e-20);
        let at_end = fit.weights(&[1.0, 8.0]);
        assert!((sums::dot(&at_end, &y) + 1.0).abs() < 1e-12);
        assert!((fit.inverse_diagonal(1) - 1.0 / 60.0).abs() < 1e-12);
        assert!(LeastSquares::of(vec![x.clone(), x], &y).is_none());
    }

    #[test]
    fn the_variance_of_a_mean_follows_the_memory_of_the_noise() {
        let noise = |correlation| Autoregression {
            variance: 4.0,
            correlation,
        };
        let mean = vec![1e-3; 1000];
        assert!((variance_of_sum(&mean, &noise(0.0)) - 0.004).abs() < 1e-9);
        // Long sums: (1 + rho) / (1 - rho) times as much.
        let ratio = variance_of_sum(&mean, &noise(0.5)) / 0.004;
        assert!((ratio - 3.0).abs() < 0.01, "{ratio}");
    }
}
