//! Noise of simulated readings: seeded, the same numbers on every machine.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

use super::HiddenEffect;

/// Which channel the noise is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoisyChannel {
    /// Current.
    Current,
    /// Curvature.
    Curvature,
}

/// Noise of one channel. Zeros: none of that kind.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ChannelNoise {
    /// Standard deviation s_0 where there is no signal, unit of the channel.
    pub standard_deviation: f64,
    /// Lag-1 autocorrelation from reading to reading, 0 to below 1.
    pub autocorrelation: f64,
    /// c of `sigma^2 = s_0^2 + (c y)^2`.
    pub proportional: f64,
    /// Smallest step that the converter knows, unit of the channel.
    pub step: f64,
    /// Share of the readings that are outliers.
    pub outlier_fraction: f64,
    /// Distance of an outlier from where it belongs, in standard deviations; either sign alike.
    pub outlier_size_sigma: f64,
}

impl ChannelNoise {
    /// The noise with the effects `outliers` and `uneven-noise` (of both channels) and `quantisation` (of the channel
    /// that its variant names); other effects are signal and change nothing here.
    pub fn with_effects(mut self, channel: NoisyChannel, effects: &[HiddenEffect]) -> ChannelNoise {
        let own = match channel {
            NoisyChannel::Current => "current",
            NoisyChannel::Curvature => "curvature",
        };
        for effect in effects {
            match effect.id.as_str() {
                "outliers" => {
                    self.outlier_fraction = effect.value("fraction");
                    self.outlier_size_sigma = effect.value("size_sigma");
                }
                "uneven-noise" => self.proportional = effect.value("proportional"),
                "quantisation" if effect.is(own) => self.step = effect.value("step"),
                _ => {}
            }
        }
        self
    }

    fn sigma(&self, signal: f64) -> f64 {
        if self.proportional == 0.0 {
            self.standard_deviation
        } else {
            self.standard_deviation.hypot(self.proportional * signal)
        }
    }
}

/// `signal` as a channel with that noise reads it: first-order autoregressive Gaussian noise, outliers, and rounding
/// to the converter's step, in this order. `seed` and `stream` (one per channel and run) fix the noise; outliers are
/// drawn apart, so that they leave the rest as it was.
pub fn noise(signal: &[f64], noise: &ChannelNoise, seed: u64, stream: u64) -> Vec<f64> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(stream);
    let fresh = (1.0 - noise.autocorrelation * noise.autocorrelation).sqrt();
    let mut last: f64 = StandardNormal.sample(&mut generator);
    let mut readings: Vec<f64> = signal
        .iter()
        .map(|value| {
            let error = noise.sigma(*value) * last;
            let next: f64 = StandardNormal.sample(&mut generator);
            last = noise.autocorrelation * last + fresh * next;
            value + error
        })
        .collect();
    if noise.outlier_fraction > 0.0 {
        add_outliers(&mut readings, signal, noise, seed, stream);
    }
    if noise.step > 0.0 {
        for reading in &mut readings {
            *reading = (*reading / noise.step).round() * noise.step;
        }
    }
    readings
}

fn add_outliers(readings: &mut [f64], signal: &[f64], noise: &ChannelNoise, seed: u64, stream: u64) {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(stream | 1 << 63);
    for (reading, value) in readings.iter_mut().zip(signal) {
        let drawn: f64 = StandardUniform.sample(&mut generator);
        let side: f64 = StandardUniform.sample(&mut generator);
        if drawn < noise.outlier_fraction {
            *reading += noise.outlier_size_sigma * noise.sigma(*value) * (side - 0.5).signum();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(kind: &ChannelNoise, level: f64) -> Vec<f64> {
        let signal = vec![level; 20_000];
        noise(&signal, kind, 5, 2)
            .iter()
            .map(|reading| reading - level)
            .collect()
    }

    fn spread(values: &[f64]) -> f64 {
        (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
    }

    const WHITE: ChannelNoise = ChannelNoise {
        standard_deviation: 0.1,
        autocorrelation: 0.0,
        proportional: 0.0,
        step: 0.0,
        outlier_fraction: 0.0,
        outlier_size_sigma: 0.0,
    };

    #[test]
    fn noise_is_seeded_and_each_stream_its_own() {
        let signal = [0.0; 50];
        assert_eq!(noise(&signal, &WHITE, 1, 0), noise(&signal, &WHITE, 1, 0));
        assert_ne!(noise(&signal, &WHITE, 1, 0), noise(&signal, &WHITE, 1, 1));
        assert_ne!(noise(&signal, &WHITE, 1, 0), noise(&signal, &WHITE, 2, 0));
    }

    #[test]
    fn noise_has_the_size_and_the_correlation_asked_for() {
        let correlated = ChannelNoise {
            autocorrelation: 0.6,
            ..WHITE
        };
        let found = errors(&correlated, 3.0);
        let lagged: f64 = found.windows(2).map(|pair| pair[0] * pair[1]).sum();
        let square: f64 = found.iter().map(|v| v * v).sum();
        assert!((spread(&found) / 0.1 - 1.0).abs() < 0.03);
        assert!((lagged / square - 0.6).abs() < 0.02);
    }

    #[test]
    fn noise_grows_with_the_signal() {
        let uneven = ChannelNoise {
            proportional: 0.05,
            ..WHITE
        };
        assert!((spread(&errors(&uneven, 0.0)) / 0.1 - 1.0).abs() < 0.03);
        assert!((spread(&errors(&uneven, -4.0)) / 0.05_f64.sqrt() - 1.0).abs() < 0.03);
    }

    #[test]
    fn outliers_leave_the_other_readings_as_they_were() {
        let spoiled = ChannelNoise {
            outlier_fraction: 0.01,
            outlier_size_sigma: 20.0,
            ..WHITE
        };
        let (clean, found) = (errors(&WHITE, 0.0), errors(&spoiled, 0.0));
        let moved: Vec<f64> = clean
            .iter()
            .zip(&found)
            .map(|(a, b)| b - a)
            .filter(|v| *v != 0.0)
            .collect();
        assert!((150..250).contains(&moved.len()), "{}", moved.len());
        assert!(moved.iter().all(|v| (v.abs() - 2.0).abs() < 1e-12));
        let up = moved.iter().filter(|v| **v > 0.0).count();
        assert!((60..moved.len() - 60).contains(&up));
    }

    #[test]
    fn readings_stand_on_the_steps_of_the_converter() {
        let coarse = ChannelNoise { step: 0.25, ..WHITE };
        let readings = noise(&[0.3; 100], &coarse, 1, 0);
        assert!(readings.iter().all(|r| (r / 0.25).fract() == 0.0));
    }
}
