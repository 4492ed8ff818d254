//! Impedance spectra: what was measured, whether it can be an impedance at all, and which circuits describe it.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::fit::by_key;
use super::{Channel, Estimate, Issue, Parameter, Quantity, RunRecord};

/// Fewest frequencies that a spectrum is analysed with: the circuit of the thesis's figure 8 has five parameters.
pub const FEWEST_FREQUENCIES: usize = 8;

/// One sweep over frequency; the arrays are of equal length, in the order of measurement.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Spectrum {
    /// Frequency, Hz, positive.
    pub frequency_hz: Vec<f64>,
    /// Real part, Ohm.
    pub real_ohm: Vec<f64>,
    /// Imaginary part, Ohm: negative where it is capacitive.
    pub imaginary_ohm: Vec<f64>,
}

impl Spectrum {
    /// The sweeps that the channels of a run hold: one, or one for each time that the frequencies turn and begin
    /// anew. Empty where the channels hold no spectrum. Readings that are zero, or have no frequency, are left out.
    pub fn of(channels: &[Channel]) -> Vec<Spectrum> {
        let find = |quantity| channels.iter().find(|channel| channel.is_whole(quantity));
        let Some(frequency) = find(Quantity::Frequency) else {
            return Vec::new();
        };
        let cartesian = find(Quantity::ImpedanceReal).zip(find(Quantity::ImpedanceImaginary));
        let polar = || find(Quantity::ImpedanceMagnitude).zip(find(Quantity::ImpedancePhase));
        let Some((first, second)) = cartesian.or_else(polar) else {
            return Vec::new();
        };
        let mut readings = Vec::new();
        for (time, &hz) in frequency.time_s.iter().zip(frequency.values.iter()) {
            let (Some(a), Some(b)) = (at(first, *time), at(second, *time)) else {
                continue;
            };
            let (real, imaginary) = match cartesian {
                Some(_) => (a, b),
                None => (a * b.to_radians().cos(), a * b.to_radians().sin()),
            };
            if hz > 0.0 && (real != 0.0 || imaginary != 0.0) {
                readings.push((hz, real, imaginary));
            }
        }
        sweeps(&readings)
    }

    /// Number of frequencies.
    pub fn len(&self) -> usize {
        self.frequency_hz.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.frequency_hz.is_empty()
    }

    /// Magnitude at each frequency, Ohm.
    pub fn magnitude_ohm(&self) -> Vec<f64> {
        let parts = self.real_ohm.iter().zip(&self.imaginary_ohm);
        parts.map(|(real, imaginary)| real.hypot(*imaginary)).collect()
    }

    /// Lowest and highest frequency, Hz.
    pub fn range_hz(&self) -> Option<(f64, f64)> {
        (!self.is_empty()).then(|| super::range_of(self.frequency_hz.iter().copied()))
    }

    fn push(&mut self, (hz, real, imaginary): (f64, f64, f64)) {
        self.frequency_hz.push(hz);
        self.real_ohm.push(real);
        self.imaginary_ohm.push(imaginary);
    }
}

/// The reading of a channel at that time.
fn at(channel: &Channel, time_s: f64) -> Option<f64> {
    let index = channel.time_s.binary_search_by(|t| t.total_cmp(&time_s)).ok()?;
    Some(channel.values[index])
}

/// A new sweep begins where the frequency goes back against the direction of the sweep.
fn sweeps(readings: &[(f64, f64, f64)]) -> Vec<Spectrum> {
    let mut all: Vec<Spectrum> = Vec::new();
    let mut direction = 0.0;
    let mut last = f64::NAN;
    for &reading in readings {
        let step = reading.0 - last;
        let turns = direction != 0.0 && step * direction < 0.0;
        if all.is_empty() || turns {
            all.push(Spectrum::default());
            direction = 0.0;
        } else if direction == 0.0 && step != 0.0 {
            direction = step.signum();
        }
        last = reading.0;
        if let Some(sweep) = all.last_mut() {
            sweep.push(reading);
        }
    }
    all
}

/// Whether a spectrum can be the impedance of something linear, causal and unchanging.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Consistency {
    /// Nothing beyond the scatter and the size that matters.
    Consistent,
    /// Some frequencies are off, beyond both.
    Violated,
    /// Too few frequencies to tell.
    NotTested,
}

/// The linear Kramers-Kronig test of a spectrum.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct KramersKronig {
    /// The verdict.
    pub verdict: Consistency,
    /// Number of Voigt elements (R parallel to C) that the test took.
    pub elements: usize,
    /// Share of negative resistances among them that stopped the search: 1 - SUM|R < 0| / SUM|R >= 0|.
    pub mu: f64,
    /// Scatter of the readings between neighbouring frequencies, percent of |Z|.
    pub scatter_percent: f64,
    /// Root mean square of all residuals, percent of |Z|.
    pub residual_rms_percent: f64,
    /// Lowest and highest frequency of the readings that are off, Hz.
    pub off_hz: Option<(f64, f64)>,
    /// Largest mean over neighbouring residuals, percent of |Z|.
    pub largest_mean_percent: f64,
    /// Residual of the real part over |Z|, in the order of the spectrum.
    pub residual_real: Vec<f64>,
    /// The same of the imaginary part.
    pub residual_imaginary: Vec<f64>,
}

/// The modulus against that which the phase gives (Z-HIT).
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ZHit {
    /// Whether the modulus of the lowest frequencies lies further from what the phase gives than noise and the method's own
    /// error explain.
    pub drifts: bool,
    /// Mean over the lowest frequencies by which |Z| lies above what the phase gives, percent.
    pub lowest_percent: f64,
    /// The mean that noise and the method's own error explain, percent.
    pub limit_percent: f64,
    /// The lowest frequencies, from and to, Hz.
    pub lowest_hz: (f64, f64),
    /// Logarithm of |Z| over what the phase gives, in the order of the spectrum.
    pub deviation: Vec<f64>,
}

/// A maximum of the distribution of relaxation times.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct RelaxationPeak {
    /// Its time constant, s.
    pub tau_s: f64,
    /// Resistance between the least values on either side, Ohm.
    pub resistance_ohm: f64,
    /// The least value before it, s.
    pub from_s: f64,
    /// The least value behind it, s.
    pub to_s: f64,
}

/// The distribution of relaxation times of a spectrum, gamma(ln tau).
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RelaxationTimes {
    /// Strength of the regularisation, lambda.
    pub regularisation: f64,
    /// Scatter of the readings that it is chosen by, percent of |Z|.
    pub scatter_percent: f64,
    /// What the distribution leaves, root mean square, percent of |Z|.
    pub residual_rms_percent: f64,
    /// Whether that is no more than the spectrum's own scatter explains.
    pub describes: bool,
    /// Shortest and longest time constant that the frequencies tell of, s.
    pub told_s: (f64, f64),
    /// Resistance in series, Ohm: whatever is faster still.
    pub series_ohm: f64,
    /// Inductance in series, H.
    pub series_h: f64,
    /// Capacitance in series, F; none where direct current flows.
    pub series_f: Option<f64>,
    /// Resistance of what is faster than the frequencies tell of, Ohm.
    pub faster_ohm: f64,
    /// Resistance of what is slower, Ohm.
    pub slower_ohm: f64,
    /// Its maxima, from the fastest.
    pub peaks: Vec<RelaxationPeak>,
    /// Time constants, s.
    pub tau_s: Vec<f64>,
    /// The distribution at each, Ohm for a unit of the natural logarithm.
    pub gamma_ohm: Vec<f64>,
}

/// A circuit fitted to a spectrum.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CircuitFit {
    /// Id of the circuit, `lumped-2`, or the circuit as a text, `R0-p(R1,CPE1)`.
    pub circuit: String,
    /// Its parameters in the circuit's order, derived ones last; in Ohm and F of the whole sample.
    #[serde(serialize_with = "by_key")]
    #[schemars(with = "BTreeMap<String, Estimate>")]
    pub parameters: Vec<Parameter>,
    /// Root mean square of real and imaginary residual, percent of |Z|.
    pub residual_rms_percent: f64,
    /// Bayesian information criterion above that of the best circuit.
    pub bic_above_best: f64,
    /// Whether what it leaves is no more than the spectrum's own scatter explains.
    pub describes: bool,
    /// Fitted real part, Ohm, in the order of the spectrum.
    pub real_ohm: Vec<f64>,
    /// Fitted imaginary part, Ohm.
    pub imaginary_ohm: Vec<f64>,
}

impl CircuitFit {
    /// The estimate of that key.
    pub fn parameter(&self, key: &str) -> Option<&Estimate> {
        let mut found = self.parameters.iter().filter(|parameter| parameter.key == key);
        found.next().map(|parameter| &parameter.estimate)
    }
}

/// What is found in a sweep.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SpectrumAnalysis {
    /// Whether it can be an impedance.
    pub kramers_kronig: KramersKronig,
    /// The modulus against that which the phase gives; none of too few frequencies.
    pub z_hit: Option<ZHit>,
    /// The distribution of relaxation times; none where the scatter is not told.
    pub relaxation: Option<RelaxationTimes>,
    /// Circuits in the order of the list.
    pub circuits: Vec<CircuitFit>,
    /// The one with the lowest criterion.
    pub best: String,
    /// What a reader must know; documents have it beside what is said of the run.
    #[serde(skip)]
    pub issues: Vec<Issue>,
}

impl SpectrumAnalysis {
    /// The fit of that circuit.
    pub fn circuit(&self, id: &str) -> Option<&CircuitFit> {
        self.circuits.iter().find(|fit| fit.circuit == id)
    }
}

/// A sweep with what is found in it, or why nothing is.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// What was measured.
    pub spectrum: Spectrum,
    /// What is found.
    pub analysis: Result<SpectrumAnalysis, Issue>,
}

/// A run that is a spectrum, with its sweeps.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumRun {
    /// The run.
    pub run: RunRecord,
    /// Its sweeps in the order of measurement.
    pub sweeps: Vec<Sweep>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(quantity: Quantity, values: &[f64]) -> Channel {
        let time: Vec<f64> = (0..values.len()).map(|k| k as f64).collect();
        Channel::new(quantity, time.into(), values.into())
    }

    #[test]
    fn magnitude_and_phase_are_real_and_imaginary_part() {
        let channels = [
            channel(Quantity::Frequency, &[100.0, 10.0]),
            channel(Quantity::ImpedanceMagnitude, &[2.0, 4.0]),
            channel(Quantity::ImpedancePhase, &[-90.0, -60.0]),
        ];
        let found = Spectrum::of(&channels);
        assert_eq!(found.len(), 1);
        assert!((found[0].imaginary_ohm[0] + 2.0).abs() < 1e-12 && found[0].real_ohm[0].abs() < 1e-12);
        assert!((found[0].real_ohm[1] - 2.0).abs() < 1e-12);
        assert_eq!(found[0].range_hz(), Some((10.0, 100.0)));
    }

    #[test]
    fn a_repeated_sweep_is_a_sweep_of_its_own_and_gaps_are_left_out() {
        let hz = [100.0, 10.0, 1.0, 100.0, 10.0, 10.0, 1.0];
        let mut real = channel(Quantity::ImpedanceReal, &[1.0; 7]);
        (real.time_s, real.values) = (
            real.time_s.iter().copied().skip(1).collect(),
            real.values.iter().copied().skip(1).collect(),
        );
        let channels = [
            channel(Quantity::Frequency, &hz),
            real,
            channel(Quantity::ImpedanceImaginary, &[-1.0; 7]),
        ];
        let found = Spectrum::of(&channels);
        let sizes: Vec<usize> = found.iter().map(Spectrum::len).collect();
        assert_eq!(sizes, [2, 4]);
        assert!(Spectrum::of(&channels[..2]).is_empty());
    }
}
