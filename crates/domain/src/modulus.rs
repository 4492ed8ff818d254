//! What is found in a modulus log: humidity steps, the modulus before and after each, and how it comes back.

use serde::{Deserialize, Serialize};

use super::{Estimate, Issue, Parameter, RunCurve, RunRecord};

/// Keys of the numbers of a humidity step.
pub mod step_keys {
    /// Relative humidity before the step, percent.
    pub const HUMIDITY_BEFORE: &str = "relative_humidity_before_percent";
    /// Relative humidity at the end of the stretch after it, percent.
    pub const HUMIDITY_AFTER: &str = "relative_humidity_after_percent";
    /// |E*| when the step begins, MPa.
    pub const MODULUS_BEFORE: &str = "complex_modulus_before_mpa";
    /// |E*| at the end of the stretch after the step, MPa.
    pub const MODULUS_AFTER: &str = "complex_modulus_after_mpa";
    /// Change of |E*| relative to its value before, percent; negative where it falls.
    pub const RELATIVE_CHANGE: &str = "relative_change_percent";
    /// Time from the step until |E*| stays within 5 % of its change from equilibrium, s.
    pub const EQUILIBRIUM_TIME: &str = "equilibrium_time_s";
    /// |E*| in equilibrium after the step, MPa, from the fitted relaxation.
    pub const MODULUS_EQUILIBRIUM: &str = "complex_modulus_equilibrium_mpa";
    /// Loss factor when the step begins.
    pub const LOSS_FACTOR_BEFORE: &str = "loss_factor_before";
    /// Loss factor at the end of the stretch after the step.
    pub const LOSS_FACTOR_AFTER: &str = "loss_factor_after";
}

/// Keys of the numbers of a log as a whole, and of a return to an earlier humidity.
pub mod log_keys {
    /// Part of the change that the way back has undone at its end, percent.
    pub const RECOVERY: &str = "recovery_percent";
    /// |E*| on the way down less that on the way up at the same humidity, relative to the way up, percent.
    pub const HYSTERESIS: &str = "hysteresis_percent";
    /// Humidity at which the hysteresis is stated, percent.
    pub const HYSTERESIS_HUMIDITY: &str = "hysteresis_relative_humidity_percent";
}

/// A change of the humidity from one level to another, and what the modulus does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModulusStep {
    /// When the humidity leaves its level, s of the log's clock.
    pub start_s: f64,
    /// When it has reached the next level, s.
    pub settled_s: f64,
    /// Start of the next step, or the last reading, s.
    pub end_s: f64,
    /// Numbers by the keys of [`step_keys`].
    pub estimates: Vec<Parameter>,
}

impl ModulusStep {
    /// The number of that key.
    pub fn estimate(&self, key: &str) -> Option<&Estimate> {
        find(&self.estimates, key)
    }
}

/// What is found in a modulus log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModulusAnalysis {
    /// Version of the analysis; another one makes this out of date.
    pub version: u32,
    /// How |E*| was had, in words.
    pub modulus_source: String,
    /// Frequency of the readings used, Hz, where the log states it.
    pub frequency_hz: Option<f64>,
    /// Smallest and largest temperature, degrees Celsius, where it was logged.
    pub temperature_c: Option<(f64, f64)>,
    /// Readings of |E*| used.
    pub readings: usize,
    /// Humidity steps in order of time.
    pub steps: Vec<ModulusStep>,
    /// Numbers of the log as a whole, by the keys of [`log_keys`]; a key may repeat with the humidity before it.
    pub estimates: Vec<Parameter>,
    /// What a reader must know.
    pub issues: Vec<Issue>,
    /// Curves to draw: |E*| with its fitted relaxations, storage and loss modulus, loss factor, humidity,
    /// temperature, as far as there are any.
    #[serde(default)]
    pub curves: Vec<RunCurve>,
}

impl ModulusAnalysis {
    /// The first number of that key.
    pub fn estimate(&self, key: &str) -> Option<&Estimate> {
        find(&self.estimates, key)
    }

    /// Part of the change that the way back has undone, percent; none where the log has no step.
    pub fn recovery(&self) -> Option<&Estimate> {
        self.estimate(log_keys::RECOVERY)
    }

    /// The hysteresis at each humidity, percent, that was held on both ways: one without a humidity where there is
    /// none.
    pub fn hysteresis(&self) -> Vec<(Option<f64>, &Estimate)> {
        let mut humidity_percent = None;
        let mut found = Vec::new();
        for parameter in &self.estimates {
            match parameter.key.as_str() {
                log_keys::HYSTERESIS_HUMIDITY => humidity_percent = parameter.estimate.value,
                log_keys::HYSTERESIS => found.push((humidity_percent.take(), &parameter.estimate)),
                _ => {}
            }
        }
        found
    }
}

fn find<'a>(estimates: &'a [Parameter], key: &str) -> Option<&'a Estimate> {
    estimates
        .iter()
        .find(|parameter| parameter.key == key)
        .map(|parameter| &parameter.estimate)
}

/// A modulus log with what was found in it.
#[derive(Debug, Clone, PartialEq)]
pub struct ModulusLog {
    /// The log: files, tags, channels, issues.
    pub run: RunRecord,
    /// What was found; none where it lacks a tag or a modulus.
    pub analysis: Option<ModulusAnalysis>,
}
