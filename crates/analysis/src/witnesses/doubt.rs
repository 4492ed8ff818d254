//! Two statements about one run that contradict each other in what a result hangs on.

use ieap_domain::drive::NOMINAL_AGREES_PART;
use ieap_domain::tag::{DISAGREEMENT, NAMES_CONTRADICT, keys};
use ieap_domain::{ClimateQuantity, RunClimate, RunRecord, Severity, Tag, TagSource};

/// Keys that every result hangs on.
pub(super) const KEYS: [&str; 4] = [
    keys::SAMPLE,
    keys::ENVIRONMENT,
    keys::VOLTAGE_V,
    keys::RELATIVE_HUMIDITY_PERCENT,
];

/// Voltages apart by more than this part of the larger one are other steps; less is what leads and read-backs lose. Chosen: five
/// times what a measured level may be off its nominal one.
const OTHER_STEP_PART: f64 = 5.0 * NOMINAL_AGREES_PART;

/// Two statements of one run that contradict each other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Doubt<'a> {
    pub run: &'a RunRecord,
    /// The stronger one, which would be used.
    pub said: &'a Tag,
    /// The other one.
    pub other: &'a Tag,
    /// Which one the readings are like: the value; none where they do not tell.
    pub like: Option<&'a Tag>,
}

impl Doubt<'_> {
    /// Whether the run waits for the answer: not where what it speaks with was measured while it went on.
    pub fn silences(&self) -> bool {
        !self.said.source.is_measured_climate()
    }
}

/// The contradiction about that key that a result could hang on.
pub(super) fn doubt<'a>(run: &'a RunRecord, key: &str) -> Option<Doubt<'a>> {
    let is_said = run.issues.iter().any(|issue| {
        let code = [DISAGREEMENT, NAMES_CONTRADICT].contains(&&issue.code[..]);
        code && issue.place == key && issue.severity == Severity::Warning
    });
    let mut tags = run.tags.iter().filter(|tag| tag.key == key);
    let said = tags.next().filter(|_| is_said)?;
    let counts = |other: &&Tag| {
        // `ieap tag` is the answer.
        said.source != TagSource::Hand
            && other.source != TagSource::EnvironmentDefault
            && is_other(run, said, other)
    };
    let other = tags.find(counts)?;
    Some(Doubt {
        run,
        said,
        other,
        like: None,
    })
}

/// Whether the run would be of another condition by the other statement.
fn is_other(run: &RunRecord, said: &Tag, other: &Tag) -> bool {
    let numbers = || Some((said.value.parse::<f64>().ok()?, other.value.parse::<f64>().ok()?));
    match (said.key.as_str(), numbers()) {
        (keys::VOLTAGE_V, Some((a, b))) => (a - b).abs() > OTHER_STEP_PART * a.abs().max(b.abs()),
        (keys::RELATIVE_HUMIDITY_PERCENT, Some((a, b))) => {
            let reach: f64 = [said, other].iter().map(|tag| reach_percent(run, tag)).sum();
            (a - b).abs() > reach
        }
        _ => said.value != other.value,
    }
}

/// How far the humidity may have been from what a source says of it, percent points: of a log how far its readings went while
/// the run did, with the sensor's accuracy where that is stated; of a label half a step of its last digit.
fn reach_percent(run: &RunRecord, tag: &Tag) -> f64 {
    let is_it = |own: &&RunClimate| {
        own.quantity == ClimateQuantity::RelativeHumidity
            && own.own_name().is_some() == (tag.source == TagSource::Column)
            && (own.chosen || tag.source == TagSource::Column)
    };
    if tag.source.is_measured_climate() {
        let logged = run.climate.iter().find(is_it);
        return logged.map_or(0.0, |own| own.largest_deviation + own.accuracy.unwrap_or(0.0));
    }
    let decimals = tag.value.split_once('.').map_or(0, |(_, behind)| behind.len());
    0.5 * 0.1_f64.powi(decimals as i32)
}

/// The one of two statements that is a reading: it was measured while the run went on.
pub(super) fn measured<'a>(doubt: &Doubt<'a>) -> Option<&'a Tag> {
    let is_measured = |tag: &&Tag| tag.source == TagSource::Channel || tag.source.is_measured_climate();
    [doubt.said, doubt.other].into_iter().find(is_measured)
}
