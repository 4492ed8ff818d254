//! One circuit fitted to one spectrum.

use std::f64::consts::TAU;

use ieap_domain::{CircuitFit, Parameter, Spectrum};
use ieap_model::impedance::{Part, Scale, SpectrumCircuit};
use ieap_numerics::least_squares::Minimum;

use super::search::Simulated;
use super::starts::starts;
use super::{Alone, intervals};

/// Decades beyond the spectrum, and frequencies, over which parts are ordered by their times.
const ORDER_DECADES: f64 = 3.0;
const ORDER_FREQUENCIES: usize = 120;

/// The circuit at its lowest place, without intervals.
pub(super) fn lowest(circuit: &SpectrumCircuit, spectrum: &Spectrum) -> Option<Alone> {
    let problem = Simulated::new(circuit, spectrum);
    if circuit.parameters.len() >= problem.readings() {
        return None;
    }
    let starts = starts(&problem);
    let found = Minimum::lowest(starts.iter().map(|at| problem.lowest(at)))?;
    let found = in_order(&problem, found);
    Some(Alone {
        residual_rms: (found.local.square / problem.readings() as f64).sqrt(),
        values: problem.values(&found.at),
    })
}

/// Fits a circuit; gives it with its Bayesian information criterion. None where no start gives a number, or where the
/// circuit has as many parameters as there are readings.
pub(super) fn fit(circuit: &SpectrumCircuit, spectrum: &Spectrum) -> Option<(CircuitFit, f64)> {
    let problem = Simulated::new(circuit, spectrum);
    if circuit.parameters.len() >= problem.readings() {
        return None;
    }
    let starts = starts(&problem);
    let found = Minimum::lowest(starts.iter().map(|at| problem.lowest(at)))?;
    let found = in_order(&problem, found);
    let values = problem.values(&found.at);
    let readings = problem.readings() as f64;
    let mean_square = (found.local.square / readings).max(f64::MIN_POSITIVE);
    let bic = readings * mean_square.ln() + values.len() as f64 * readings.ln();
    let simulated: Vec<_> = (spectrum.frequency_hz.iter())
        .map(|&hz| circuit.impedance(&values, hz))
        .collect();
    let mut parameters = intervals::of_parameters(&problem, &found);
    parameters.extend(derived(&problem, &found, &parameters));
    let fit = CircuitFit {
        circuit: circuit.id.clone(),
        parameters,
        residual_rms_percent: 100.0 * mean_square.sqrt(),
        bic_above_best: 0.0,
        describes: false,
        real_ohm: simulated.iter().map(|z| z.re).collect(),
        imaginary_ohm: simulated.iter().map(|z| z.im).collect(),
    };
    Some((fit, bic))
}

/// A circuit as it is, or behind the inductance of its leads where the highest frequency asks for it: nothing else in a sample is a
/// coil. Of both the one with the lower criterion.
pub(super) fn behind_leads_or_not(
    circuit: &SpectrumCircuit,
    spectrum: &Spectrum,
) -> Option<(CircuitFit, f64)> {
    let plain = fit(circuit, spectrum);
    if !is_coil_at_its_highest(spectrum) {
        return plain;
    }
    let behind = fit(&circuit.behind_leads(), spectrum);
    plain.into_iter().chain(behind).min_by(|a, b| a.1.total_cmp(&b.1))
}

fn is_coil_at_its_highest(spectrum: &Spectrum) -> bool {
    let readings = spectrum.frequency_hz.iter().zip(&spectrum.imaginary_ohm);
    let highest = readings.max_by(|a, b| a.0.total_cmp(b.0));
    highest.is_some_and(|(_, imaginary_ohm)| *imaginary_ohm > 0.0)
}

/// Parts that are alike in the order of their times, the fastest first, as fits of steps have their chains.
fn in_order(problem: &Simulated<'_>, found: Minimum) -> Minimum {
    let mut at = found.at.clone();
    for group in problem.circuit.root.exchangeable() {
        let values = problem.values(&at);
        let mut blocks: Vec<(f64, Vec<f64>)> = (group.iter())
            .map(|part| {
                let own = part.places().into_iter().map(|place| at[place]);
                (time(part, &values, problem.spectrum), own.collect())
            })
            .collect();
        blocks.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (part, (_, block)) in group.iter().zip(blocks) {
            for (place, x) in part.places().into_iter().zip(block) {
                at[place] = x;
            }
        }
    }
    if at == found.at {
        found
    } else {
        problem.lowest(&at)
    }
}

/// Logarithm of the time, s, about which a part goes from resistor to capacitor: the mean over the logarithm of the
/// frequency, weighted by |sin(2 phase)|, which is largest where both parts of its impedance are equal.
fn time(part: &Part, values: &[f64], spectrum: &Spectrum) -> f64 {
    let (low, high) = spectrum.range_hz().unwrap_or((1.0, 1.0));
    let (low, high) = (low / 10f64.powf(ORDER_DECADES), high * 10f64.powf(ORDER_DECADES));
    let (mut sum, mut weights) = (0.0, f64::MIN_POSITIVE);
    for k in 0..ORDER_FREQUENCIES {
        let w = TAU * low * (high / low).powf(k as f64 / (ORDER_FREQUENCIES - 1) as f64);
        let z = part.immittance(values, w).impedance();
        let size = z.magnitude();
        let weight = (z.re / size * (z.im / size)).abs();
        if weight.is_finite() {
            sum -= weight * w.ln();
            weights += weight;
        }
    }
    sum / weights
}

/// What follows from the parameters, where those are determined that it is made of.
fn derived(problem: &Simulated<'_>, found: &Minimum, parameters: &[Parameter]) -> Vec<Parameter> {
    let circuit = problem.circuit;
    let known = |scale: Scale| {
        let of_scale = circuit.parameters.iter().zip(parameters);
        let mut of_scale = of_scale.filter(|(p, _)| p.scale == scale && p.key != "rss_ohm");
        of_scale.all(|(_, estimate)| estimate.estimate.value.is_some())
    };
    let of_key = |key: &str| {
        if key.ends_with("_f") {
            Scale::Storage
        } else {
            Scale::Resistance
        }
    };
    let told = circuit.derived.iter().filter(|(key, _)| known(of_key(key)));
    told.map(|(key, function)| {
        intervals::of_function(problem, found, key, &|at: &[f64]| function(&problem.values(at)))
    })
    .collect()
}
