//! What the residuals of a fit say of its noise, and the covariance of its parameters under that noise.

use ieap_domain::Estimate;
use ieap_domain::quantiles::NORMAL_95;
use ieap_numerics::column_memory::LongColumn;
use ieap_numerics::correlation::{
    Autoregression, HigherOrder, readings_per_independent, recurring_excess, slow_excess,
};
use ieap_numerics::decay::{BLOCK, Column};
use ieap_numerics::gram::{CAPACITY, Gram};
use ieap_numerics::student::quantile_95;
use ieap_numerics::sums::{self, dot};
use ieap_numerics::symmetric::Symmetric;

use super::sampled::Sampled;
use crate::policy::LOST_BELOW;

/// Why a memory of several readings is no correlation of neighbours.
pub(crate) const NOT_ONE_NUMBER: &str =
    "the noise remembers more than its last reading: see its autoregression";

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
    /// Autoregression of higher order, where the first is not enough.
    pub(super) higher: Option<HigherOrder>,
    /// Factor for slow misfit beyond the autoregression, or for what comes back with every period of a wave.
    pub(super) excess: f64,
    /// Half-width of a 95 % interval in standard errors.
    pub(super) quantile: f64,
}

/// Variance of a long sum per reading in variances of the noise.
fn memory(noise: &Autoregression, higher: Option<&HigherOrder>) -> f64 {
    higher.map_or_else(
        || readings_per_independent(noise.correlation),
        HigherOrder::long_run_ratio,
    )
}

impl Residuals {
    /// From fitted values at all readings of `sampled`, of a fit with `parameters` parameters.
    pub(super) fn new(sampled: &Sampled, fitted: impl Into<LongColumn>, parameters: usize) -> Residuals {
        let fitted = fitted.into();
        let mut residuals = LongColumn::with_capacity(fitted.len());
        residuals.extend(sampled.values.iter().zip(&*fitted).map(|(y, f)| y - f));
        let noise = Autoregression::of(&residuals, parameters);
        let higher = HigherOrder::of(&residuals, parameters as f64, &noise);
        let memory = memory(&noise, higher.as_ref());
        let recurring = sampled.period_s.map_or(1.0, |period_s| {
            recurring_excess(&sampled.time_s, &residuals, period_s, memory, parameters)
        });
        let excess = slow_excess(&residuals, noise.variance * memory, parameters).max(recurring);
        let freedom = residuals.len() as f64 / memory.max(1.0) - parameters as f64;
        Residuals {
            fitted,
            square: sums::square(&residuals),
            residuals,
            noise,
            higher,
            excess,
            quantile: quantile_95(freedom.max(2.0)),
        }
    }

    /// Variance of a long sum per reading, not below what rounding of numbers of size `peak` leaves.
    pub(super) fn long_run_variance(&self, peak: f64) -> f64 {
        let all = self.noise.variance * self.long_run_ratio() * self.excess;
        all.max((1e-9 * peak).powi(2))
    }

    /// Variance of a long sum per reading in variances of the noise, 1 at least.
    fn long_run_ratio(&self) -> f64 {
        memory(&self.noise, self.higher.as_ref()).max(1.0)
    }

    /// Correlation of neighbouring residuals, known as well as that of a first-order autoregression can be.
    pub(super) fn memory(&self) -> Estimate {
        if self.higher.is_some() {
            return Estimate::not_determined(NOT_ONE_NUMBER);
        }
        let value = self.noise.correlation;
        let error = ((1.0 - value * value).max(0.0) / self.residuals.len().max(1) as f64).sqrt();
        let (low, high) = (value - NORMAL_95 * error, value + NORMAL_95 * error);
        Estimate::determined(value, error, low.max(-1.0), high.min(1.0))
    }

    /// Coefficients of the autoregression, lag 1 first.
    pub(super) fn coefficients(&self) -> &[f64] {
        match &self.higher {
            Some(higher) => &higher.coefficients,
            None => std::slice::from_ref(&self.noise.correlation),
        }
    }
}

/// Sums for the covariance of least squares under noise that is an autoregression:
/// `(J'J)^-1 J' Omega J (J'J)^-1`, with Omega the correlations of the noise, summed by one recursion along the
/// record (a first-order one has `Omega_st = rho^|s-t|`).
pub(super) struct CovarianceSums {
    /// J'J.
    pub(super) gram: Gram,
    /// Whether J'J was given and need not be summed.
    is_known: bool,
    /// Z'Z, where z_t = a_1 z_(t-1) + a_2 z_(t-2) + .. + J_t.
    remembering: Symmetric,
    /// a_1, a_2, ...; one at least.
    coefficients: Vec<f64>,
    /// The last z of every column, the very last first.
    remembered: [[f64; MOST_ORDER]; CAPACITY],
}

/// Highest order of the noise.
const MOST_ORDER: usize = 3;

impl CovarianceSums {
    /// For noise of those autoregressive coefficients, lag 1 first, three at most.
    pub(super) fn new(columns: usize, coefficients: &[f64]) -> CovarianceSums {
        debug_assert!((1..=MOST_ORDER).contains(&coefficients.len()));
        CovarianceSums {
            gram: Gram::new(columns),
            is_known: false,
            remembering: Symmetric::zero(columns),
            coefficients: coefficients.to_vec(),
            remembered: [[0.0; MOST_ORDER]; CAPACITY],
        }
    }

    /// The same where J'J is known already.
    pub(super) fn with_normal(normal: Symmetric, coefficients: &[f64]) -> CovarianceSums {
        let mut sums = CovarianceSums::new(normal.order(), coefficients);
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
            let last = &mut self.remembered[k];
            if let [correlation] = self.coefficients[..] {
                out[0] += correlation * last[0];
                remember(correlation, out);
                last[0] = out[len - 1];
            } else {
                for value in &mut out[..len] {
                    *value += next(&self.coefficients, last);
                    push(last, *value);
                }
            }
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
        let inverse = self.gram.matrix.floored_inverse(LOST_BELOW);
        let lost = (0..n).any(|k| inverse.get(k, k) * self.gram.matrix.get(k, k) > 0.01 / LOST_BELOW);
        let variance = residuals.noise.variance * residuals.excess;
        if lost {
            let memory = residuals.long_run_ratio();
            return Symmetric::from_fn(n, |row, column| variance * memory * inverse.get(row, column));
        }
        let middle = self.middle(residuals);
        let sandwich = inverse.sandwich(&middle);
        Symmetric::from_fn(n, |row, column| variance * sandwich.get(row, column))
    }

    /// J' Omega J: the share of the noise that is new at every reading times Z'Z, z followed beyond the record until
    /// it has died away.
    fn middle(&self, residuals: &Residuals) -> Symmetric {
        let n = self.gram.matrix.order();
        if let [correlation] = self.coefficients[..] {
            // With J_t = z_t - rho z_(t-1) the sum telescopes to (1 - rho^2) Z'Z + rho^2 z_n z_n'.
            let square = correlation * correlation;
            let last = |k: usize| self.remembered[k][0];
            return Symmetric::from_fn(n, |row, column| {
                (1.0 - square) * self.remembering.get(row, column) + square * last(row) * last(column)
            });
        }
        let mut sums = self.remembering.clone();
        let mut last = self.remembered;
        // The slowest memory that is taken has coefficients that sum to 0.985.
        for _ in 0..2000 {
            for of_column in &mut last[..n] {
                let value = next(&self.coefficients, of_column);
                push(of_column, value);
            }
            for row in 0..n {
                for column in 0..=row {
                    sums.set(
                        row,
                        column,
                        sums.get(row, column) + last[row][0] * last[column][0],
                    );
                }
            }
        }
        let share = residuals.higher.as_ref().map_or(1.0, |higher| higher.share);
        Symmetric::from_fn(n, |row, column| share * sums.get(row, column))
    }
}

/// What the last values of a column add to its next.
fn next(coefficients: &[f64], last: &[f64; MOST_ORDER]) -> f64 {
    coefficients.iter().zip(last).map(|(a, z)| a * z).sum()
}

fn push(last: &mut [f64; MOST_ORDER], value: f64) {
    *last = [value, last[0], last[1]];
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

    fn columns() -> [Column; 2] {
        [
            std::array::from_fn(|k| (-0.1 * k as f64).exp()),
            std::array::from_fn(|k| (k as f64 * 0.7).sin()),
        ]
    }

    /// The covariance from the recursion against the double sum over the correlations of the noise.
    #[track_caller]
    fn assert_is_the_double_sum(
        noise: Autoregression,
        higher: Option<HigherOrder>,
        correlation: impl Fn(usize) -> f64,
    ) {
        let columns = columns();
        let mut scales = [0.0; CAPACITY];
        scales[..2].copy_from_slice(&[2.0, 0.5]);
        let residuals = Residuals {
            fitted: LongColumn::default(),
            residuals: LongColumn::default(),
            square: 1.0,
            noise,
            higher,
            excess: 1.0,
            quantile: 2.0,
        };
        let mut sums = CovarianceSums::new(2, residuals.coefficients());
        sums.add(BLOCK, &columns, &scales);
        let jacobian = |row: usize, t: usize| scales[row] * columns[row][t];
        let direct = Symmetric::from_fn(2, |a, b| {
            let pairs = (0..BLOCK).flat_map(|s| (0..BLOCK).map(move |t| (s, t)));
            pairs
                .map(|(s, t)| jacobian(a, s) * correlation(s.abs_diff(t)) * jacobian(b, t))
                .sum()
        });
        let expected = sums.gram.matrix.floored_inverse(LOST_BELOW).sandwich(&direct);
        let found = sums.covariance(&residuals);
        for (a, b) in [(0, 0), (1, 0), (1, 1)] {
            let near = (found.get(a, b) - expected.get(a, b)).abs();
            assert!(
                near < 1e-11 * expected.get(a, a).abs().max(expected.get(b, b).abs()),
                "{a} {b}: {} {}",
                found.get(a, b),
                expected.get(a, b)
            );
        }
    }

    #[test]
    fn the_recursion_is_the_double_sum_for_noise_of_every_order() {
        for rho in [-0.5_f64, 0.0, 0.3, 0.97] {
            let noise = Autoregression {
                variance: 1.0,
                correlation: rho,
            };
            assert_is_the_double_sum(noise, None, |lag| rho.powi(lag as i32));
        }
        for coefficients in [vec![0.5, 0.3], vec![0.4, -0.2, 0.5]] {
            // Correlations by iterating the autoregression's own equations to rest.
            let mut lags = [0.0; BLOCK + 3];
            lags[0] = 1.0;
            for _ in 0..2000 {
                for k in 1..lags.len() {
                    lags[k] = (coefficients.iter().enumerate())
                        .map(|(j, a)| a * lags[k.abs_diff(j + 1)])
                        .sum();
                }
            }
            let known: f64 = coefficients
                .iter()
                .enumerate()
                .map(|(j, a)| a * lags[j + 1])
                .sum();
            let noise = Autoregression {
                variance: 1.0,
                correlation: lags[1],
            };
            let share = 1.0 - known;
            let higher = HigherOrder { coefficients, share };
            assert_is_the_double_sum(noise, Some(higher), |lag| lags[lag]);
        }
    }
}
