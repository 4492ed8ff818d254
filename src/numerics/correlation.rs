//! Noise that remembers: first-order autocorrelation and the long-run variance.

use super::sums;

/// Variance and lag-1 autocorrelation of noise, taken as a first-order autoregression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Autoregression {
    /// Variance of the noise.
    pub variance: f64,
    /// Lag-1 autocorrelation, from -0.95 to 0.9999.
    pub correlation: f64,
}

impl Autoregression {
    /// From sums over residuals of `readings` values: `square` = SUM e_t^2, `product` = SUM e_t e_(t+1), left
    /// by a fit of `parameters` smooth terms.
    ///
    /// A fit of smooth terms removes the slow part of the noise, p L of n in SUM e^2 and in SUM e e, with
    /// L = (1+rho)/(1-rho); both sums are put right for it, which matters for short records.
    pub fn from_sums(square: f64, product: f64, readings: f64, parameters: f64) -> Autoregression {
        let raw = if square > 0.0 {
            (product / square).clamp(-0.95, 0.9999)
        } else {
            0.0
        };
        let (mut correlation, mut removed) = (raw, parameters / readings);
        for _ in 0..20 {
            removed = (parameters * memory(correlation) / readings).clamp(0.0, 0.5);
            correlation = (raw * (1.0 - removed) + removed + raw / readings).clamp(-0.95, 0.9999);
        }
        Autoregression {
            variance: square / (readings * (1.0 - removed)).max(1.0),
            correlation,
        }
    }

    /// Variance of a long sum per reading: variance times (1+rho)/(1-rho).
    pub fn long_run_variance(&self) -> f64 {
        self.variance * memory(self.correlation)
    }

    /// Independent readings that carry as much as `readings` of these; never more than there are.
    pub fn effective_readings(&self, readings: f64) -> f64 {
        readings / memory(self.correlation).max(1.0)
    }
}

/// (1+rho)/(1-rho).
fn memory(correlation: f64) -> f64 {
    (1.0 + correlation) / (1.0 - correlation)
}

/// Lag-1 autocorrelation of values whose mean is zero; 0 where there are no values but zeros.
pub fn lag_one(values: &[f64]) -> f64 {
    let (square, product) = (sums::square(values), sums::lagged(values));
    if square > 0.0 { product / square } else { 0.0 }
}

/// Factor (1 at least) by which the long-run variance of `residuals` exceeds `long_run_variance`, judged by
/// the sums over 32 stretches; 1 unless the excess is beyond its own 95 % limit.
///
/// This catches slow misfit under fast noise, which a first-order autoregression does not see.
pub fn slow_excess(residuals: &[f64], long_run_variance: f64, parameters: usize) -> f64 {
    const STRETCHES: usize = 32;
    let length = residuals.len() / STRETCHES;
    if length < 4 || long_run_variance <= 0.0 {
        return 1.0;
    }
    let sums = residuals.chunks_exact(length).map(sums::sum);
    let (square, count) = sums.fold((0.0, 0.0), |(square, count), s| (square + s * s, count + 1.0));
    let freedom = (count - parameters as f64).max(1.0);
    let excess = square / (freedom * length as f64) / long_run_variance;
    // Wilson and Hilferty's approximation of the chi-square quantile.
    let limit = (1.0 - 2.0 / (9.0 * freedom) + 1.645 * (2.0 / (9.0 * freedom)).sqrt()).powi(3);
    if excess > limit { excess } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn autoregressive(rng: &mut impl Rng, n: usize, rho: f64) -> Vec<f64> {
        let mut last: f64 = StandardNormal.sample(rng);
        let mut next = || {
            let fresh: f64 = StandardNormal.sample(rng);
            last = rho * last + (1.0 - rho * rho).sqrt() * fresh;
            last
        };
        (0..n).map(|_| next()).collect()
    }

    #[test]
    fn variance_and_correlation_come_back_even_after_a_mean_was_removed() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for rho in [0.0, 0.6] {
            let (mut variance, mut correlation) = (0.0, 0.0);
            for _ in 0..400 {
                let mut e = autoregressive(&mut rng, 100, rho);
                let mean = e.iter().sum::<f64>() / 100.0;
                e.iter_mut().for_each(|v| *v -= mean);
                let square = e.iter().map(|v| v * v).sum();
                let product = e.windows(2).map(|p| p[0] * p[1]).sum();
                let found = Autoregression::from_sums(square, product, 100.0, 1.0);
                variance += found.variance / 400.0;
                correlation += found.correlation / 400.0;
            }
            assert!((variance - 1.0).abs() < 0.04, "{variance}");
            assert!((correlation - rho).abs() < 0.02, "{correlation}");
        }
    }

    #[test]
    fn slow_misfit_is_seen_and_white_noise_is_not_inflated() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let white = autoregressive(&mut rng, 3200, 0.0);
        assert_eq!(slow_excess(&white, 1.0, 5), 1.0);
        let wavy: Vec<f64> = white
            .iter()
            .enumerate()
            .map(|(k, v)| v + 0.3 * (k as f64 / 100.0).sin())
            .collect();
        assert!(slow_excess(&wavy, 1.0, 5) > 3.0);
    }
}
