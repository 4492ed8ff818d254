//! How noise grows with the signal.

use crate::sampled::Sampled;
use ieap_numerics::correlation::NOISE_EVIDENCE;

use super::smooth::Smooth;

/// How the noise grows with the signal.
pub(super) struct Growth {
    /// Standard deviation of every reading in units of that at signal zero.
    pub(super) scale: Vec<f64>,
    pub(super) per_signal: f64,
}

/// Even noise unless the likelihood asks for `sqrt(1 + (b signal)^2)`.
pub(super) fn growth(smooth: &Smooth, sampled: &Sampled) -> Growth {
    let n = sampled.len() as f64;
    let peak = smooth.level.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let spread = sampled.spread();
    let even = Growth {
        scale: spread.clone(),
        per_signal: 0.0,
    };
    if n < 100.0 || peak <= 0.0 {
        return even;
    }
    let scale = |b: f64| -> Vec<f64> {
        let ratio = |(level, spread): (&f64, &f64)| spread * (1.0 + (b * level / peak).powi(2)).sqrt();
        smooth.level.iter().zip(&spread).map(ratio).collect()
    };
    let deviance = |scale: &[f64]| {
        let square: f64 = smooth.rest.iter().zip(scale).map(|(r, s)| (r / s).powi(2)).sum();
        n * (square / n).max(f64::MIN_POSITIVE).ln() + scale.iter().map(|s| 2.0 * s.ln()).sum::<f64>()
    };
    let autocorrelation = smooth.autocorrelation_of_rest(sampled);
    let (mut best, mut chosen) = (
        deviance(&even.scale) - (n.ln() + NOISE_EVIDENCE) * autocorrelation,
        even,
    );
    for power in -2..=12 {
        let b = 2.0_f64.powf(f64::from(power) / 2.0);
        let scale = scale(b);
        let found = deviance(&scale);
        if found < best {
            best = found;
            chosen = Growth {
                scale,
                per_signal: b / peak,
            };
        }
    }
    chosen
}
