//! The outcome of identifying one run with one model.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};

use super::{AlongCurve, Estimate, Issue, Quantity, RunCurve, number_or_null};

/// Code of the note of a fit that says whether the run needs the distributed model.
pub const LUMPED_OR_DISTRIBUTED: &str = "lumped-or-distributed";

/// One identified parameter. The key carries the unit: `r1_ohm_cm2`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Stored key, such as `alpha_per_c_cm`.
    pub key: String,
    /// What is known of it.
    pub estimate: Estimate,
}

/// A number that a fit estimates beside the parameters of its model, since the readings depend on it too. The key carries the
/// unit: `edge_1_s`, `current_zero_a`, `curvature_zero_per_cm`, `bending_clock_ahead_s`, `unseen_charge_percent`,
/// `current_noise_correlation`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Nuisance {
    /// What it is, with the unit; edges are numbered as the drive has them, from 1.
    pub key: String,
    /// What is known of it.
    pub estimate: Estimate,
    /// What tells it.
    pub origin: NuisanceOrigin,
}

/// What tells a nuisance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NuisanceOrigin {
    /// The readings of the run.
    Readings,
    /// Nothing: it is taken as its value.
    Assumed,
}

impl NuisanceOrigin {
    /// As it is written in tables and documents.
    pub fn key(self) -> &'static str {
        match self {
            NuisanceOrigin::Readings => "readings",
            NuisanceOrigin::Assumed => "assumed",
        }
    }
}

/// Parameters as an object of documents, each under its key.
///
/// # Errors
/// Those of the serializer.
pub fn by_key<S: Serializer>(parameters: &[Parameter], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(parameters.iter().map(|own| (&own.key, &own.estimate)))
}

/// What noise is like beside its size, found without the model.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NoiseCharacter {
    /// Coefficients of its autoregression by reading order, lag 1 first; empty for white noise and for noise whose
    /// memory goes by time.
    pub autoregression: Vec<f64>,
    /// Correlation time, s, where readings are uneven and memory goes by time.
    pub correlation_time_s: Option<f64>,
    /// Growth of the standard deviation with the signal, per signal: the part of its square beside the even part.
    pub proportional: f64,
    /// Step of the converter, canonical unit of the channel; 0 where none is seen.
    pub quantum: f64,
    /// Other runs of the instrument that told what noise it has; 0 where this run alone did.
    #[serde(default, skip_serializing_if = "is_none")]
    pub runs_of_instrument: u32,
}

fn is_none(runs: &u32) -> bool {
    *runs == 0
}

/// Noise of one channel and how the residual compares with it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChannelNoise {
    /// The channel.
    pub quantity: Quantity,
    /// Noise standard deviation estimated without the model, canonical unit of the channel.
    pub standard_deviation: f64,
    /// How the noise was estimated, in words.
    pub basis: String,
    /// Its memory, growth and steps, found without the model.
    #[serde(default)]
    pub character: NoiseCharacter,
    /// Lag-1 autocorrelation of the residuals.
    pub residual_autocorrelation: f64,
    /// Root mean square of the residuals, canonical unit of the channel.
    pub residual_rms: f64,
    /// Number of readings used.
    pub readings: usize,
    /// Coefficient of determination of the fit on this channel.
    pub r_squared: Option<f64>,
}

/// Parameters of one run under one model, with everything needed to judge them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// Model id, `lumped-2`.
    pub model: String,
    /// Version of that model's equations and of its identification; a change makes fits out of date.
    pub model_version: u32,
    /// How the minimum was searched, `two-step variable projection`.
    pub method: String,
    /// Whether the search converged.
    pub converged: bool,
    /// Why the search stopped, in words.
    pub why_stopped: String,
    /// Number of readings used, over all fitted channels.
    pub n_samples: usize,
    /// Parameters in the model's order, derived ones last.
    pub parameters: Vec<Parameter>,
    /// What was estimated beside them; with both, the fit can be made again.
    #[serde(default)]
    pub nuisances: Vec<Nuisance>,
    /// Coefficient of determination of the current, as the thesis prints it.
    pub r_squared_current: Option<f64>,
    /// Coefficient of determination of the curvature.
    pub r_squared_curvature: Option<f64>,
    /// Noise and residual per fitted channel.
    pub noise: Vec<ChannelNoise>,
    /// Curves to draw: measured, fitted and residual.
    #[serde(default)]
    pub curves: Vec<RunCurve>,
    /// What was measured along the strip with the simulated values, to draw; empty for models of a whole strip.
    #[serde(default)]
    pub along: Vec<AlongCurve>,
    /// What a reader must know: bounds met, parameters not determined and why.
    pub issues: Vec<Issue>,
    /// Residual evaluations that the search took.
    pub evaluations: u64,
    /// Of an extended model its place; none of a model without laws.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extended: Option<ExtendedPlace>,
}

/// Where an extended model lies: with it the model is predicted, though the readings may not tell each parameter by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExtendedPlace {
    /// Parameters of the base in the order R_1, C_1, R_2, C_2, ..., R_ss, alpha, lambda, in the units of their keys; alpha 0 where
    /// nothing bends, R_ss no number where nothing leaks.
    #[serde(deserialize_with = "number_or_null::many")]
    pub base: Vec<f64>,
    /// Laws beside it.
    pub laws: Vec<FittedLaw>,
    /// Covariance of all these parameters, those of the laws last, row by row; zero of what was held.
    #[serde(deserialize_with = "number_or_null::many")]
    pub covariance: Vec<f64>,
}

/// A law with its parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FittedLaw {
    /// Id of the effect, or of the law as a smooth function.
    pub effect: String,
    /// The form that it took, where it has several.
    pub form: Option<String>,
    /// In the order that its effect has.
    #[serde(deserialize_with = "number_or_null::many")]
    pub parameters: Vec<f64>,
}

impl Fit {
    /// Whether the parameters were found from all runs of a group together, as those of extended models
    /// (`lumped-2 + faradaic-leak`) are.
    pub fn is_of_group(&self) -> bool {
        self.model.contains('+')
    }

    /// The note that says whether the run needs the distributed model.
    pub fn lumped_or_distributed(&self) -> Option<&Issue> {
        self.issues
            .iter()
            .find(|issue| issue.code == LUMPED_OR_DISTRIBUTED)
    }

    /// The nuisance stored under `key`.
    pub fn nuisance(&self, key: &str) -> Option<&Estimate> {
        let found = self.nuisances.iter().find(|nuisance| nuisance.key == key);
        found.map(|nuisance| &nuisance.estimate)
    }

    /// The estimate stored under `key`.
    pub fn parameter(&self, key: &str) -> Option<&Estimate> {
        self.parameters
            .iter()
            .find(|parameter| parameter.key == key)
            .map(|parameter| &parameter.estimate)
    }
}
