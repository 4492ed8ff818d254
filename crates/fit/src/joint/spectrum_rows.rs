//! An impedance spectrum of a run's strip, as further rows of its sum of squares.

use ieap_domain::Spectrum;
use ieap_model::LumpedModel;
use ieap_numerics::complex::Complex;

/// Readings of a spectrum, each over its standard deviation.
#[derive(Debug, Clone)]
pub(crate) struct SpectrumRows {
    /// Run of the strip.
    pub(crate) run: usize,
    area_cm2: f64,
    frequency_hz: Vec<f64>,
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
            frequency_hz: spectrum.frequency_hz.clone(),
            measured: [over(&spectrum.real_ohm), over(&spectrum.imaginary_ohm)].concat(),
            weight,
        }
    }

    /// Weighted residuals of a model.
    pub(crate) fn residuals(&self, model: &LumpedModel) -> Vec<f64> {
        let z: Vec<Complex> = self
            .frequency_hz
            .iter()
            .map(|&hz| model.admittance_a_per_v(self.area_cm2, hz).reciprocal())
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
