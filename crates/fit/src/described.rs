//! A run under a model in two steps, the same two for every model, as something that predicts other times and drives.

use ieap_domain::{Drive, Quantity};
use ieap_model::bending::{BendingLaw, ChargeCourse, bending_law, curvature_per_cm};
use ieap_model::{FitModel, LumpedModel};
use ieap_numerics::correlation::Autoregression;

use super::electrical::Electrical;
use super::law::identify_law;
use super::sampled::Sampled;
use super::uncertainty::Residuals;
use crate::electrical;
use crate::error::FitError;
use crate::options::{FitInput, FitOptions};
use crate::outliers::Cleaned;
use crate::policy::FOLLOWED_PART;
use crate::two_steps::{Readings, needed};

/// What a model leaves of one response.
#[derive(Debug, Clone, PartialEq)]
pub struct Left {
    /// The response.
    pub quantity: Quantity,
    /// Readings that were fitted.
    pub readings: usize,
    /// Sum of the squared residuals, canonical unit squared.
    pub square: f64,
    /// Noise found without the model; none where the readings are too few for it.
    pub scatter: Option<Noise>,
    /// Noise as the residuals have it.
    pub residual: Noise,
    /// Parameters that were searched for this response.
    pub searched: usize,
}

/// Size and memory of noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation, canonical unit.
    pub standard_deviation: f64,
    /// Variance of a long sum per reading over the variance of a reading; 1 for white noise.
    pub memory: f64,
}

impl Left {
    /// The noise to judge by: the scatter, or what this fit leaves where that is far less, since a model of few
    /// parameters cannot follow noise.
    pub fn noise(&self) -> Noise {
        match self.scatter {
            Some(scatter) if self.follows(scatter) => self.residual,
            Some(scatter) => scatter,
            None => self.residual,
        }
    }

    fn follows(&self, scatter: Noise) -> bool {
        let left = self.residual.standard_deviation;
        left > 0.0 && left * left < FOLLOWED_PART * scatter.standard_deviation.powi(2)
    }
}

/// A run under a model.
#[derive(Clone)]
pub struct Described {
    /// The model.
    pub model: &'static FitModel,
    /// Couplings of its law of bending, 1/(C cm); empty where no bending was fitted.
    pub couplings: Vec<f64>,
    /// Shapes of its law.
    pub shapes: Vec<f64>,
    /// Why no bending was fitted.
    pub no_bending: Option<String>,
    /// What it leaves of each response that was fitted.
    pub left: Vec<Left>,
    circuit: LumpedModel,
    law: &'static dyn BendingLaw,
    current_offset_a: f64,
    curvature_offset_per_cm: f64,
}

impl Described {
    /// Values of the response at `time_s` under `drive`, for a sample of `area_cm2`; none where that response was not
    /// fitted, or where the law does not describe the drive.
    pub fn predict(
        &self,
        quantity: Quantity,
        drive: &Drive,
        area_cm2: f64,
        time_s: &[f64],
    ) -> Option<Vec<f64>> {
        match quantity {
            Quantity::Current => {
                let current = self.circuit.current_a(drive, area_cm2, time_s);
                Some(
                    current
                        .into_iter()
                        .map(|value| value + self.current_offset_a)
                        .collect(),
                )
            }
            Quantity::Curvature if !self.couplings.is_empty() && self.law.refuses(drive).is_none() => {
                let charge = ChargeCourse::new(&self.circuit, drive, area_cm2, time_s);
                let bent = curvature_per_cm(self.law, &charge, &self.couplings, &self.shapes);
                Some(
                    bent.into_iter()
                        .map(|value| value + self.curvature_offset_per_cm)
                        .collect(),
                )
            }
            _ => None,
        }
    }

    /// Parameters that were searched, over all responses.
    pub fn searched(&self) -> usize {
        self.left.iter().map(|left| left.searched).sum()
    }
}

/// Describes a run with a model of a strip as a whole: lumped, or a rival.
///
/// # Errors
/// [`FitError`] where there is no current to fit, or the model is none of a strip as a whole.
pub fn describe(input: &FitInput, model: &'static FitModel) -> Result<Described, FitError> {
    let law = bending_law(model.id).ok_or(FitError::WholeStrip { found: model.id })?;
    let options = FitOptions {
        model,
        ..FitOptions::default()
    };
    let cleaned = Cleaned::of(input);
    let input = &cleaned.input(input);
    let readings = Readings::new(input)?;
    readings.check(input, &options)?;
    let current = readings
        .current
        .filter(|sampled| sampled.after_step() >= needed(model));
    let Some(sampled) = current else {
        return Err(FitError::NoCharge);
    };
    let electrical = electrical::identify(
        input.drive,
        input.area_cm2,
        &sampled,
        model.branches,
        options.search(),
    );
    let branches = electrical.conductances_a_per_v.len();
    let searched = 2 * branches + 1 + usize::from(electrical.offset_a.is_some());
    let mut described = Described {
        model,
        couplings: Vec::new(),
        shapes: Vec::new(),
        no_bending: None,
        left: vec![left(Quantity::Current, &sampled, &electrical.residuals, searched)],
        circuit: electrical.model(1.0, 0.0),
        law,
        current_offset_a: electrical.offset_a.unwrap_or(0.0),
        curvature_offset_per_cm: 0.0,
    };
    described.no_bending = bend(&mut described, input, &options, &electrical, readings.curvature).err();
    Ok(described)
}

/// Fits the law of bending, or says why there is none.
fn bend(
    described: &mut Described,
    input: &FitInput,
    options: &FitOptions,
    electrical: &Electrical,
    curvature: Option<Sampled>,
) -> Result<(), String> {
    let sampled = curvature.ok_or("the run has no curvature")?;
    if let Some(why) = described.law.refuses(input.drive) {
        return Err(why.to_owned());
    }
    if electrical.conductances_a_per_v.is_empty() {
        return Err("the current shows no charge that could bend the strip".to_owned());
    }
    if sampled.after_step() < needed(options.model) {
        return Err("the curvature has too few readings after the step".to_owned());
    }
    let bent = identify_law(described.law, input.drive, electrical, &sampled, options.search());
    let (couplings, shapes) = bent.natural.split_at(bent.couplings);
    described.couplings = couplings.to_vec();
    described.shapes = shapes.to_vec();
    described.curvature_offset_per_cm = bent.zero.map_or(0.0, |zero| zero.value);
    // Every model is counted with all that it may search, at a limit or not.
    let searched = bent.natural.len() + usize::from(bent.zero.is_some());
    described
        .left
        .push(left(Quantity::Curvature, &sampled, &bent.residuals, searched));
    Ok(())
}

fn left(quantity: Quantity, sampled: &Sampled, residuals: &Residuals, searched: usize) -> Left {
    let noise = |noise: Autoregression| Noise {
        standard_deviation: noise.variance.sqrt(),
        memory: noise.long_run_variance().max(noise.variance) / noise.variance.max(f64::MIN_POSITIVE),
    };
    Left {
        quantity,
        readings: sampled.len(),
        square: residuals.square,
        scatter: sampled.scatter.as_ref().map(|scatter| noise(scatter.noise())),
        residual: noise(residuals.noise),
        searched,
    }
}
