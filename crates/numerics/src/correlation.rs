//! Noise that remembers: autoregressions of first to third order, and the long-run variance.

use super::chance::reduced_chi_square_limit;
use super::sums;
use ieap_domain::quantiles::NORMAL_ONE_SIDED_95;

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
            removed = (parameters * readings_per_independent(correlation) / readings).clamp(0.0, 0.5);
            correlation = (raw * (1.0 - removed) + removed + raw / readings).clamp(-0.95, 0.9999);
        }
        Autoregression {
            variance: square / (readings * (1.0 - removed)).max(1.0),
            correlation,
        }
    }

    /// Of what a fit of `parameters` smooth terms left.
    pub fn of(residuals: &[f64], parameters: usize) -> Autoregression {
        let (square, product) = (sums::square(residuals), sums::lagged(residuals));
        Autoregression::from_sums(square, product, residuals.len() as f64, parameters as f64)
    }

    /// Variance of a long sum per reading: variance times (1+rho)/(1-rho).
    pub fn long_run_variance(&self) -> f64 {
        self.variance * readings_per_independent(self.correlation)
    }

    /// Independent readings that carry as much as `readings` of these; never more than there are.
    pub fn effective_readings(&self, readings: f64) -> f64 {
        readings / readings_per_independent(self.correlation).max(1.0)
    }
}

/// An autoregression of second or third order, where the residuals show that the first is not enough.
#[derive(Debug, Clone, PartialEq)]
pub struct HigherOrder {
    /// Coefficients of lag 1, 2, ...
    pub coefficients: Vec<f64>,
    /// Share of the variance that is new at every reading.
    pub share: f64,
}

/// Residuals from which higher orders are looked at. Chosen.
pub const FEWEST_FOR_ORDER: usize = 300;
/// Twice the gain in log likelihood that a further order, or another property of the noise, must bring, beside BIC: 20 to 1. Chosen.
pub const NOISE_EVIDENCE: f64 = 6.0;

impl HigherOrder {
    /// The order that BIC takes for `residuals`, which a fit of `parameters` smooth terms left; none where `first`
    /// is enough.
    pub fn of(residuals: &[f64], parameters: f64, first: &Autoregression) -> Option<HigherOrder> {
        if residuals.len() < FEWEST_FOR_ORDER {
            return None;
        }
        let n = residuals.len() as f64;
        let lag = |k: usize| sums::dot(&residuals[k..], &residuals[..residuals.len() - k]) / n;
        // The smooth terms took the slow part of the noise out of every lag alike (see `Autoregression::from_sums`).
        let removed = (parameters * readings_per_independent(first.correlation) / n).clamp(0.0, 0.5);
        let variance = lag(0) / (1.0 - removed);
        let lags: [f64; 4] = std::array::from_fn(|k| lag(k) + removed * variance);
        let (_, of_first) = yule_walker(&lags[..2])?;
        let penalty = n.ln().max(NOISE_EVIDENCE);
        let (mut best, mut chosen) = (0.0, None);
        for order in 2..=3 {
            let Some((coefficients, share)) = yule_walker(&lags[..=order]) else {
                break;
            };
            let gain = n * (of_first / share).ln() - (order - 1) as f64 * penalty;
            if gain > best {
                (best, chosen) = (gain, Some(HigherOrder { coefficients, share }));
            }
        }
        chosen
    }

    /// Variance of a long sum per reading, in variances of the noise.
    pub fn long_run_ratio(&self) -> f64 {
        self.share / (1.0 - self.coefficients.iter().sum::<f64>()).powi(2)
    }
}

/// The same of an autoregression with these coefficients, of lag 1, 2, ...; 1 of none.
pub fn long_run_ratio(coefficients: &[f64]) -> f64 {
    // From order to order down (Levinson and Durbin), each leaves a share of the variance.
    let (mut order, mut share) = (coefficients.to_vec(), 1.0);
    while let Some(partial) = order.pop() {
        let left = 1.0 - partial * partial;
        let turned: Vec<f64> = order.iter().rev().copied().collect();
        order
            .iter_mut()
            .zip(turned)
            .for_each(|(a, b)| *a = (*a + partial * b) / left);
        share *= left;
    }
    share / (1.0 - coefficients.iter().sum::<f64>()).powi(2)
}

/// Coefficients of the autoregression with those autocovariances, and the share of the variance that is new at
/// every reading; none where it would not be stationary.
pub fn yule_walker(lags: &[f64]) -> Option<(Vec<f64>, f64)> {
    let mut coefficients: Vec<f64> = Vec::new();
    let mut variance = lags[0];
    let mut share = 1.0;
    for k in 1..lags.len() {
        let known: f64 = coefficients
            .iter()
            .enumerate()
            .map(|(j, a)| a * lags[k - 1 - j])
            .sum();
        let partial = (lags[k] - known) / variance;
        if partial.is_nan() || partial.abs() >= 0.98 {
            return None;
        }
        let turned: Vec<f64> = coefficients.iter().rev().copied().collect();
        sums::add(&mut coefficients, -partial, &turned);
        coefficients.push(partial);
        variance *= 1.0 - partial * partial;
        share *= 1.0 - partial * partial;
    }
    (coefficients.iter().sum::<f64>() < 0.985 && share > 0.0).then_some((coefficients, share))
}

/// Readings that carry as much as one independent one where neighbours have that correlation: (1+rho)/(1-rho).
pub fn readings_per_independent(correlation: f64) -> f64 {
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
    let limit = reduced_chi_square_limit(freedom, NORMAL_ONE_SIDED_95);
    if excess > limit { excess } else { 1.0 }
}

/// Factor (1 at least) by which what comes back every `period_s` raises the variance of anything that is told by all periods
/// together, judged by the means of the `residuals` in each phase; 1 unless it is beyond its own 95 % limit.
///
/// What a converter of coarse steps does to a wave is the same in every period: many periods tell no more than one. `memory` is
/// the number of neighbours that are as one independent reading.
pub fn recurring_excess(
    time_s: &[f64],
    residuals: &[f64],
    period_s: f64,
    memory: f64,
    parameters: usize,
) -> f64 {
    let (Some(first_s), Some(last_s)) = (time_s.first(), time_s.last()) else {
        return 1.0;
    };
    let periods = (last_s - first_s) / period_s;
    let phases = (residuals.len() as f64 / periods).floor() as usize;
    if periods < 2.0 || phases < 2 * parameters {
        return 1.0;
    }
    let mut of_phase = vec![(0.0, 0.0); phases];
    for (t, residual) in time_s.iter().zip(residuals) {
        let phase = ((t - first_s) / period_s).fract() * phases as f64;
        let own = &mut of_phase[phase.round() as usize % phases];
        *own = (own.0 + residual, own.1 + 1.0);
    }
    let variance = sums::square(residuals) / residuals.len() as f64;
    let taken = of_phase.iter().filter(|(_, count)| *count > 0.0);
    let squares: f64 = taken.map(|(sum, count)| sum * sum / count).sum();
    let freedom = (phases - parameters) as f64;
    let excess = squares / freedom / variance;
    let limit = reduced_chi_square_limit(freedom / memory.max(1.0), NORMAL_ONE_SIDED_95);
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
    fn coefficients_alone_tell_what_a_long_sum_varies_by() {
        assert_eq!(long_run_ratio(&[]), 1.0);
        assert!((long_run_ratio(&[0.6]) - readings_per_independent(0.6)).abs() < 1e-12);
        for lags in [vec![1.0, 0.7, 0.6], vec![2.0, 0.8, 0.9, 0.1]] {
            let (coefficients, share) = yule_walker(&lags).unwrap();
            let known = HigherOrder { coefficients, share };
            let found = long_run_ratio(&known.coefficients);
            assert!((found / known.long_run_ratio() - 1.0).abs() < 1e-12, "{found}");
        }
    }

    #[test]
    fn a_second_order_is_seen_and_a_first_taken_for_no_more() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let (mut ratio, mut seen, mut falsely) = (0.0, 0, 0);
        for _ in 0..50 {
            let (mut one, mut two) = (0.0, 0.0);
            let second: Vec<f64> = (0..2000)
                .map(|_| {
                    let fresh: f64 = StandardNormal.sample(&mut rng);
                    (one, two) = (0.5 * one + 0.3 * two + fresh, one);
                    one
                })
                .collect();
            let of = |e: &[f64]| {
                let square = e.iter().map(|v| v * v).sum();
                let product = e.windows(2).map(|p| p[0] * p[1]).sum();
                HigherOrder::of(e, 5.0, &Autoregression::from_sums(square, product, 2000.0, 5.0))
            };
            if let Some(found) = of(&second) {
                seen += 1;
                ratio += found.long_run_ratio();
            }
            falsely += i32::from(of(&autoregressive(&mut rng, 2000, 0.6)).is_some());
        }
        // Share 0.91 (1 - (5/7)^2), sum of coefficients 0.8.
        let expected = 0.91 * (1.0 - 25.0 / 49.0) / 0.04;
        assert!(
            seen == 50 && (ratio / 50.0 / expected - 1.0).abs() < 0.1,
            "{seen} {}",
            ratio / 50.0
        );
        assert!(falsely <= 3, "{falsely}");
    }

    #[test]
    fn a_third_order_is_seen_with_its_coefficients() {
        const LAGS: [f64; 3] = [0.3, 0.2, 0.3];
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let mut last = [0.0; 3];
        let third: Vec<f64> = (0..20_000)
            .map(|_| {
                let fresh: f64 = StandardNormal.sample(&mut rng);
                let known: f64 = LAGS.iter().zip(last).map(|(a, value)| a * value).sum();
                last = [known + fresh, last[0], last[1]];
                last[0]
            })
            .collect();
        let first = Autoregression::from_sums(sums::square(&third), sums::lagged(&third), 20_000.0, 5.0);
        let found = HigherOrder::of(&third, 5.0, &first).unwrap();
        assert_eq!(found.coefficients.len(), 3);
        for (found, expected) in found.coefficients.iter().zip(LAGS) {
            assert!((found - expected).abs() < 0.025, "{found} in place of {expected}");
        }
    }

    #[test]
    fn what_comes_back_every_period_counts_once_and_noise_does_not() {
        let time_s: Vec<f64> = (0..600).map(f64::from).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let pattern = autoregressive(&mut rng, 60, 0.0);
        let again: Vec<f64> = (0..600).map(|k| pattern[k % 60]).collect();
        let excess = recurring_excess(&time_s, &again, 60.0, 1.0, 5);
        assert!((excess / 10.0 - 1.0).abs() < 0.15, "{excess}");
        for rho in [0.0, 0.6] {
            let mut raised = 0;
            for _ in 0..200 {
                let noise = autoregressive(&mut rng, 600, rho);
                let memory = readings_per_independent(rho);
                raised += usize::from(recurring_excess(&time_s, &noise, 60.0, memory, 1) > 1.0);
            }
            assert!(raised <= 20, "{rho}: {raised} of 200");
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
