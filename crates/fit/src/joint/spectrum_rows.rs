//! An impedance spectrum of a run's strip, as further rows of its sum of squares.

use std::f64::consts::TAU;

use ieap_domain::Spectrum;
use ieap_model::LumpedModel;
use ieap_numerics::complex::Complex;

/// Readings of a spectrum, each over its standard deviation.
#[derive(Debug, Clone)]
pub(crate) struct SpectrumRows {
    /// Run of the strip.
    pub(crate) run: usize,
    area_cm2: f64,
    omega_per_s: Vec<f64>,
    /// Real parts, then imaginary ones.
    measured: Vec<f64>,
    /// One over the standard deviation of either part at each frequency, 1/Ohm.
    weight: Vec<f64>,
}

impl SpectrumRows {
    /// Of a strip of that area whose readings scatter by the part `scatter` of |Z|.
    pub(crate) fn new(run: usize, spectrum: &Spectrum, area_cm2: f64, scatter: f64) -> SpectrumRows {
        let weight: Vec<f64> = spectrum
            .magnitude_ohm()
            .iter()
            .map(|size| (size * scatter).recip())
            .collect();
        let over = |part: &[f64]| -> Vec<f64> { part.iter().zip(&weight).map(|(z, w)| z * w).collect() };
        SpectrumRows {
            run,
            area_cm2,
            omega_per_s: spectrum.frequency_hz.iter().map(|hz| TAU * hz).collect(),
            measured: [over(&spectrum.real_ohm), over(&spectrum.imaginary_ohm)].concat(),
            weight,
        }
    }

    /// Weighted residuals of a model.
    pub(crate) fn residuals(&self, model: &LumpedModel) -> Vec<f64> {
        let z: Vec<Complex> = self
            .omega_per_s
            .iter()
            .map(|&omega| impedance(model, self.area_cm2, omega))
            .collect();
        let parts = z.iter().map(|z| z.re).chain(z.iter().map(|z| z.im));
        let weights = self.weight.iter().chain(&self.weight);
        let simulated = parts.zip(weights).map(|(part, weight)| part * weight);
        self.measured
            .iter()
            .zip(simulated)
            .map(|(own, z)| own - z)
            .collect()
    }
}

/// Impedance of a strip under a small alternating voltage, Ohm.
fn impedance(model: &LumpedModel, area_cm2: f64, omega: f64) -> Complex {
    let mut admittance = Complex::new(model.steady_state_resistance_ohm_cm2.recip(), 0.0);
    for branch in &model.branches {
        let (r, c) = (branch.resistance_ohm_cm2, branch.capacitance_f_per_cm2);
        let x = omega * r * c;
        let size = omega * c / (1.0 + x * x);
        admittance = admittance + Complex::new(size * x, size);
    }
    let norm = area_cm2 * (admittance.re * admittance.re + admittance.im * admittance.im);
    Complex::new(admittance.re / norm, -admittance.im / norm)
}
