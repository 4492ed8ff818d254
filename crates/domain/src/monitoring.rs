//! What campaign.toml says of long-term monitoring, and an alarm that it raises.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::Estimate;

/// Rules of campaign.toml, `[monitoring]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MonitoringRules {
    /// Tags of the runs in the reference condition; empty: the condition repeated most.
    pub reference: Vec<(String, String)>,
    /// Runs of a sample between two false alarms of any of its charts, on average.
    pub false_alarm_runs: f64,
    /// Limits of parameters.
    pub limits: Vec<Limit>,
    /// Program with its arguments that hears of a new alarm.
    pub command: Vec<String>,
    /// How long the program may take, s.
    pub command_time_limit_s: f64,
    /// Ids of alarms that are known and no longer counted.
    pub acknowledged: Vec<String>,
}

/// How long a program that hears of an alarm may take unless campaign.toml says otherwise, s: a mail or a call of a web
/// service that works takes seconds, and one that does not is mostly given up by its own side within a minute.
const COMMAND_TIME_LIMIT_S: f64 = 60.0;

impl Default for MonitoringRules {
    /// 500 runs: of ten campaigns of 50 reference runs in which nothing happens one has an alarm, however many parameters.
    fn default() -> MonitoringRules {
        MonitoringRules {
            reference: Vec::new(),
            false_alarm_runs: 500.0,
            limits: Vec::new(),
            command: Vec::new(),
            command_time_limit_s: COMMAND_TIME_LIMIT_S,
            acknowledged: Vec::new(),
        }
    }
}

/// A limit that a parameter must not pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Stored key of the parameter.
    pub parameter: String,
    /// Material that it holds for; none: all.
    pub material: Option<String>,
    /// Too low below this, in the unit that the key names.
    pub below: Option<f64>,
    /// Too high above this.
    pub above: Option<f64>,
}

/// An alarm: a change of a sample in the reference condition, or a limit that was passed.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Alarm {
    /// Id: the same alarm has the same id whenever it is found. That of its first sign.
    pub id: String,
    /// Sample.
    pub sample: String,
    /// Stored key of the parameter that showed it first.
    pub parameter: String,
    /// What showed it first: `ewma`, `jump` or `limit`.
    pub chart: String,
    /// Run that showed it first.
    pub run: String,
    /// Where what was shown first began.
    #[serde(default)]
    pub began: AlarmPlace,
    /// Reference runs of the sample in which chance alone brings one such alarm, on average; of charts.
    pub false_alarm_runs: Option<f64>,
    /// What it says.
    pub message: String,
    /// Whether campaign.toml says that it is known.
    pub acknowledged: bool,
    /// Every parameter that shows it, the first one first.
    #[serde(default)]
    pub shown_by: Vec<AlarmSign>,
}

/// A run on the life of its sample.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct AlarmPlace {
    /// Path of the run.
    pub run: String,
    /// What the life goes over, with its unit: `cycle`, `age_h`.
    pub axis: String,
    /// Where on that.
    pub at: f64,
    /// When the run was started, where that is known.
    pub started_at: Option<String>,
}

/// One parameter that shows a change.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct AlarmSign {
    /// Id of the sign: it acknowledges the alarm as the alarm's own does.
    pub id: String,
    /// Stored key of the parameter.
    pub parameter: String,
    /// `ewma`, `jump` or `limit`.
    pub chart: String,
    /// Run with which the chart left its limits.
    pub run: String,
    /// Mean since its change began over the mean before, as a ratio; none with too few readings.
    pub change: Option<Estimate>,
    /// Whether `change` is a ratio; else it is a difference, in the unit that the key names.
    #[serde(default)]
    pub is_ratio: bool,
    /// Probability that chance alone brings such a change at any of the runs.
    pub p: Option<f64>,
    /// The reading beyond a limit, in the unit that the key names.
    pub reading: Option<Estimate>,
}
