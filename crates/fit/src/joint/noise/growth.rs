//! How noise grows with the signal.

use crate::joint::whitening::sum_of_logs;
use crate::sampled::Sampled;
use ieap_numerics::correlation::NOISE_EVIDENCE;
use ieap_numerics::sums;

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
    let peak = sums::peak(&smooth.level);
    let spread = sampled.spread();
    let even = Growth {
        scale: spread.clone(),
        per_signal: 0.0,
    };
    if n < 100.0 || peak <= 0.0 {
        return even;
    }
    let autocorrelation = smooth.autocorrelation_of_rest(sampled);
    let weighed = Weighed::of(smooth, &spread, peak);
    let (mut best, mut chosen) = (
        weighed.deviance(0.0) - (n.ln() + NOISE_EVIDENCE) * autocorrelation,
        None,
    );
    for power in -2..=12 {
        let b = 2.0_f64.powf(f64::from(power) / 2.0);
        let found = weighed.deviance(b);
        if found < best {
            (best, chosen) = (found, Some(b));
        }
    }
    let Some(b) = chosen else { return even };
    let ratio = |(level, spread): (&f64, &f64)| spread * (1.0 + (b * level / peak).powi(2)).sqrt();
    Growth {
        scale: smooth.level.iter().zip(&spread).map(ratio).collect(),
        per_signal: b / peak,
    }
}

/// Running sums, which the compiler turns into vector instructions.
const LANES: usize = 4;
/// Readings whose variances are multiplied before their logarithm is taken: the product of so many stays a number.
const MULTIPLIED: usize = 16;

/// What the smooth part leaves of every reading, for noise that grows.
struct Weighed {
    /// Squares of the rest in units of the noise at signal zero, and of the signal in units of its peak.
    squares: Vec<(f64, f64)>,
    /// Sum of the logarithms of the variances at signal zero.
    logs: f64,
}

impl Weighed {
    fn of(smooth: &Smooth, spread: &[f64], peak: f64) -> Weighed {
        let square =
            |((rest, level), spread): ((&f64, &f64), &f64)| ((rest / spread).powi(2), (level / peak).powi(2));
        let each = smooth.rest.iter().zip(&smooth.level).zip(spread);
        Weighed {
            squares: each.map(square).collect(),
            logs: 2.0 * sum_of_logs(spread.iter().copied()),
        }
    }

    /// Minus twice the log likelihood of noise of variance `1 + (b signal)^2`.
    fn deviance(&self, b: f64) -> f64 {
        let (mut squares, mut logs) = ([0.0; LANES], self.logs);
        for some in self.squares.chunks(LANES * MULTIPLIED) {
            let mut products = [1.0; LANES];
            for some in some.chunks(LANES) {
                for (lane, (rest, signal)) in some.iter().enumerate() {
                    let variance = 1.0 + b * b * signal;
                    squares[lane] += rest / variance;
                    products[lane] *= variance;
                }
            }
            logs += products.iter().map(|product| product.ln()).sum::<f64>();
        }
        let square: f64 = squares.iter().sum();
        let n = self.squares.len() as f64;
        n * (square / n).max(f64::MIN_POSITIVE).ln() + logs
    }
}
