//! A step and a spectrum of one strip in one likelihood: one set of parameters, and whether both can have it.

use ieap_domain::{Parameter, Spectrum};
use ieap_model::impedance::spectrum_circuit;
use ieap_numerics::chance::chi_square_chance;
use ieap_numerics::least_squares::{Minimum, Problem};

use super::intervals::judge;
use super::options::GroupOptions;
use super::prepare;
use super::search::{deepest, search};
use crate::error::FitError;
use crate::impedance::lumped_in_spectrum;
use crate::joint::minimum::excess;
use crate::joint::problem::Over;
use crate::joint::spectrum_rows::SpectrumRows;
use crate::joint::start::{Start, problem};
use crate::options::{FitInput, FitOptions};
use crate::outcome;
use crate::outliers::Cleaned;

/// What a step and a spectrum say together.
#[derive(Debug, Clone, PartialEq)]
pub struct StepAndSpectrum {
    /// All parameters of the model, from both.
    pub parameters: Vec<Parameter>,
    /// Parameters that both tell.
    pub shared: usize,
    /// By how much the weighted sum of squares rises where both have one circuit.
    pub chi_square_rise: f64,
    /// Chance of such a rise where they have; what the step's model leaves beyond noise is allowed for.
    pub p: f64,
}

/// Fits a run of steps whose edges are where its drive has them, and a spectrum of its strip, of that area, with one circuit.
/// Readings of the spectrum scatter by what the same circuit leaves of it alone.
///
/// # Errors
/// The run has no circuit, its voltage moves all the time, or the model has no counterpart that is fitted to spectra.
pub fn step_and_spectrum(
    input: &FitInput,
    (spectrum, area_cm2): (&Spectrum, f64),
    model_id: &str,
) -> Result<StepAndSpectrum, FitError> {
    let model = FitOptions::for_model(model_id)?.model;
    if input.drive.moves() {
        return Err(FitError::Moves { model: model.id });
    }
    let circuit = spectrum_circuit(model.id).ok_or(FitError::GroupModel { found: model.id })?;
    let alone = lumped_in_spectrum(circuit, spectrum).ok_or(FitError::GroupModel { found: model.id })?;
    let shared = circuit.parameters.len();
    let readings = 2 * spectrum.len();
    // The spectrum alone then leaves as many as it has readings more than parameters.
    let left = readings.saturating_sub(shared).max(1) as f64;
    let scatter = alone.residual_rms * (readings as f64 / left).sqrt();
    let options = GroupOptions::sharing_all(model);
    let cleaned = Cleaned::of(input);
    let (run, mut start) = prepare(0, &cleaned.input(input), &options)?;
    let (step, step_bottom, _) = search(vec![run.clone()], std::slice::from_ref(&start), &[]);
    // A spectrum may tell the leak where the step does not.
    let steady = start.layout().steady();
    start.searched[steady] = true;
    let of_spectrum = at_spectrum(&start, &alone.values, area_cm2);
    let (mut together, first) = problem(vec![run], std::slice::from_ref(&start), &[]);
    together.spectra = vec![SpectrumRows::new(0, spectrum, area_cm2, scatter)];
    let found = [start, of_spectrum].map(|start| deepest(&together, &[start], first.clone()));
    let evaluations = found.iter().map(|(_, evaluations)| evaluations).sum();
    let bottom = Minimum::lowest(found.into_iter().map(|(bottom, _)| bottom)).ok_or(FitError::EmptyGroup)?;
    let judged = judge(&together, bottom, &options, evaluations);
    let condensed = Minimum {
        local: step.over(Over::Condensed).local(&step_bottom.at, f64::INFINITY),
        ..step_bottom.clone()
    };
    let misfit = excess(&step, &condensed).powi(2);
    let both = together.square(&judged.bottom.at, Over::Whole);
    let rise = (both - step.square(&step_bottom.at, Over::Whole) - left).max(0.0);
    let features = judged.features.first().map_or(&[][..], Vec::as_slice);
    Ok(StepAndSpectrum {
        parameters: outcome::joint_parameters(model, features, input.drive),
        shared,
        chi_square_rise: rise,
        p: chi_square_chance(rise / misfit, shared),
    })
}

/// The start with the circuit as the spectrum has it: R_1, C_1, R_2, C_2, ..., R_ss in Ohm and F of the whole strip.
fn at_spectrum(start: &Start, values: &[f64], area_cm2: f64) -> Start {
    let layout = start.layout();
    let mut own = start.clone();
    for k in 0..layout.branches {
        own.local[layout.resistance(k)] = (values[2 * k] * area_cm2).ln();
        own.local[layout.capacitance(k)] = (values[2 * k + 1] / area_cm2).ln();
    }
    own.local[layout.steady()] = (values[2 * layout.branches] * area_cm2).recip();
    own
}
