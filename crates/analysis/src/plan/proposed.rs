//! Runs that are proposed, before they have a name.

use ieap_domain::tag::keys;
use ieap_domain::{Campaign, GroupDiagnosis, RunRecord};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

/// A run that should be made.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
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
    /// The drive in words.
    pub drive: String,
    /// What it tells apart: covariates, or effects.
    pub splits: Vec<String>,
    /// Causes that explain the group equally well, now; none where it tells no causes apart.
    pub set_size: Option<f64>,
    /// The same as expected after it.
    pub expected_set_size: Option<f64>,
    /// Why, in sentences; one text in JSON.
    #[serde(serialize_with = "in_one")]
    #[schemars(with = "String")]
    pub why: Vec<String>,
    /// Part of what is open that it closes, from 0 to 1: the rank.
    pub closes: f64,
}

fn in_one<S: Serializer>(sentences: &[String], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&sentences.join("; "))
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
        drive: format!("hold {}", next.drive),
        splits: next.splits.clone(),
        set_size: Some(size),
        expected_set_size: Some(after),
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
