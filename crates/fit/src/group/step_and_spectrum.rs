//! A step, a spectrum and the force of one strip in one likelihood: one set of parameters, and whether all can have it.

use ieap_domain::{Channel, Drive, Estimate, Parameter, Quantity, Spectrum};
use ieap_model::FitModel;
use ieap_model::impedance::spectrum_circuit;
use ieap_numerics::chance::chi_square_chance;
use ieap_numerics::least_squares::Minimum;

use super::intervals::judge;
use super::options::GroupOptions;
use super::search::{deepest, search};
use super::{open_edges, prepared, settled, shared_places, with_drives};
use crate::edges::EdgeTimes;
use crate::error::FitError;
use crate::impedance::lumped_in_spectrum;
use crate::joint::minimum::excess;
use crate::joint::problem::JointProblem;
use crate::joint::spectrum_rows::SpectrumRows;
use crate::joint::start::{Start, problem};
use crate::options::{FitInput, FitOptions};
use crate::outcome;
use crate::outliers::Cleaned;
use crate::two_steps::identified;
use crate::widened::widen_by;

/// Key of what a charge does to the strip: it bends where it is free, and pulls where it is held.
const COUPLING: &str = "alpha_per_c_cm";

/// What a step, a spectrum and a run of the held strip say together.
#[derive(Debug, Clone, PartialEq)]
pub struct StepAndSpectrum {
    /// All parameters of the model, from all of them.
    pub parameters: Vec<Parameter>,
    /// Moment per charge of the held run, unit of its moment over C.
    pub moment_per_c: Option<Estimate>,
    /// Parameters that more than one of them tells, counted once for each further one.
    pub shared: usize,
    /// By how much the weighted sum of squares rises where all have one circuit.
    pub chi_square_rise: f64,
    /// Chance of such a rise where they have; what the model leaves of the runs beyond noise is allowed for.
    pub p: f64,
}

/// Fits a run of steps and a spectrum of its strip, of that area, with one circuit; and, with the same circuit and relaxation, a
/// run in which the strip was `held`, whose moment stands in the place of the curvature. Readings of the spectrum scatter by what
/// the same circuit leaves of it alone. Edges that only readings tell of are sought with all of them, and what is left open of
/// these widens the intervals.
///
/// # Errors
/// A run has no circuit, its voltage moves all the time, or the model has no counterpart that is fitted to spectra.
pub fn step_and_spectrum(
    step: &FitInput,
    held: Option<&FitInput>,
    (spectrum, area_cm2): (&Spectrum, f64),
    model_id: &str,
) -> Result<StepAndSpectrum, FitError> {
    let model = FitOptions::for_model(model_id)?.model;
    if std::iter::once(step).chain(held).any(|input| input.drive.moves()) {
        return Err(FitError::Moves { model: model.id });
    }
    let mut options = GroupOptions::sharing_all(model);
    options.shared.retain(|key| key != COUPLING);
    let size = held.map_or(1.0, |held| size_beside(step, held));
    let moment = held.map(|held| scaled(held, size));
    let beside = held.zip(moment.as_deref());
    let beside = beside.map(|(held, channels)| FitInput { channels, ..*held });
    let inputs: Vec<FitInput> = std::iter::once(*step).chain(beside).collect();
    let cleaned: Vec<Cleaned> = inputs.iter().map(Cleaned::of).collect();
    let each = inputs.iter().zip(&cleaned);
    let inputs: Vec<FitInput> = each.map(|(input, cleaned)| cleaned.input(input)).collect();

    let edges: Vec<EdgeTimes> = inputs.iter().map(|input| EdgeTimes::of(input.drive)).collect();
    let each = inputs.iter().zip(&edges);
    let drives: Vec<Drive> = each
        .map(|(input, edges)| placed_alone(input, edges, model))
        .collect();
    let of_strip = OfStrip::of(spectrum, area_cm2, model.id)?;
    let alone = with_drives(&inputs, drives.iter());
    let apart = of_strip.apart(&alone, &options)?;
    let (problem, bottom) = of_strip.together(&alone, &options)?;
    let is_open = edges.iter().any(EdgeTimes::is_open);
    let placed = is_open
        .then(|| open_edges::placed(&problem, &bottom.at, &edges))
        .flatten();
    let drives: Option<Vec<&Drive>> = placed.as_ref().map(|placed| {
        let each = placed.iter().map(|placed| placed.settled.edges.drive());
        each.collect()
    });
    let (problem, bottom) = match drives {
        Some(drives) => of_strip.together(&with_drives(&inputs, drives.into_iter()), &options)?,
        None => (problem, bottom),
    };
    let judged = judge(&problem, bottom, &options, 0);
    let parameters_of = |run: usize| {
        let features = judged.features.get(run).map_or(&[][..], Vec::as_slice);
        let mut own = outcome::joint_parameters(model, features, inputs[run].drive);
        if let Some(placed) = placed.as_ref().map(|placed| &placed[run]) {
            widen_by(&mut own, &placed.here, &placed.ends);
        }
        own
    };
    let mut of_held = (1..inputs.len()).flat_map(parameters_of);
    let moment = of_held.find(|own| own.key == COUPLING);
    let shared = apart.coordinates.saturating_sub(judged.bottom.at.len());
    let rise = (problem.square(&judged.bottom.at) - apart.square).max(0.0);
    Ok(StepAndSpectrum {
        parameters: parameters_of(0),
        moment_per_c: moment.map(|own| own.estimate.scaled(size.recip())),
        shared,
        chi_square_rise: rise,
        p: chi_square_chance(rise / apart.misfit, shared),
    })
}

/// The drive of a run by itself, its edges where its readings have them.
fn placed_alone(input: &FitInput, edges: &EdgeTimes, model: &'static FitModel) -> Drive {
    let options = FitOptions {
        model,
        ..FitOptions::default()
    };
    let settled = edges.is_open().then(|| {
        let identified = identified(input, &options, edges.drive())?;
        settled(input, &options, edges, &identified)
    });
    settled
        .flatten()
        .map_or_else(|| edges.drive().clone(), |settled| settled.edges.drive().clone())
}

/// What the spectrum says of the strip by itself.
struct OfStrip<'s> {
    spectrum: &'s Spectrum,
    area_cm2: f64,
    /// R_1, C_1, R_2, C_2, ..., R_ss of the whole strip, Ohm and F.
    values: Vec<f64>,
    /// Readings less parameters.
    left: f64,
    /// Standard deviation of a reading, part of |Z|.
    scatter: f64,
}

/// The runs and the spectrum, each by itself.
struct Apart {
    square: f64,
    coordinates: usize,
    /// Variance that the model leaves of a run, in that of its noise.
    misfit: f64,
}

impl OfStrip<'_> {
    fn of<'s>(spectrum: &'s Spectrum, area_cm2: f64, model: &'static str) -> Result<OfStrip<'s>, FitError> {
        let found = || FitError::GroupModel { found: model };
        let circuit = spectrum_circuit(model).ok_or_else(found)?;
        let alone = lumped_in_spectrum(circuit, spectrum).ok_or_else(found)?;
        let readings = 2 * spectrum.len();
        let left = readings.saturating_sub(circuit.parameters.len()).max(1) as f64;
        Ok(OfStrip {
            spectrum,
            area_cm2,
            values: alone.values,
            left,
            scatter: alone.residual_rms * (readings as f64 / left).sqrt(),
        })
    }

    fn apart(&self, inputs: &[FitInput], options: &GroupOptions) -> Result<Apart, FitError> {
        let (runs, starts) = prepared(inputs, options)?;
        let mut apart = Apart {
            // By its scatter the spectrum leaves one for each of them.
            square: self.left,
            coordinates: self.values.len(),
            misfit: 1.0,
        };
        for (run, start) in runs.into_iter().zip(&starts) {
            let (own, bottom, _) = search(vec![run], std::slice::from_ref(start), &[]);
            apart.square += own.square(&bottom.at);
            // With the leak, which the spectrum may tell where the step does not.
            apart.coordinates += bottom.at.len() + usize::from(!start.searched[start.layout().steady()]);
            apart.misfit = apart.misfit.max(excess(&own, &bottom).powi(2));
        }
        Ok(apart)
    }

    fn together<'a>(
        &self,
        inputs: &[FitInput<'a>],
        options: &GroupOptions,
    ) -> Result<(JointProblem<'a>, Minimum), FitError> {
        let (runs, mut starts) = prepared(inputs, options)?;
        for start in &mut starts {
            let steady = start.layout().steady();
            start.searched[steady] = true;
        }
        let (mut together, first) = problem(runs, &starts, &shared_places(options)?);
        together.spectra = vec![SpectrumRows::new(0, self.spectrum, self.area_cm2, self.scatter)];
        let of_spectrum: Vec<Start> = starts.iter().map(|start| self.start(start)).collect();
        let found = [starts, of_spectrum].map(|starts| deepest(&together, &starts, first.clone()).0);
        let bottom = Minimum::lowest(found.into_iter()).ok_or(FitError::EmptyGroup)?;
        Ok((together, bottom))
    }

    /// The start with the circuit as the spectrum has it.
    fn start(&self, start: &Start) -> Start {
        let layout = start.layout();
        let mut own = start.clone();
        for k in 0..layout.branches {
            own.local[layout.resistance(k)] = (self.values[2 * k] * self.area_cm2).ln();
            own.local[layout.capacitance(k)] = (self.values[2 * k + 1] / self.area_cm2).ln();
        }
        own.local[layout.steady()] = (self.values[2 * layout.branches] * self.area_cm2).recip();
        own
    }
}

/// What a moment is taken times, to be as large as the curvature of the free strip: one size of coordinates for both.
fn size_beside(step: &FitInput, held: &FitInput) -> f64 {
    let largest = |input: &FitInput| {
        let bent = input
            .channels
            .iter()
            .find(|own| own.quantity == Quantity::Curvature)?;
        let sizes = bent.values.iter().map(|value| value.abs());
        Some(sizes.filter(|size| size.is_finite()).fold(0.0, f64::max)).filter(|size| *size > 0.0)
    };
    let of = largest(step).zip(largest(held));
    of.map_or(1.0, |(curvature, moment)| curvature / moment)
}

/// Channels of a held run with its moment in that size.
fn scaled(held: &FitInput, size: f64) -> Vec<Channel> {
    let of = |channel: &Channel| match channel.quantity {
        Quantity::Curvature => Channel {
            values: channel.values.iter().map(|value| size * value).collect(),
            ..channel.clone()
        },
        _ => channel.clone(),
    };
    held.channels.iter().map(of).collect()
}
