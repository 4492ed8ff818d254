//! A wave of known phase beside a slow trend, by least squares, and how well it is known.

use super::complex::Complex;
use super::correlation::Autoregression;
use super::student::quantile_95;
use super::sums;
use super::symmetric::Symmetric;

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
    let row = |k: usize| -> Vec<f64> {
        let x = place(time_s[k]);
        let powers = (0..=degree).map(|power| x.powi(power as i32));
        [phase[k].cos(), phase[k].sin()]
            .into_iter()
            .chain(powers)
            .collect()
    };
    let rows: Vec<Vec<f64>> = (0..count).map(row).collect();
    let normal = Symmetric::from_fn(terms, |a, b| rows.iter().map(|row| row[a] * row[b]).sum());
    let factor = normal.cholesky(1e-12)?;
    let right: Vec<f64> = (0..terms)
        .map(|a| rows.iter().zip(values).map(|(row, value)| row[a] * value).sum())
        .collect();
    let solved = factor.solve(&right);
    let left = |(row, value): (&Vec<f64>, &f64)| value - sums::dot(row, &solved);
    let residuals: Vec<f64> = rows.iter().zip(values).map(left).collect();
    let noise = Autoregression::of(&residuals, terms);
    let variance = noise.long_run_variance().max(noise.variance);
    let inverse = |k: usize| {
        let unit: Vec<f64> = (0..terms).map(|a| f64::from(u8::from(a == k))).collect();
        factor.solve(&unit)[k]
    };
    let freedom = noise.effective_readings(count as f64) - terms as f64;
    Some(Harmonic {
        amplitude: Complex::new(solved[0], -solved[1]),
        half_95: quantile_95(freedom.max(2.0)) * (variance * inverse(0).max(inverse(1))).sqrt(),
        residuals,
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
