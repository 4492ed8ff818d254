//! One circuit fitted to one spectrum.

use std::f64::consts::TAU;

use ieap_domain::{CircuitFit, Parameter, Spectrum};
use ieap_model::impedance::{Scale, SpectrumCircuit};
use ieap_numerics::least_squares::Minimum;

use super::intervals;
use super::search::Simulated;

/// Starts that are searched from: those with the lowest sum of squares among all that are tried.
const STARTS: usize = 4;
/// Time constants that starts are laid over, a decade.
const PER_DECADE: f64 = 1.5;

/// Fits a circuit; gives it with its Bayesian information criterion. None where no start gives a number.
pub(super) fn fit(circuit: &'static SpectrumCircuit, spectrum: &Spectrum) -> Option<(CircuitFit, f64)> {
    let problem = Simulated::new(circuit, spectrum);
    let mut found = best_of(&problem)?;
    order_chains(&problem, &mut found);
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
        circuit: circuit.id,
        parameters,
        residual_rms_percent: 100.0 * mean_square.sqrt(),
        bic_above_best: 0.0,
        describes: false,
        real_ohm: simulated.iter().map(|z| z.re).collect(),
        imaginary_ohm: simulated.iter().map(|z| z.im).collect(),
    };
    Some((fit, bic))
}

fn best_of(problem: &Simulated<'_>) -> Option<Minimum> {
    let mut starts: Vec<(f64, Vec<f64>)> = starts(problem)
        .into_iter()
        .map(|values| {
            let at = problem.place(&values);
            (problem.square(&at), at)
        })
        .filter(|(square, _)| square.is_finite())
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    Minimum::lowest(starts.iter().take(STARTS).map(|(_, at)| problem.lowest(at)))
}

/// Values to begin from: resistances between those seen, capacitances from time constants over the range.
fn starts(problem: &Simulated<'_>) -> Vec<Vec<f64>> {
    let spectrum = problem.spectrum;
    let magnitude = spectrum.magnitude_ohm();
    let (least, most) = ieap_domain::range_of(magnitude);
    let (slow, fast) = ieap_domain::range_of(spectrum.frequency_hz.iter().copied());
    let decades = (fast / slow).log10();
    let count = (PER_DECADE * decades).ceil().max(3.0) as usize;
    let taus: Vec<f64> = (0..=count)
        .map(|k| (TAU * fast).recip() * 10.0_f64.powf((decades + 1.0) * k as f64 / count as f64))
        .collect();
    let leaks = [1.5 * most, 100.0 * most];
    let mut all = Vec::new();
    for &tau in &taus {
        for leak in leaks {
            match problem.circuit.id {
                "lumped-1" => all.push(vec![least, tau / least, leak]),
                "lumped-2" => {
                    for &slower in taus.iter().filter(|slower| **slower > 2.0 * tau) {
                        for second in [least, 5.0 * least, 30.0 * least] {
                            all.push(vec![1.2 * least, tau / least, second, slower / second, leak]);
                        }
                    }
                }
                "constant-phase" => {
                    for exponent in [0.95, 0.75, 0.55] {
                        all.push(vec![least, tau.powf(exponent) / least, exponent, leak]);
                    }
                }
                "warburg-finite" => {
                    for share in [0.2, 1.0, 5.0] {
                        let line = share * least;
                        all.push(vec![least, line, tau / line, leak]);
                    }
                }
                _ => {
                    for share in [0.03, 0.3, 1.0, 3.0] {
                        all.push(vec![least, tau / least, share * tau.sqrt() / least, leak]);
                    }
                }
            }
        }
    }
    all
}

/// Chains in order of their time constants, as fits of steps have them.
fn order_chains(problem: &Simulated<'_>, found: &mut Minimum) {
    if problem.circuit.id == "lumped-2" && found.at[0] + found.at[1] > found.at[2] + found.at[3] {
        let mut at = found.at.clone();
        at.rotate_left(2);
        // R2, C2, R_ss, R1, C1 becomes R2, C2, R1, C1, R_ss.
        at[2..5].rotate_left(1);
        *found = problem.lowest(&at);
    }
}

/// Total capacitance and the resistance of the first current, where their parts are determined.
fn derived(problem: &Simulated<'_>, found: &Minimum, parameters: &[Parameter]) -> Vec<Parameter> {
    let circuit = problem.circuit;
    let known = |scale: Scale| {
        let of_scale = circuit.parameters.iter().zip(parameters);
        let mut of_scale = of_scale.filter(|(p, _)| p.scale == scale && p.key != "rss_ohm");
        of_scale.all(|(_, estimate)| estimate.estimate.value.is_some())
    };
    let mut all = Vec::new();
    if (circuit.total_capacitance_f)(&problem.values(&found.at)).is_some() && known(Scale::Storage) {
        let total = |at: &[f64]| (circuit.total_capacitance_f)(&problem.values(at)).unwrap_or(f64::NAN);
        all.push(intervals::of_function(problem, found, "c_total_f", &total));
    }
    if known(Scale::Resistance) {
        let fastest = |at: &[f64]| (circuit.fastest_resistance_ohm)(&problem.values(at));
        all.push(intervals::of_function(problem, found, "r_parallel_ohm", &fastest));
    }
    all
}
