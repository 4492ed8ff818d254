//! Noise of the series of a group as residuals show it: its autocorrelation in time, and what places have in common.
//!
//! The covariance is that between places times that in time: neighbouring joints of a traced strip share their noise,
//! and what the model gets wrong at all places at once is shared as well. A sum over many series is then known no
//! better than the few that are independent among them.

use super::common_error::{CommonError, Waves};
use super::policy::{FEWEST_FOR_SIZE, LEAST_SIZE, SIZE_PARTS};
use ieap_numerics::correlation::{Autoregression, readings_per_independent, slow_excess};
use ieap_numerics::sums::{add, dot, lagged, square};

/// Covariance of the residuals of one group, in units of the noise of each series.
#[derive(Debug, Clone)]
pub(super) struct ResidualNoise {
    times: usize,
    /// Size of the noise at each time over that of all times: instruments are noisier where they read more, and what a
    /// tracer rounds off is more while a strip bends.
    size: Vec<f64>,
    /// Lag-1 correlation by order of reading.
    autocorrelation: f64,
    /// Covariance between places at one time.
    between: Vec<Vec<f64>>,
    /// Factor by which slow misfit makes long sums vary more than that.
    slow: f64,
    /// What all times have in common beyond that.
    common: Option<CommonError>,
}

impl ResidualNoise {
    /// From `residuals`, one series of `times` readings after the other, left by a fit that took `terms` smooth terms
    /// out of each series on the average.
    pub fn of(residuals: &[f64], times: usize, terms: f64) -> ResidualNoise {
        let size = size_over_time(residuals, times);
        let even: Vec<f64> = over(residuals, &size);
        let without = || ResidualNoise::without_common(&even, times, terms);
        let found = match Waves::of(&even, times) {
            None => without(),
            Some(waves) => {
                let taken = waves.count() as f64;
                let fast = ResidualNoise::without_common(&waves.taken_off(&even), times, taken);
                let variances: Vec<f64> = (0..fast.between.len()).map(|k| fast.between[k][k]).collect();
                let parameters = terms * variances.len() as f64;
                match waves.beyond(
                    &variances,
                    fast.autocorrelation,
                    fast.independent_places(),
                    parameters,
                ) {
                    None => without(),
                    common => ResidualNoise { common, ..fast },
                }
            }
        };
        ResidualNoise { size, ..found }
    }

    fn without_common(residuals: &[f64], times: usize, terms: f64) -> ResidualNoise {
        let series: Vec<&[f64]> = residuals.chunks_exact(times.max(1)).collect();
        let sums = series.iter().fold((0.0, 0.0), |(squares, products), row| {
            (squares + square(row), products + lagged(row))
        });
        let count = series.len().max(1) as f64;
        let readings = times as f64;
        let found = Autoregression::from_sums(sums.0 / count, sums.1 / count, readings, terms);
        let autocorrelation = found.correlation.max(0.0);
        // What the smooth terms took out of every series is put back into all covariances alike.
        let raw = sums.0 / count / readings.max(1.0);
        let restored = if raw > 0.0 { found.variance / raw } else { 1.0 };
        let covariance = |a: &[f64], b: &[f64]| dot(a, b) / readings.max(1.0) * restored;
        let between = series
            .iter()
            .map(|a| series.iter().map(|b| covariance(a, b)).collect())
            .collect();
        let long_run = readings_per_independent(autocorrelation);
        let terms = terms.ceil().max(1.0) as usize;
        let excess = series
            .iter()
            .map(|row| slow_excess(row, covariance(row, row) * long_run, terms));
        ResidualNoise {
            times,
            size: vec![1.0; times],
            autocorrelation,
            between,
            slow: excess.sum::<f64>() / count,
            common: None,
        }
    }

    /// The covariance times `column`, which holds one series after the other.
    pub fn times(&self, column: &[f64]) -> Vec<f64> {
        let column = by(column, &self.size);
        let mut remembered: Vec<f64> = column
            .chunks_exact(self.times)
            .flat_map(|row| self.in_time(row))
            .map(|value| value * self.slow)
            .collect();
        if let Some(common) = &self.common {
            let more = common.in_time(&column);
            add(&mut remembered, 1.0, &more);
        }
        by(&self.between_places(&remembered), &self.size)
    }

    /// The part of the covariance that all times have in common, times `column`, and the independent readings that it is
    /// known from; none where there is no such part.
    pub fn common(&self, column: &[f64]) -> Option<(Vec<f64>, f64)> {
        let common = self.common.as_ref()?;
        let remembered = common.in_time(&by(column, &self.size));
        Some((by(&self.between_places(&remembered), &self.size), common.freedom))
    }

    fn between_places(&self, remembered: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; remembered.len()];
        for (out, weights) in product.chunks_exact_mut(self.times).zip(&self.between) {
            for (row, weight) in remembered.chunks_exact(self.times).zip(weights) {
                add(out, *weight, row);
            }
        }
        product
    }

    /// The correlation in time times a series: `SUM_u rho^|t-u| x_u`, by one pass each way.
    fn in_time(&self, row: &[f64]) -> Vec<f64> {
        let mut product = row.to_vec();
        let mut carried = 0.0;
        for (out, value) in product.iter_mut().zip(row) {
            *out += carried;
            carried = self.autocorrelation * (carried + value);
        }
        carried = 0.0;
        for (out, value) in product.iter_mut().zip(row).rev() {
            *out += carried;
            carried = self.autocorrelation * (carried + value);
        }
        product
    }

    /// Independent readings that the group is worth, what all times have in common aside.
    pub fn independent_readings(&self) -> f64 {
        let long_run = readings_per_independent(self.autocorrelation) * self.slow;
        self.times as f64 * self.independent_places() / long_run
    }

    /// Places that vary independently of each other.
    pub fn independent_places(&self) -> f64 {
        let places = self.between.len();
        let trace: f64 = (0..places).map(|k| self.between[k][k]).sum();
        let squares: f64 = self.between.iter().map(|row| square(row)).sum();
        if squares > 0.0 {
            trace * trace / squares
        } else {
            places as f64
        }
    }
}

/// Root mean square of the residuals of all series about each time, over that of all times.
fn size_over_time(residuals: &[f64], times: usize) -> Vec<f64> {
    let mut sums = vec![0.0; times + 1];
    for row in residuals.chunks_exact(times.max(1)) {
        row.iter()
            .enumerate()
            .for_each(|(k, value)| sums[k + 1] += value * value);
    }
    (0..times).for_each(|k| sums[k + 1] += sums[k]);
    let mean = sums[times] / times.max(1) as f64;
    if mean <= 0.0 {
        return vec![1.0; times];
    }
    let reach = (times / SIZE_PARTS).max(FEWEST_FOR_SIZE);
    let about = |k: usize| {
        let (from, to) = (k.saturating_sub(reach), (k + reach + 1).min(times));
        (sums[to] - sums[from]) / (to - from) as f64
    };
    (0..times)
        .map(|k| (about(k) / mean).max(LEAST_SIZE).sqrt())
        .collect()
}

/// Every series times `size`.
fn by(column: &[f64], size: &[f64]) -> Vec<f64> {
    column
        .chunks_exact(size.len().max(1))
        .flat_map(|row| row.iter().zip(size).map(|(value, size)| value * size))
        .collect()
}

/// Every series over `size`.
fn over(column: &[f64], size: &[f64]) -> Vec<f64> {
    column
        .chunks_exact(size.len().max(1))
        .flat_map(|row| row.iter().zip(size).map(|(value, size)| value / size))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// Series with an autocorrelation in time and a part that all have in common.
    fn draw(
        places: usize,
        times: usize,
        autocorrelation: f64,
        common: f64,
        random: &mut ChaCha8Rng,
    ) -> Vec<f64> {
        let mut series = |share: f64| -> Vec<f64> {
            let mut last: f64 = StandardNormal.sample(random);
            let mut next = || {
                let fresh: f64 = StandardNormal.sample(random);
                last = autocorrelation * last + (1.0 - autocorrelation * autocorrelation).sqrt() * fresh;
                share * last
            };
            (0..times).map(|_| next()).collect()
        };
        let shared = series(common.sqrt());
        let mut own = || series((1.0 - common).sqrt());
        (0..places)
            .flat_map(|_| own().iter().zip(&shared).map(|(a, b)| a + b).collect::<Vec<_>>())
            .collect()
    }

    #[test]
    fn variance_of_sums_is_that_of_draws() {
        let (places, times) = (6, 300);
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let slope: Vec<f64> = (0..places * times)
            .map(|k| ((k % times) as f64 / 40.0).sin() + (k / times) as f64 * 0.2)
            .collect();
        for (autocorrelation, common) in [(0.0, 0.0), (0.7, 0.0), (0.7, 0.5)] {
            let (mut stated, mut made) = (0.0, 0.0);
            for _ in 0..200 {
                let noise = draw(places, times, autocorrelation, common, &mut random);
                made += dot(&slope, &noise).powi(2) / 200.0;
                let found = ResidualNoise::of(&noise, times, 0.0);
                stated += dot(&slope, &found.times(&slope)) / 200.0;
            }
            let ratio = stated / made;
            assert!(
                (0.75..1.3).contains(&ratio),
                "{autocorrelation} {common}: {ratio}"
            );
        }
    }

    #[test]
    fn what_all_times_share_does_not_average_down() {
        let (places, times) = (12, 200);
        let mut random = ChaCha8Rng::seed_from_u64(9);
        let slope: Vec<f64> = (0..places * times)
            .map(|k| 1.0 + (k / times) as f64 * 0.1 + (k % times) as f64 / 300.0)
            .collect();
        for share in [0.0, 0.3, 1.0] {
            let (mut stated, mut made, mut plain) = (0.0, 0.0, 0.0);
            for _ in 0..200 {
                let mut noise = draw(places, times, 0.3, 0.0, &mut random);
                for row in noise.chunks_exact_mut(times) {
                    for wave in 0..6 {
                        let drawn: f64 = StandardNormal.sample(&mut random);
                        let size = share * drawn / (1.0 + wave as f64);
                        let step = std::f64::consts::PI * wave as f64 / times as f64;
                        let root = if wave == 0 { 1.0 } else { 2.0f64.sqrt() };
                        row.iter_mut().enumerate().for_each(|(k, value)| {
                            *value += size * root * (step * (k as f64 + 0.5)).cos();
                        });
                    }
                }
                made += dot(&slope, &noise).powi(2) / 200.0;
                let found = ResidualNoise::of(&noise, times, 0.0);
                stated += dot(&slope, &found.times(&slope)) / 200.0;
                let noise_alone = ResidualNoise {
                    common: None,
                    ..found
                };
                plain += dot(&slope, &noise_alone.times(&slope)) / 200.0;
            }
            let ratio = stated / made;
            assert!((0.75..1.6).contains(&ratio), "{share}: {ratio}");
            // Noise with autocorrelation alone would be far too sure.
            assert!(share < 1.0 || plain < 0.2 * made, "{share}: {}", plain / made);
        }
    }

    #[test]
    fn noise_that_changes_over_the_record_counts_where_it_is() {
        let times = 300;
        let mut random = ChaCha8Rng::seed_from_u64(10);
        let slope: Vec<f64> = (0..times).map(|k| (-(k as f64) / 20.0).exp()).collect();
        let (mut stated, mut made) = (0.0, 0.0);
        for _ in 0..400 {
            let mut noise = draw(1, times, 0.0, 0.0, &mut random);
            noise.iter_mut().take(60).for_each(|value| *value *= 4.0);
            made += dot(&slope, &noise).powi(2) / 400.0;
            let found = ResidualNoise::of(&noise, times, 0.0);
            stated += dot(&slope, &found.times(&slope)) / 400.0;
        }
        let ratio = stated / made;
        assert!((0.75..1.3).contains(&ratio), "{ratio}");
    }

    #[test]
    fn shared_noise_is_worth_fewer_readings() {
        let mut random = ChaCha8Rng::seed_from_u64(8);
        let worth = |autocorrelation, common, random: &mut ChaCha8Rng| {
            ResidualNoise::of(&draw(8, 400, autocorrelation, common, random), 400, 2.0).independent_readings()
        };
        let (free, shared, slow) = (
            worth(0.0, 0.0, &mut random),
            worth(0.0, 0.9, &mut random),
            worth(0.8, 0.0, &mut random),
        );
        assert!(free > 2500.0, "{free}");
        assert!(shared < 700.0, "{shared}");
        assert!(slow < 600.0, "{slow}");
    }
}
