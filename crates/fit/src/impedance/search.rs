//! Sum of squares of a circuit over a spectrum, and its lowest place.

use std::f64::consts::TAU;

use ieap_domain::Spectrum;
use ieap_model::impedance::{LEAST_EXPONENT, Scale, SpectrumCircuit};
use ieap_numerics::least_squares::{Bounds, Damping, Levenberg, Local, Minimum, Problem, Settle};
use ieap_numerics::sums::dot;

use super::policy::BEYOND;

/// A search settles where a step lowers the sum of squares by less than a part in 10^12.
const METHOD: Levenberg = Levenberg {
    damping: Damping::Region { first_radius: 1.0 },
    limit: 400,
    settle: Settle::Part(1e-12),
    resolution: 0.0,
    smallest_move: 1e-10,
};
/// Step of the differences that stand for slopes, in natural logarithms (cube root of the rounding error).
const SLOPE_STEP: f64 = 6e-6;

/// A circuit held against a spectrum; coordinates are logarithms, but for exponents.
pub(super) struct Simulated<'a> {
    pub(super) circuit: &'a SpectrumCircuit,
    pub(super) spectrum: &'a Spectrum,
    weights: Vec<f64>,
    pub(super) bounds: Bounds,
}

impl<'a> Simulated<'a> {
    pub(super) fn new(circuit: &'a SpectrumCircuit, spectrum: &'a Spectrum) -> Simulated<'a> {
        let mut own = Simulated {
            circuit,
            spectrum,
            weights: spectrum.magnitude_ohm().iter().map(|size| size.recip()).collect(),
            bounds: Bounds::even(0, 0.0, 0.0),
        };
        let limits = circuit.parameters.iter().map(|p| own.range(p.scale, BEYOND));
        let (low, high) = limits.unzip();
        own.bounds = Bounds { low, high };
        own
    }

    /// Lowest and highest coordinate of a parameter, `beyond` times beyond what was measured.
    pub(super) fn range(&self, scale: Scale, beyond: f64) -> (f64, f64) {
        let (least, most) = ieap_domain::range_of(self.spectrum.magnitude_ohm());
        let (slow, fast) = ieap_domain::range_of(self.spectrum.frequency_hz.iter().map(|hz| TAU * hz));
        let (low, high) = match scale {
            Scale::Resistance => (least, most),
            Scale::Storage => ((fast * most).recip(), (slow * least).recip()),
            Scale::Inductance => (least / fast, most / slow),
            Scale::Time => (fast.recip(), slow.recip()),
            Scale::Exponent => return (LEAST_EXPONENT, 1.0),
        };
        ((low / beyond).ln(), (high * beyond).ln())
    }

    /// Mean of the logarithm of |Z| as measured over |Z| at a place.
    pub(super) fn mean_log_ratio(&self, at: &[f64]) -> f64 {
        let simulated = self.simulated(at);
        let n = self.spectrum.len();
        let sum: f64 = (0..n).map(|k| simulated[k].hypot(simulated[n + k]).ln()).sum();
        -sum / n as f64
    }

    /// Readings: two for each frequency.
    pub(super) fn readings(&self) -> usize {
        2 * self.spectrum.len()
    }

    /// The parameters at a place.
    pub(super) fn values(&self, at: &[f64]) -> Vec<f64> {
        let parameters = self.circuit.parameters.iter().zip(at);
        parameters
            .map(|(parameter, x)| match parameter.scale {
                Scale::Exponent => *x,
                _ => x.exp(),
            })
            .collect()
    }

    /// Simulated impedance at a place: real parts, then imaginary ones, each over |Z| as measured.
    fn simulated(&self, at: &[f64]) -> Vec<f64> {
        let values = self.values(at);
        let n = self.spectrum.len();
        let mut all = vec![0.0; 2 * n];
        for (k, (&hz, weight)) in self.spectrum.frequency_hz.iter().zip(&self.weights).enumerate() {
            let z = self.circuit.impedance(&values, hz);
            (all[k], all[n + k]) = (z.re * weight, z.im * weight);
        }
        all
    }

    fn residuals(&self, simulated: &[f64]) -> Vec<f64> {
        let measured = self.spectrum.real_ohm.iter().zip(&self.weights);
        let measured = measured.chain(self.spectrum.imaginary_ohm.iter().zip(&self.weights));
        measured
            .zip(simulated)
            .map(|((z, weight), simulated)| z * weight - simulated)
            .collect()
    }

    /// Sum of squares at a place.
    pub(super) fn square(&self, at: &[f64]) -> f64 {
        let residuals = self.residuals(&self.simulated(at));
        dot(&residuals, &residuals)
    }

    /// The lowest place near `start`.
    pub(super) fn lowest(&self, start: &[f64]) -> Minimum {
        METHOD.search(self, start)
    }

    /// The same with coordinate `held` at `at`.
    pub(super) fn lowest_with(&self, start: &[f64], held: usize, at: f64) -> Minimum {
        let mut bounds = self.bounds.clone();
        bounds.set(held, at, at);
        METHOD.search_within(self, &bounds, start)
    }
}

impl Problem for Simulated<'_> {
    fn bounds(&self) -> Bounds {
        self.bounds.clone()
    }

    fn local(&self, at: &[f64], most: f64) -> Local {
        let residuals = self.residuals(&self.simulated(at));
        let square = dot(&residuals, &residuals);
        if square > most {
            return Local::refused(square, at.len());
        }
        let mut moved = at.to_vec();
        let slopes: Vec<Vec<f64>> = (0..at.len())
            .map(|k| {
                moved[k] = at[k] + SLOPE_STEP;
                let above = self.simulated(&moved);
                moved[k] = at[k] - SLOPE_STEP;
                let below = self.simulated(&moved);
                moved[k] = at[k];
                let slope = |(a, b): (f64, f64)| (a - b) / (2.0 * SLOPE_STEP);
                above.into_iter().zip(below).map(slope).collect()
            })
            .collect();
        Local::of(&residuals, &slopes)
    }
}
