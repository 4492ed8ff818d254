//! The noise of a channel found again in simulated residuals, and what inner products are in it.

use ieap_numerics::sums::dot;

use super::joint::noise::{Again, Noise, Products, products, white};
use super::joint::whitening::{Autocorrelation, Whitener};
use super::sampled::Sampled;
use super::whitened::Continuing;

/// Finds the noise of a channel again in simulated residuals, as a simulation of the whole procedure needs it: its size
/// and its correlation by reading order; memory of another kind is taken as it was found.
pub struct NoiseAgain {
    sampled: Sampled,
    again: Again,
    /// The stretches without a gap, and the memory that is taken as it was found.
    taken: Continuing,
}

/// A noise that was found again.
pub struct FoundAgain {
    autocorrelation: Continuing,
    /// Correlation of neighbouring readings; 0 where the memory was taken as it was found.
    rho: f64,
    /// Variance in units of that with the scale of the noise.
    variance: f64,
}

/// A series in units of the noise's scale, made white where the memory is taken as it was found.
pub struct Scaled(Vec<f64>);

/// What every noise that is found needs to know of two series, by stretches without a gap.
pub struct Pair(Vec<Products>);

impl NoiseAgain {
    /// For the readings that `noise` was found in.
    pub(super) fn of(sampled: &Sampled, noise: &Noise) -> NoiseAgain {
        let again = Again::new(sampled, noise);
        let (scale, autocorrelation) = again.taken();
        let none = Autocorrelation::Order(Vec::new());
        let taken = Continuing::new(sampled, scale, autocorrelation.unwrap_or(&none));
        NoiseAgain {
            sampled: sampled.clone(),
            taken,
            again,
        }
    }

    /// The noise that `rest`, what a fit has left in canonical units, shows.
    pub fn find(&self, rest: &[f64]) -> FoundAgain {
        self.found(self.again.find(rest))
    }

    /// The noises of channels that share one correlation, each from its `rest`.
    pub fn find_shared(all: &[(&NoiseAgain, &[f64])]) -> Vec<FoundAgain> {
        let inner: Vec<(&Again, &[f64])> = all.iter().map(|(own, rest)| (&own.again, *rest)).collect();
        match Again::find_shared(&inner) {
            Some(found) => all
                .iter()
                .zip(found)
                .map(|((own, _), found)| own.found(found))
                .collect(),
            None => all.iter().map(|(own, rest)| own.find(rest)).collect(),
        }
    }

    fn found(&self, (sd, autocorrelation): (Vec<f64>, Autocorrelation)) -> FoundAgain {
        let (scale, taken) = self.again.taken();
        let rho = match &autocorrelation {
            Autocorrelation::Order(coefficients) if taken.is_none() => {
                coefficients.first().copied().unwrap_or(0.0)
            }
            _ => 0.0,
        };
        let size = sd
            .first()
            .zip(scale.first())
            .map_or(1.0, |(sd, scale)| sd / scale);
        FoundAgain {
            autocorrelation: Continuing::new(&self.sampled, &sd, &autocorrelation),
            rho,
            variance: size * size,
        }
    }

    /// A series over the readings, in canonical units, as [`NoiseAgain::pair`] takes it.
    pub fn scaled(&self, series: &[f64]) -> Scaled {
        let mut scaled = series.to_vec();
        self.taken.whiten(&mut scaled);
        Scaled(scaled)
    }

    /// What [`FoundAgain::product`] needs to know of two series.
    pub fn pair(&self, a: &Scaled, b: &Scaled) -> Pair {
        let is_found = self.again.taken().1.is_none();
        let of_stretch = |(a, b): (&[f64], &[f64])| {
            if is_found {
                products(a, b)
            } else {
                [dot(a, b), 0.0, 0.0, 0.0]
            }
        };
        Pair(self.taken.stretches_of(&a.0, &b.0).map(of_stretch).collect())
    }
}

impl FoundAgain {
    /// Makes a series over the readings white, in standard deviations, in place.
    pub fn whiten(&self, series: &mut [f64]) {
        self.autocorrelation.whiten(series);
    }

    /// The transpose of [`FoundAgain::whiten`].
    pub fn transpose(&self, series: &mut [f64]) {
        self.autocorrelation.each(series, Whitener::transpose);
    }

    /// The inner product of two series, both made white.
    pub fn product(&self, pair: &Pair) -> f64 {
        let sum: f64 = pair.0.iter().map(|products| white(products, self.rho)).sum();
        sum / self.variance
    }
}

#[cfg(test)]
mod tests {
    use super::super::sampled::Sampled;
    use super::*;
    use ieap_domain::{Channel, Drive, Level, Quantity, Segment};

    /// Readings each second, with a gap after the two hundredth.
    fn sampled() -> Sampled {
        let time_s: Vec<f64> = (0..400).map(|k| f64::from(k + 300 * (k / 200))).collect();
        let values: Vec<f64> = (0..400).map(|k| (1.7 * f64::from(k)).sin()).collect();
        let channel = Channel::new(Quantity::Current, time_s.into(), values.into());
        let segments = vec![Segment::at(0.0, Level::Voltage(1.0))];
        let drive = Drive {
            baseline_v: 0.0,
            segments,
        };
        Sampled::new(&channel, &drive, false)
    }

    #[test]
    fn a_product_is_that_of_the_whitened_series() {
        let sampled = sampled();
        let n = sampled.len();
        let series = |rate: f64| -> Vec<f64> { (0..n).map(|k| (rate * k as f64).cos() + 0.3).collect() };
        let (a, b, rest) = (series(0.11), series(0.017), series(2.3));
        let autocorrelations = [
            Autocorrelation::Order(Vec::new()),
            Autocorrelation::Order(vec![0.6]),
            Autocorrelation::Order(vec![0.5, 0.3]),
            Autocorrelation::Time {
                correlation_time_s: 3.0,
            },
        ];
        for autocorrelation in autocorrelations {
            let noise = Noise {
                sd: (0..n).map(|k| 0.2 + 1e-3 * k as f64).collect(),
                autocorrelation,
                ..Noise::of_rest(&sampled, &vec![1.0; n], 0.0)
            };
            let again = NoiseAgain::of(&sampled, &noise);
            let found = again.find(&rest);
            let whitened = |series: &[f64]| {
                let mut series = series.to_vec();
                found.whiten(&mut series);
                series
            };
            let expected = dot(&whitened(&a), &whitened(&b));
            let own = found.product(&again.pair(&again.scaled(&a), &again.scaled(&b)));
            assert!((own - expected).abs() < 1e-9 * expected.abs(), "{own} {expected}");
        }
    }
}
