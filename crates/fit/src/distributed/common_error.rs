//! What readings of several places get wrong at all times alike: an initial shape that is not quite known, a scale, what
//! smoothing along the strip takes off a bend.
//!
//! Noise averages down over the frames of a run, such errors do not. They are seen in the residuals: what these hold in
//! the first half waves over the record is more than noise with its autocorrelation gives. Between places they are taken to be
//! alike as the noise is, for both come through the same smoothing, and their size in the half waves to fall as 1/(1+m),
//! as that of things does that change with the strip's shape.

use super::policy::{FEWEST_FOR_COMMON, FEWEST_TIMES, LEAST_FREEDOM, WAVES};
use ieap_numerics::sums::{add, dot, square};

/// Rounds in which size and weights settle.
const ROUNDS: usize = 30;

/// Half waves over the record with what every series holds of them.
#[derive(Debug, Clone)]
pub(super) struct Waves {
    waves: Vec<Vec<f64>>,
    /// Of each wave, the amplitude in each series.
    amplitudes: Vec<Vec<f64>>,
}

/// Errors that all times share.
#[derive(Debug, Clone)]
pub(super) struct CommonError {
    waves: Vec<Vec<f64>>,
    /// Variance of each wave's amplitude, in variances of the noise.
    variances: Vec<f64>,
    /// Independent amplitudes that they are known from.
    pub freedom: f64,
}

impl Waves {
    /// Of series over `times` readings, one after the other; none where there are too few of either.
    pub fn of(residuals: &[f64], times: usize) -> Option<Waves> {
        if times < FEWEST_TIMES || residuals.len() < FEWEST_FOR_COMMON * times {
            return None;
        }
        let waves: Vec<Vec<f64>> = (0..WAVES).map(|m| wave(m, times)).collect();
        let amplitude = |wave: &Vec<f64>| residuals.chunks_exact(times).map(|row| dot(row, wave)).collect();
        Some(Waves {
            amplitudes: waves.iter().map(amplitude).collect(),
            waves,
        })
    }

    /// The series less their waves.
    pub fn taken_off(&self, residuals: &[f64]) -> Vec<f64> {
        let mut rest = residuals.to_vec();
        for (wave, amplitudes) in self.waves.iter().zip(&self.amplitudes) {
            for (row, amplitude) in rest.chunks_exact_mut(wave.len()).zip(amplitudes) {
                add(row, -amplitude, wave);
            }
        }
        rest
    }

    /// Waves that were taken off every series.
    pub fn count(&self) -> usize {
        self.waves.len()
    }

    /// The errors beyond noise of that variance in each place, its autocorrelation and the number of places that are
    /// independent in it; the fit has taken `parameters` amplitudes. None where nothing is beyond noise, or too little
    /// is known of it.
    pub fn beyond(
        &self,
        variances: &[f64],
        autocorrelation: f64,
        places: f64,
        parameters: f64,
    ) -> Option<CommonError> {
        let total: f64 = variances.iter().sum();
        let times = self.waves[0].len() as f64;
        let size = |m: usize| (1.0 + m as f64).powi(-2);
        let (sum, squares) = (0..WAVES).fold((0.0, 0.0), |(sum, squares), m| {
            (sum + size(m), squares + size(m) * size(m))
        });
        let all = places * sum * sum / squares;
        let freedom = all - parameters;
        if freedom < LEAST_FREEDOM || total <= 0.0 {
            return None;
        }
        let noise = |m: usize| {
            let angle = std::f64::consts::PI * m as f64 / times;
            (1.0 - autocorrelation * autocorrelation)
                / (1.0 - 2.0 * autocorrelation * angle.cos() + autocorrelation * autocorrelation)
        };
        // What the fit has taken is a small part of the noise in all waves, and a larger one of what few waves hold.
        let kept = (1.0 - parameters / (WAVES as f64 * places)).max(0.5);
        let power: Vec<f64> = self.amplitudes.iter().map(|a| square(a) / total).collect();
        let mut variance = 0.0;
        for _ in 0..ROUNDS {
            let (mut cross, mut own) = (0.0, 0.0);
            for (m, power) in power.iter().enumerate() {
                let weight = size(m) / (noise(m) + variance * size(m)).powi(2);
                cross += weight * (power - kept * noise(m)) * all / freedom;
                own += weight * size(m);
            }
            variance = (cross / own).max(0.0);
        }
        (variance > 0.0).then(|| CommonError {
            waves: self.waves.clone(),
            variances: (0..WAVES).map(|m| variance * size(m)).collect(),
            freedom,
        })
    }
}

impl CommonError {
    /// The covariance times a column, but for what is between places: that is to be done to the result.
    pub fn in_time(&self, column: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; column.len()];
        let times = self.waves[0].len();
        for (wave, variance) in self.waves.iter().zip(&self.variances) {
            for (out, row) in product.chunks_exact_mut(times).zip(column.chunks_exact(times)) {
                add(out, variance * dot(row, wave), wave);
            }
        }
        product
    }
}

/// The half wave of that order over so many readings, its sum of squares one.
fn wave(order: usize, times: usize) -> Vec<f64> {
    let size = if order == 0 { 1.0 } else { 2.0f64 } / times as f64;
    let step = std::f64::consts::PI * order as f64 / times as f64;
    (0..times)
        .map(|k| size.sqrt() * (step * (k as f64 + 0.5)).cos())
        .collect()
}
