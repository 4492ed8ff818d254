//! How well several models describe one run: what each leaves, what each predicts, and their curves to draw.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Quantity;

/// Models held against each other on one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunComparison {
    /// Name of the run.
    pub run: String,
    /// Every model, in the order in which they were asked for.
    pub models: Vec<ModelScore>,
    /// What was measured, with every model's course.
    pub curves: Vec<ComparedCurve>,
}

/// One model on one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelScore {
    /// Model id.
    pub model: String,
    /// Version of its equations.
    pub version: u32,
    /// Parameters that were searched, over all responses.
    pub parameters: usize,
    /// Bayesian information criterion under the noise that was found without the models: the smaller the better. None
    /// where the model lacks a response that was measured.
    pub bic: Option<f64>,
    /// What it leaves of each response, current first.
    pub responses: Vec<ResponseScore>,
    /// Why it describes nothing of the run, or nothing of its bending; none where it describes all.
    pub missing: Option<String>,
    /// Time that its fit took, s. It differs from call to call.
    pub seconds: f64,
}

/// What a model leaves of one response, all in units of the noise (root mean square).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ResponseScore {
    /// The response.
    pub quantity: Quantity,
    /// Readings.
    pub readings: usize,
    /// What its fit leaves.
    pub leaves: f64,
    /// What it leaves of later times when it is fitted to the earlier ones; none where that could not be tried.
    pub later: Option<f64>,
    /// What it leaves when its parameters come from runs at the nearest other voltages; none where there is none.
    pub other_voltages: Option<f64>,
}

/// A response as it was measured, and as every model has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparedCurve {
    /// The response.
    pub quantity: Quantity,
    /// Noise standard deviation that residuals are counted in, canonical unit.
    pub noise: f64,
    /// Time of each drawn reading, s.
    pub time_s: Vec<f64>,
    /// Measured values, canonical unit.
    pub measured: Vec<f64>,
    /// Fitted values of every model, in the order of the scores; empty where a model does not describe the response.
    pub fitted: Vec<Vec<f64>>,
}

impl ModelScore {
    /// What it leaves of a response.
    pub fn response(&self, quantity: Quantity) -> Option<&ResponseScore> {
        self.responses
            .iter()
            .find(|response| response.quantity == quantity)
    }
}

impl RunComparison {
    /// The response that tells the models apart: the curvature where it was measured, else the current.
    pub fn deciding(&self) -> Option<Quantity> {
        let of = |quantity: Quantity| self.curves.iter().any(|curve| curve.quantity == quantity);
        [Quantity::Curvature, Quantity::Current]
            .into_iter()
            .find(|&quantity| of(quantity))
    }

    /// The score of a model.
    pub fn model(&self, id: &str) -> Option<&ModelScore> {
        self.models.iter().find(|score| score.model == id)
    }
}
