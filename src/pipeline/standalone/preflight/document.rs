//! The document that `ieap plan --json` prints.

use schemars::JsonSchema;
use serde::Serialize;

use super::trial::Trial;
use crate::domain::Estimate;
use crate::model::ParameterDescription;
use crate::numerics::chance::as_few_chance;
use crate::numerics::robust::median;

/// Share of the draws in which a parameter has to come out determined for a plan to promise it: that of all intervals here.
const PROMISED: f64 = 0.95;
/// Chance below which intervals that hold the value this seldom are no chance: one plan in a hundred is told so wrongly.
const TOO_SELDOM: f64 = 0.01;

/// What a run will determine.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PlanDocument {
    /// Always `ieap/plan/1`.
    pub schema: &'static str,
    /// The answer in sentences: what is determined, what stays open and why, which change mends it.
    pub answer: Vec<String>,
    /// Where the parameters and the noise come from.
    pub told_by: String,
    /// Model that is simulated and fitted.
    pub model: &'static str,
    /// Active area of the strip, cm2.
    pub area_cm2: f64,
    /// How the run is to be made.
    #[serde(flatten)]
    pub trial: Trial,
    /// Noise of a reading of the current, standard deviation, A.
    pub current_noise_a: f64,
    /// Noise of a reading of the curvature, standard deviation, 1/cm; null where bending is not read.
    pub curvature_noise_per_cm: Option<f64>,
    /// Simulated runs, each fitted.
    pub draws: usize,
    /// Seed of their noise.
    pub seed: u64,
    /// What comes out of each parameter.
    pub parameters: Vec<PlannedParameter>,
    /// Changes that were tried, one at a time, until every open parameter was determined.
    pub changes: Vec<ChangeEntry>,
    /// What the answer rests on.
    pub remarks: Vec<String>,
}

/// A change of the run, with what comes out of it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ChangeEntry {
    /// The change in words: `a reading every 0.025 s`.
    pub change: String,
    /// `faster`, `slower`, `longer`, `voltage` or `start`: when the drive begins is stated.
    pub kind: &'static str,
    /// Time between readings of the current, s.
    pub every_s: f64,
    /// Time between readings of the bending, s.
    pub bending_every_s: f64,
    /// Length of the record, s.
    pub for_s: f64,
    /// Largest voltage of the drive, V.
    pub largest_voltage_v: f64,
    /// What comes out of each parameter.
    pub parameters: Vec<PlannedParameter>,
}

/// What comes out of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It has a value with an interval in at least 95 of 100 draws.
    Determined,
    /// It has a value as often, and its 95 % interval holds what was simulated more seldom than such intervals do by chance.
    TooNarrow,
    /// It has a value or a limit to one side in at least 95 of 100 draws.
    OneSided,
    /// It has neither.
    Open,
}

/// A parameter before the run is made.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PlannedParameter {
    /// Stored key, with its unit.
    pub key: &'static str,
    /// Symbol.
    pub symbol: &'static str,
    /// Value that was simulated, in the unit of the key.
    pub value: f64,
    /// What comes out.
    pub verdict: Verdict,
    /// Draws in which it has a value.
    pub determined: usize,
    /// Of those, draws whose 95 % interval holds the simulated value.
    pub held: usize,
    /// Draws in which only a limit to one side is known.
    pub one_sided: usize,
    /// Half of the 95 % interval over the value, percent: the median over the draws with a value; null where none has one.
    pub interval_percent: Option<f64>,
    /// Why it has no value, as the fit says most often; null where it always has one.
    pub reason: Option<String>,
}

impl PlannedParameter {
    /// Counts what the fits say.
    pub(super) fn of(
        described: &ParameterDescription,
        value: f64,
        estimates: &[Estimate],
    ) -> PlannedParameter {
        let interval = |estimate: &Estimate| Some((estimate.value?, estimate.low_95?, estimate.high_95?));
        let with_value: Vec<(f64, f64, f64)> = estimates.iter().filter_map(interval).collect();
        let held = with_value
            .iter()
            .filter(|(_, low, high)| (*low..=*high).contains(&value))
            .count();
        let percents = with_value
            .iter()
            .map(|(of, low, high)| 50.0 * (high - low) / of.abs());
        let is_limit = |estimate: &&Estimate| {
            interval(estimate).is_none() && (estimate.low_95.is_some() || estimate.high_95.is_some())
        };
        let (determined, one_sided) = (with_value.len(), estimates.iter().filter(is_limit).count());
        let is_too_narrow = as_few_chance(held, determined, PROMISED) < TOO_SELDOM;
        let promised = |count: usize| count as f64 >= PROMISED * estimates.len() as f64;
        PlannedParameter {
            key: described.key,
            symbol: described.symbol,
            value,
            verdict: match () {
                () if promised(determined) && is_too_narrow => Verdict::TooNarrow,
                () if promised(determined) => Verdict::Determined,
                () if promised(determined + one_sided) => Verdict::OneSided,
                () => Verdict::Open,
            },
            determined,
            held,
            one_sided,
            interval_percent: median(&percents.collect::<Vec<_>>()),
            reason: most_often(estimates.iter().filter(|estimate| interval(estimate).is_none())),
        }
    }

    /// Whether the run determines it.
    pub fn is_determined(&self) -> bool {
        self.verdict == Verdict::Determined
    }
}

/// The reason that most of the estimates give, the first of equals.
fn most_often<'a>(estimates: impl Iterator<Item = &'a Estimate>) -> Option<String> {
    let reasons: Vec<&str> = estimates
        .filter_map(|estimate| estimate.reason.as_deref())
        .collect();
    let count = |of: &str| reasons.iter().filter(|reason| **reason == of).count();
    // `max_by_key` would give the last of equals.
    let most = reasons.iter().rev().max_by_key(|reason| count(reason))?;
    Some((*most).to_owned())
}
