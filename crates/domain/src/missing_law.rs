//! What is missing from a simulation: the account of its error, and the laws that take it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::number_or_null;

/// Of what the squared error of the base model is made, percent; they sum to 100.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Account {
    /// Noise of the readings.
    #[serde(deserialize_with = "number_or_null::one")]
    pub noise: f64,
    /// Slow noise of the instrument.
    #[serde(deserialize_with = "number_or_null::one")]
    pub instrument: f64,
    /// Parameters that differ between the runs.
    #[serde(deserialize_with = "number_or_null::one")]
    pub between_runs: f64,
    /// Laws that are missing within the runs.
    #[serde(deserialize_with = "number_or_null::one")]
    pub within_runs: f64,
    /// Common to all samples at one time of the clock.
    #[serde(deserialize_with = "number_or_null::one")]
    pub room: f64,
    /// Everything else.
    #[serde(deserialize_with = "number_or_null::one")]
    pub unexplained: f64,
}

impl Account {
    /// Its parts in the order in which they are drawn, with what each is called.
    pub fn parts(&self) -> [(&'static str, f64); 6] {
        [
            ("noise", self.noise),
            ("instrument", self.instrument),
            ("runs differ", self.between_runs),
            ("missing law", self.within_runs),
            ("room", self.room),
            ("not explained", self.unexplained),
        ]
    }

    /// What is beyond noise, percent of all.
    pub fn beyond_noise(&self) -> f64 {
        100.0 - self.noise
    }

    /// A part in percent of what is beyond noise.
    pub fn share(&self, part: f64) -> f64 {
        100.0 * part / self.beyond_noise().max(f64::MIN_POSITIVE)
    }
}

/// A law that is missing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MissingLaw {
    /// Where it acts: `current` or `bending`.
    pub place: String,
    /// The part of the model, `resistance`; none where only the place is told.
    pub law: Option<String>,
    /// Which of several such parts; none where of all.
    pub of: Option<String>,
    /// What it follows, `time_s`.
    pub variable: Option<String>,
    /// What is so, as a clause.
    pub words: String,
    /// The one textbook curve that lies within its band.
    pub name: Option<String>,
    /// All that do, the most probable first.
    pub names: Vec<String>,
    /// Probability of the deepest of place, law with variable, and name.
    #[serde(deserialize_with = "number_or_null::one")]
    pub probability: f64,
    /// The law drawn; none where it is no function of one variable.
    pub curve: Option<LawCurve>,
    /// What it gains on readings that took no part in its fit.
    pub held_out: HeldOutError,
}

/// A law over its variable, with its 95 % band.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LawCurve {
    /// The variable, in the unit that its key ends in.
    #[serde(deserialize_with = "number_or_null::many")]
    pub x: Vec<f64>,
    /// What the law adds or, of relative changes, multiplies by one more than; as the change from the place at which the band is
    /// closed, where the base's parameters take up its level.
    #[serde(deserialize_with = "number_or_null::many")]
    pub y: Vec<f64>,
    /// Lower end of the band.
    #[serde(deserialize_with = "number_or_null::many")]
    pub low_95: Vec<f64>,
    /// Upper end.
    #[serde(deserialize_with = "number_or_null::many")]
    pub high_95: Vec<f64>,
    /// Unit of `y`; 1 of relative changes.
    pub unit: String,
    /// What is there without the law, where `y` is the whole and not what the law adds. Of a leak over the voltage, whose
    /// conductance R_ss takes up in part, `y` is the whole steady current, and this is what the least conductance on the way
    /// would carry. Else empty.
    #[serde(default, deserialize_with = "number_or_null::many")]
    pub without: Vec<f64>,
}

/// Errors on held-out readings, percent of the range of the quantity in which the law acts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HeldOutError {
    /// Without the law.
    pub error_percent_before: Option<f64>,
    /// With it.
    pub error_percent_after: Option<f64>,
    /// Held-out parts that come out better, "5 of 5".
    pub better_parts: String,
}
