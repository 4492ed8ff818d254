//! What one run gives to a fit, and how to fit it.

use ieap_domain::{Channel, Drive};
use ieap_model::{FitModel, fit_model, fit_models};
use ieap_numerics::global::{Method, method, methods};

use crate::error::FitError;
use crate::instrument_noise::InstrumentNoise;
use crate::search::Search;

/// What one run gives to a fit.
#[derive(Debug, Clone, Copy)]
pub struct FitInput<'a> {
    /// Channels of the run; current and curvature are fitted, the first of each, others are not looked at.
    pub channels: &'a [Channel],
    /// Voltage that drove the run.
    pub drive: &'a Drive,
    /// Active area of the sample, cm2.
    pub area_cm2: f64,
}

/// How to fit.
#[derive(Debug, Clone, Copy)]
pub struct FitOptions<'a> {
    /// The model.
    pub model: &'static FitModel,
    /// How minima are searched.
    pub method: &'static dyn Method,
    /// Seed of a method that is random.
    pub seed: u64,
    /// Whether to describe the noise beside its size (memory of higher order, growth with the signal, steps of the
    /// converter), which costs several times the fit itself and changes no estimate.
    pub describes_noise: bool,
    /// Whether curves have every reading that was fitted, in place of those that a figure shows apart. It changes no estimate.
    pub whole_curves: bool,
    /// How current and curvature are brought together.
    pub steps: Steps,
    /// What the noise that weighs the readings is told from.
    pub noise: NoiseBy<'a>,
}

/// What the noise of a run is told from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum NoiseBy<'a> {
    /// What the fit leaves, as a memory from reading to reading.
    #[default]
    Memory,
    /// Every kind of slow noise, asked beside the parameters, with what other runs of the instrument tell of it: intervals hold
    /// under red noise, 1/f, walks and lines, too. Of a run alone they are up to 2.4 times as wide under white noise, after twelve
    /// runs 1.4 times. So runs are fitted for people; groups, a diagnosis and what is planned stay with the memory.
    /// `cargo run --release -p ieap-fit --example noises` counts.
    Kinds(Option<&'a InstrumentNoise>),
}

/// How current and curvature are brought together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Steps {
    /// The electrical parameters from the current; then, with those fixed, the rest from the curvature.
    #[default]
    TwoStep,
    /// All parameters from both, each weighted by its noise.
    Simultaneous,
}

/// The model of a run where nothing else is asked for.
const DEFAULT_MODEL: &str = "lumped-2";

impl Default for FitOptions<'_> {
    /// Two branches, `lumped-2`, searched by variable projection.
    fn default() -> Self {
        FitOptions {
            model: fit_model(DEFAULT_MODEL).unwrap_or(&fit_models()[0]),
            method: Search::default().method,
            seed: Search::default().seed,
            steps: Steps::TwoStep,
            noise: NoiseBy::Memory,
            describes_noise: false,
            whole_curves: false,
        }
    }
}

impl FitOptions<'_> {
    /// Options for the model of that id.
    ///
    /// # Errors
    /// [`FitError::UnknownModel`] where there is none.
    pub fn for_model(id: &str) -> Result<Self, FitError> {
        let known = || {
            fit_models()
                .iter()
                .map(|model| model.id)
                .collect::<Vec<_>>()
                .join(", ")
        };
        fit_model(id)
            .map(|model| FitOptions {
                model,
                ..FitOptions::default()
            })
            .ok_or_else(|| FitError::UnknownModel {
                found: id.to_owned(),
                known: known(),
            })
    }
}

impl<'a> FitOptions<'a> {
    /// The same with the method of that id.
    ///
    /// # Errors
    /// [`FitError::UnknownMethod`] where there is none.
    pub fn with_method(self, id: &str) -> Result<FitOptions<'a>, FitError> {
        let known = || {
            methods()
                .iter()
                .map(|method| method.id())
                .collect::<Vec<_>>()
                .join(", ")
        };
        match method(id) {
            Some(method) => Ok(FitOptions { method, ..self }),
            None => Err(FitError::UnknownMethod {
                found: id.to_owned(),
                known: known(),
            }),
        }
    }

    /// The same where other runs told of the instrument's noise, if it is weighed by kinds of noise.
    pub fn told_by<'n>(&self, noise: &'n InstrumentNoise) -> FitOptions<'n>
    where
        'a: 'n,
    {
        let asked = self.noise;
        FitOptions {
            noise: match asked {
                NoiseBy::Memory => asked,
                NoiseBy::Kinds(_) => NoiseBy::Kinds(Some(noise)),
            },
            ..*self
        }
    }

    /// Whether fits of steps and pulses with these options are weighed by kinds of noise, where [`NoiseBy::Kinds`] asks for it.
    pub fn is_weighed_by_kinds(&self) -> bool {
        self.steps == Steps::TwoStep && self.model.id.starts_with("lumped-")
    }

    pub(crate) fn search(&self) -> Search {
        Search {
            method: self.method,
            seed: self.seed,
        }
    }
}
