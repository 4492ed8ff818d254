//! Sum of squares of a circuit over a spectrum, and its lowest place.

use ieap_domain::Spectrum;
use ieap_model::impedance::{LEAST_EXPONENT, Scale, SpectrumCircuit};
use ieap_numerics::levenberg::{Local, Minimum, Stopping, search};
use ieap_numerics::symmetric::{CAPACITY, Symmetric};

/// Evaluations that one search may take.
const LIMIT: u64 = 400;
/// A search settles where a step lowers the sum of squares by less than this part.
const SETTLE: f64 = 1e-12;
/// How far beyond what was measured a parameter may lie.
const BEYOND: f64 = 1e4;
/// Step of the differences that stand for slopes, in natural logarithms (cube root of the rounding error).
const SLOPE_STEP: f64 = 6e-6;

/// A circuit held against a spectrum; coordinates are logarithms, but for exponents.
pub(super) struct Problem<'a> {
    pub(super) circuit: &'static SpectrumCircuit,
    pub(super) spectrum: &'a Spectrum,
    weights: Vec<f64>,
    pub(super) low: Vec<f64>,
    pub(super) high: Vec<f64>,
}

impl<'a> Problem<'a> {
    pub(super) fn new(circuit: &'static SpectrumCircuit, spectrum: &'a Spectrum) -> Problem<'a> {
        let magnitude = spectrum.magnitude_ohm();
        let (least, most) = ieap_domain::range_of(magnitude.iter().copied());
        let (slow, fast) = ieap_domain::range_of(spectrum.frequency_hz.iter().copied());
        let bounds = |scale| match scale {
            Scale::Resistance => ((least / BEYOND).ln(), (most * BEYOND).ln()),
            Scale::Storage => {
                let of = |hz: f64, ohm: f64| (std::f64::consts::TAU * hz * ohm).recip();
                ((of(fast, most) / BEYOND).ln(), (of(slow, least) * BEYOND).ln())
            }
            Scale::Exponent => (LEAST_EXPONENT, 1.0),
        };
        let (low, high) = circuit.parameters.iter().map(|p| bounds(p.scale)).unzip();
        Problem {
            circuit,
            spectrum,
            weights: magnitude.iter().map(|size| size.recip()).collect(),
            low,
            high,
        }
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

    /// The place of parameters.
    pub(super) fn place(&self, values: &[f64]) -> Vec<f64> {
        let parameters = self.circuit.parameters.iter().zip(values);
        let at = parameters.map(|(parameter, value)| match parameter.scale {
            Scale::Exponent => *value,
            _ => value.max(f64::MIN_POSITIVE).ln(),
        });
        at.zip(self.low.iter().zip(&self.high))
            .map(|(x, (low, high))| x.clamp(*low, *high))
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
        residuals.iter().map(|r| r * r).sum()
    }

    /// Sum of squares with its slopes.
    fn local(&self, at: &[f64]) -> Local {
        let residuals = self.residuals(&self.simulated(at));
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
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut descent = [0.0; CAPACITY];
        for (entry, slope) in descent.iter_mut().zip(&slopes) {
            *entry = dot(slope, &residuals);
        }
        Local {
            square: dot(&residuals, &residuals),
            descent,
            normal: Symmetric::from_fn(at.len(), |a, b| dot(&slopes[a], &slopes[b])),
        }
    }

    /// The lowest place near `start`.
    pub(super) fn lowest(&self, start: &[f64]) -> Minimum {
        self.lowest_in(start, &self.low, &self.high)
    }

    /// The same with coordinate `held` at `at`.
    pub(super) fn lowest_with(&self, start: &[f64], held: usize, at: f64) -> Minimum {
        let (mut low, mut high, mut start) = (self.low.clone(), self.high.clone(), start.to_vec());
        (low[held], high[held], start[held]) = (at, at, at);
        self.lowest_in(&start, &low, &high)
    }

    fn lowest_in(&self, start: &[f64], low: &[f64], high: &[f64]) -> Minimum {
        let stopping = Stopping {
            limit: LIMIT,
            settle: SETTLE,
            resolution: 0.0,
            smallest_move: 1e-10,
            first_radius: 1.0,
        };
        search(start, low, high, stopping, |at| self.local(at))
    }
}
