//! How much better an extended model predicts what took no part in its fit.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::number_or_null;
use super::quantiles::NORMAL_95;

/// How much better the extended model predicts what it has not seen, and what both models leave of what they have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Gain {
    /// What was held out: `run` (every drive in turn, with its repeats) or `time` (stretches of a single run).
    pub held_out: String,
    /// The gain on that, where there are such on those that others lie on both sides of: the proof that an extension needs.
    #[serde(flatten)]
    pub proof: HeldOutGain,
    /// The gain on the others, which lie outside what was measured beside them: what a law does there is not known.
    #[serde(default)]
    pub outside: Option<HeldOutGain>,
    /// What a user predicts of held-out runs, and how far off it is.
    #[serde(default)]
    pub predictions: Vec<Prediction>,
    /// Root mean square of the whitened residuals of the fit to all readings, by the base model.
    #[serde(deserialize_with = "number_or_null::one")]
    pub residual_rms_sigma_before: f64,
    /// The same by the extended model.
    #[serde(deserialize_with = "number_or_null::one")]
    pub residual_rms_sigma_after: f64,
    /// The gain on the last 40 % of every run, predicted from the first 60 % of all; none for a single run, whose times
    /// are held out already.
    #[serde(default)]
    pub later: Option<HeldOutGain>,
}

impl Gain {
    /// What was held out of so many runs, in a word for several.
    pub fn parts_word(&self, runs: usize) -> &'static str {
        let outside = self.outside.as_ref().map_or(0, |own| own.parts.len());
        match self.held_out.as_str() {
            "time" => "stretches of time",
            _ if self.proof.parts.len() + outside < runs => "drives",
            _ => "runs",
        }
    }

    /// What was held out and counts, of so many runs: `held-out runs`, `held-out run between others`.
    pub fn held_out_words(&self, runs: usize) -> String {
        let word = self.parts_word(runs);
        match (&self.outside, self.proof.parts.len()) {
            (None, _) => format!("held-out {word}"),
            (Some(_), 1) => format!("held-out {} between others", &word[..word.len() - 1]),
            (Some(_), _) => format!("held-out {word} between others"),
        }
    }
}

/// How much better held-out parts are predicted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HeldOutGain {
    /// Fall of the deviance of the held-out readings: how far they lie from what was predicted of them, in units of the
    /// noise and with what the prediction itself does not know.
    #[serde(deserialize_with = "number_or_null::one")]
    pub deviance: f64,
    /// Its standard error over the held-out parts.
    #[serde(deserialize_with = "number_or_null::one")]
    pub standard_error: f64,
    /// Fall for every held-out part, by name.
    #[serde(deserialize_with = "number_or_null::named")]
    pub parts: Vec<(String, f64)>,
    /// Root mean square deviation of the held-out current over its range, by the base model.
    pub nrmse_current_before: Option<f64>,
    /// The same by the extended model.
    pub nrmse_current_after: Option<f64>,
    /// Of the held-out curvature, by the base model.
    pub nrmse_curvature_before: Option<f64>,
    /// The same by the extended model.
    pub nrmse_curvature_after: Option<f64>,
    /// Share of the held-out readings within the 95 % interval of the base model's prediction: by their noise, its parameters
    /// and the error that it leaves of what it was fitted to.
    #[serde(default)]
    pub coverage_before: Option<f64>,
    /// The same of the extended model's.
    #[serde(default)]
    pub coverage_after: Option<f64>,
}

impl HeldOutGain {
    /// Whether it is clearly a gain: every part comes out better, or the 95 % interval of the sum does not reach zero. The
    /// interval alone says little of few parts, of which one gains far more than the others.
    pub fn is_clear(&self) -> bool {
        let (better, all) = self.better_parts();
        self.deviance > NORMAL_95 * self.standard_error || (self.deviance > 0.0 && all > 1 && better == all)
    }

    /// Held-out parts that the extended model predicts better, and all of them.
    pub fn better_parts(&self) -> (usize, usize) {
        let better = self.parts.iter().filter(|(_, fall)| *fall > 0.0).count();
        (better, self.parts.len())
    }
}

/// How far off a model predicts a number of held-out runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Prediction {
    /// `peak_curvature`, `time_of_peak_curvature`, `end_curvature`, `charge` or `end_current`.
    pub quantity: String,
    /// Root mean square over the runs of its deviation from what was measured, percent, by the base model.
    #[serde(deserialize_with = "number_or_null::one")]
    pub before_percent: f64,
    /// The same by the extended model.
    #[serde(deserialize_with = "number_or_null::one")]
    pub after_percent: f64,
}

#[cfg(test)]
mod tests {
    use crate::testing::held_out;

    #[test]
    fn a_gain_whose_interval_reaches_zero_is_none() {
        assert!(!held_out(23_197.0, 23_250.0).is_clear());
        assert!(held_out(23_197.0, 11_000.0).is_clear());
        assert!(!held_out(-10.0, 1.0).is_clear() && !held_out(f64::NAN, 1.0).is_clear());
    }
}
