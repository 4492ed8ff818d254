//! A wave of known phase beside a slow trend, by least squares, and how well it is known.

use super::complex::Complex;
use super::linear::LeastSquares;
use super::student::quantile_95;
use super::sums;

/// A wave `Re(amplitude e^(j phase))`: one that comes later has the smaller angle.
#[derive(Debug, Clone, PartialEq)]
pub struct Harmonic {
    /// Complex amplitude: `a - j b` for a wave `a cos(phase) + b sin(phase)`.
    pub amplitude: Complex,
    /// Half-width of the 95 % interval of either part, correlated residuals allowed for.
    pub half_95: f64,
    /// What wave and trend leave.
    pub residuals: Vec<f64>,
}

impl Harmonic {
    /// Root mean square of what is left.
    pub fn residual_rms(&self) -> f64 {
        (sums::square(&self.residuals) / self.residuals.len().max(1) as f64).sqrt()
    }
}

/// The wave with those phases (radians) in `values`, beside a polynomial in time of that degree; none where the readings
/// do not tell them apart.
pub fn harmonic(phase: &[f64], time_s: &[f64], values: &[f64], degree: usize) -> Option<Harmonic> {
    let count = values.len();
    let terms = degree + 3;
    if count < terms + 2 {
        return None;
    }
    let (first_s, last_s) = (*time_s.first()?, *time_s.last()?);
    let place = |t: f64| (2.0 * t - first_s - last_s) / (last_s - first_s);
    let powers = (0..=degree as i32).map(|power| time_s.iter().map(|t| place(*t).powi(power)).collect());
    let columns = [f64::cos, f64::sin]
        .into_iter()
        .map(|wave| phase.iter().map(|phase| wave(*phase)).collect())
        .chain(powers)
        .collect();
    let fit = LeastSquares::of(columns, values)?;
    let noise = fit.noise();
    let variance = noise.long_run_variance().max(noise.variance);
    let own = fit.inverse_diagonal(0).max(fit.inverse_diagonal(1));
    let freedom = noise.effective_readings(count as f64) - terms as f64;
    Some(Harmonic {
        amplitude: Complex::new(fit.coefficients[0], -fit.coefficients[1]),
        half_95: quantile_95(freedom.max(2.0)) * (variance * own).sqrt(),
        residuals: fit.residuals,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_wave_is_found_beside_a_trend() {
        let time_s: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.1).collect();
        let phase: Vec<f64> = time_s.iter().map(|t| TAU * 0.2 * t).collect();
        let wave = |(t, phase): (&f64, &f64)| 3.0 * phase.cos() - 4.0 * phase.sin() + 1.0 + 0.02 * t * t;
        let values: Vec<f64> = time_s.iter().zip(&phase).map(wave).collect();
        let found = harmonic(&phase, &time_s, &values, 2).unwrap();
        assert!((found.amplitude - Complex::new(3.0, 4.0)).magnitude() < 1e-9);
        assert!(found.half_95 < 1e-6 && found.residual_rms() < 1e-9);
        assert_eq!(harmonic(&phase[..5], &time_s[..5], &values[..5], 2), None);
    }
}
