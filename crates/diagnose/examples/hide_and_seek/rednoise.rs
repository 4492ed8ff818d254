//! Noise as slow as a record is long.

use ieap_domain::Channel;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Waves that it is made of; the slowest goes half round in a record.
const WAVES: usize = 300;

/// Adds a Gaussian series of that standard deviation and spectrum.
pub fn add_slow(channel: &mut Channel, sd: f64, exponent: f64, generator: &mut impl Rng) {
    let last_s = channel.time_s.iter().copied().fold(0.0, f64::max);
    let powers: Vec<f64> = (1..=WAVES).map(|k| (k as f64).powf(-exponent)).collect();
    let whole: f64 = powers.iter().sum();
    let waves: Vec<(f64, f64, f64)> = powers
        .iter()
        .zip(1..)
        .map(|(power, k)| {
            let size = sd * (power / whole).sqrt();
            let (even, odd): (f64, f64) = (
                StandardNormal.sample(&mut *generator),
                StandardNormal.sample(&mut *generator),
            );
            (
                std::f64::consts::PI * f64::from(k) / last_s,
                size * even,
                size * odd,
            )
        })
        .collect();
    let slow = |t: f64| -> f64 {
        let each = waves.iter().map(|(turning, even, odd)| {
            let (sine, cosine) = (turning * t).sin_cos();
            even * cosine + odd * sine
        });
        each.sum()
    };
    let readings = channel.time_s.iter().zip(channel.values.iter());
    channel.values = readings.map(|(t, value)| value + slow(*t)).collect();
}
