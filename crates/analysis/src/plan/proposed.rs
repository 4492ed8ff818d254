//! Runs that are proposed, before they have a name: from the plans of tied sets, and from the sets of causes.

use std::collections::BTreeMap;

use super::deconfound::{Deconfounding, Step};
use super::future::Setting;
use super::policy::MOST_INFLATION;
use super::words;
use crate::conditions::{VOLTAGE_STEP_V, nominal_voltage_v};
use crate::laws::covariate::Covariate;
use crate::laws::policy::INFLATION_LIMIT;
use ieap_domain::number::fixed;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, GroupDiagnosis, RunRecord};

/// Pairs that a reason names.
const SAID: usize = 3;

/// What a run is expected to bring.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Expected {
    /// Causes that explain the group equally well, before and after.
    pub set_size: Option<(f64, f64)>,
    /// Largest variance inflation of the tied set, before and after; infinite where nothing can be told apart.
    pub inflation: Option<(f64, f64)>,
}

/// A run that should be made.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// Sample id.
    pub sample: String,
    /// Material.
    pub material: String,
    /// Environment id.
    pub environment: Option<String>,
    /// Relative humidity, percent.
    pub relative_humidity_percent: Option<f64>,
    /// Temperature, degrees Celsius.
    pub temperature_c: Option<f64>,
    /// Nominal voltage, V.
    pub voltage_v: Option<f64>,
    /// Rest before it, s.
    pub rest_before_s: Option<f64>,
    /// Instrument, calibration and operator where one must be another.
    pub names: BTreeMap<Covariate, String>,
    /// The drive in words.
    pub drive: String,
    /// What it tells apart: covariates, or effects.
    pub splits: Vec<String>,
    /// What it is expected to bring.
    pub expected: Expected,
    /// Why, in sentences.
    pub why: Vec<String>,
    /// Part of what is open that it closes, from 0 to 1: the rank.
    pub closes: f64,
}

/// The runs of a plan, none where they bring nothing. All close the same part: what the plan brings, shared among them.
pub fn of_plan(plan: &Deconfounding, runs: &[RunRecord], campaign: &Campaign) -> Vec<Proposal> {
    if !plan.gains() {
        return Vec::new();
    }
    let size = |inflation: f64| inflation.clamp(INFLATION_LIMIT, MOST_INFLATION).ln();
    let open = size(plan.inflation_before) - INFLATION_LIMIT.ln();
    let closed = size(plan.inflation_before) - size(plan.inflation_after);
    let closes = if open > 0.0 { closed / open } else { 0.0 } / plan.steps.len().max(1) as f64;
    let of_step = |step: &Step| of_step(plan, step, runs, campaign, closes);
    plan.steps.iter().map(of_step).collect()
}

fn of_step(
    plan: &Deconfounding,
    step: &Step,
    runs: &[RunRecord],
    campaign: &Campaign,
    closes: f64,
) -> Proposal {
    let setting = &step.setting;
    let number = |covariate| setting.numbers.get(&covariate).copied();
    let voltage_v = setting
        .names
        .get(&Covariate::Voltage)
        .and_then(|name| name.parse().ok());
    let pairs: Vec<String> = step.splits.iter().map(|pair| words::pair(*pair)).collect();
    let mut splits: Vec<String> = Vec::new();
    for covariate in step.splits.iter().flat_map(|(one, other)| [one, other]) {
        let key = covariate.key().to_owned();
        if !splits.contains(&key) {
            splits.push(key);
        }
    }
    let told = match pairs.is_empty() {
        true => "loosens what is tied".to_owned(),
        false if pairs.len() > SAID => {
            let more = pairs.len() - SAID;
            format!("tells {}, and {more} more pairs", pairs[..SAID].join(", "))
        }
        false => format!("tells {}", pairs.join(", ")),
    };
    Proposal {
        sample: setting.sample.clone(),
        material: plan.material.clone(),
        environment: setting.names.get(&Covariate::Environment).cloned(),
        relative_humidity_percent: number(Covariate::RelativeHumidity),
        temperature_c: number(Covariate::Temperature),
        voltage_v,
        rest_before_s: number(Covariate::RestBefore),
        names: [Covariate::Instrument, Covariate::Calibration, Covariate::Operator]
            .into_iter()
            .filter_map(|covariate| Some((covariate, setting.names.get(&covariate)?.clone())))
            .collect(),
        drive: drive_of(setting, voltage_v, runs, campaign),
        splits,
        expected: Expected {
            set_size: None,
            inflation: Some((step.inflation_before, step.inflation_after)),
        },
        why: vec![format!(
            "{told}: {}{}",
            words::brings(step.inflation_before, step.inflation_after),
            if setting.is_new_humidity {
                "; a humidity that was not measured yet"
            } else {
                ""
            }
        )],
        closes,
    }
}

/// The drive that the condition was measured with: the plainest among the material's runs, of the same sample where
/// there is one.
fn drive_of(setting: &Setting, voltage_v: Option<f64>, runs: &[RunRecord], campaign: &Campaign) -> String {
    let material = |sample: &str| campaign.sample(sample).map(|sample| sample.material.as_str());
    let environment = setting.names.get(&Covariate::Environment).map(String::as_str);
    let is_alike = |run: &&RunRecord| {
        let sample = run.tag(keys::SAMPLE);
        let same_voltage = nominal_voltage_v(run)
            .zip(voltage_v)
            .is_some_and(|(a, b)| (a - b).abs() < VOLTAGE_STEP_V);
        same_voltage && sample.is_some_and(|sample| material(sample) == material(&setting.sample))
    };
    let rank = |run: &RunRecord| {
        let segments = run
            .drive
            .as_ref()
            .map_or(usize::MAX, |drive| drive.segments.len());
        let other_sample = run.tag(keys::SAMPLE) != Some(setting.sample.as_str());
        let other_environment = run.tag(keys::ENVIRONMENT) != environment;
        (segments, other_environment, other_sample)
    };
    let found = runs.iter().filter(is_alike).min_by_key(|run| rank(run));
    let described = found.and_then(|run| {
        let last = |found: f64, time: f64| found.max(time);
        let duration_s = run.channels.iter().filter_map(|c| c.last_time_s).reduce(last)?;
        Some(words::drive(run.drive.as_ref()?, duration_s))
    });
    described
        .unwrap_or_else(|| voltage_v.map_or_else(String::new, |volts| format!("hold {} V", fixed(volts, 2))))
}

/// The run that splits the set of a group, where one is known.
pub fn of_group(group: &GroupDiagnosis, runs: &[RunRecord], campaign: &Campaign) -> Option<Proposal> {
    let next = group.next_run.as_ref()?;
    let members: Vec<&RunRecord> = runs.iter().filter(|run| group.runs.contains(&run.path)).collect();
    let sample = members.first()?.tag(keys::SAMPLE)?;
    let shared = |key: &str| {
        let value = members[0].tag(key)?;
        let is_shared = members.iter().all(|run| run.tag(key) == Some(value));
        is_shared.then(|| value.to_owned())
    };
    let mean = |key: &str| {
        let numbers: Vec<f64> = members.iter().filter_map(|run| run.tag_number(key)).collect();
        let mean = numbers.iter().sum::<f64>() / numbers.len().max(1) as f64;
        (!numbers.is_empty()).then(|| (mean * 10.0).round() / 10.0)
    };
    // Of several effects that were found, each with its twins, a run is proposed for the first that has any.
    let twins = group.effects.iter().map(|effect| effect.twins.len());
    let causes = 1 + twins.into_iter().find(|twins| *twins > 0)?;
    let size = causes as f64;
    let after = next.expected_set_size;
    if !after.is_finite() {
        return None;
    }
    Some(Proposal {
        sample: sample.to_owned(),
        material: campaign
            .sample(sample)
            .map_or(sample, |known| &known.material)
            .to_owned(),
        environment: shared(keys::ENVIRONMENT),
        relative_humidity_percent: mean(keys::RELATIVE_HUMIDITY_PERCENT),
        temperature_c: mean(keys::TEMPERATURE_C),
        voltage_v: leading_volts(&next.drive),
        rest_before_s: mean(keys::REST_BEFORE_S),
        names: BTreeMap::new(),
        drive: format!("hold {}", next.drive),
        splits: next.splits.clone(),
        expected: Expected {
            set_size: Some((size, after)),
            inflation: None,
        },
        why: vec![format!(
            "tells {} apart in {}: of {causes} causes {} should be left",
            next.splits.join(", "),
            crate::groups::title(&group.group),
            crate::laws::words::short(after)
        )],
        closes: (1.0 - (after - 1.0) / (size - 1.0)).clamp(0.0, 1.0),
    })
}

/// The level that the words of a drive start with, V: that of its first segment.
fn leading_volts(drive: &str) -> Option<f64> {
    let (number, _) = drive.split_once(" V")?;
    number.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_a_drive_start_with_its_level() {
        assert_eq!(leading_volts("-2.00 V for 600 s (reversed)"), Some(-2.0));
        assert_eq!(
            leading_volts("2.00 V and 0 V in turn, 20 s each, 15 times"),
            Some(2.0)
        );
        assert_eq!(leading_volts("open circuit for 10 s"), None);
    }
}
