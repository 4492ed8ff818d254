//! The reference condition: runs that return to it show what stays, whatever the air does between them.

use std::collections::BTreeMap;

use super::policy::{FEWEST_RUNS, TEMPERATURE_TOLERANCE_C};
use crate::groups::HUMIDITY_TOLERANCE_PERCENT;
use crate::laws::covariate::Covariate;
use crate::laws::facts::RunFacts;
use ieap_domain::number::fixed;
use ieap_domain::tag::keys;
use ieap_domain::{MonitoringRules, RunRecord};

/// The reference condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// In words: `air, 2.00 V, 34 % RH`.
    pub text: String,
    /// Whether campaign.toml names it.
    pub is_named: bool,
    /// Facts of its runs.
    pub places: Vec<usize>,
    /// Facts of the run that all of them are like; none where campaign.toml names it.
    center: Option<usize>,
}

impl Reference {
    /// Whether a run that is not among `facts` was made in it; `fact` is what is known of that run.
    pub fn holds(
        &self,
        run: &RunRecord,
        fact: &RunFacts,
        facts: &[RunFacts],
        rules: &MonitoringRules,
    ) -> bool {
        match self.center {
            Some(center) => alike(&facts[center], fact),
            None => is_named(run, rules),
        }
    }
}

/// The reference that campaign.toml names, or the condition that a sample was measured in most often. Else the reason
/// why there is none.
pub fn reference(
    runs: &[RunRecord],
    facts: &[RunFacts],
    rules: &MonitoringRules,
) -> Result<Reference, String> {
    let found = if rules.reference.is_empty() {
        most_repeated(facts)
    } else {
        Some(named(runs, facts, rules))
    };
    let most = |reference: &Reference| {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for &place in &reference.places {
            *counts.entry(&facts[place].sample).or_default() += 1;
        }
        counts.into_values().max().unwrap_or(0)
    };
    match found {
        Some(reference) if most(&reference) >= FEWEST_RUNS => Ok(reference),
        Some(reference) if reference.is_named => Err(format!(
            "the reference condition ({}) has {} runs of one sample at most; {FEWEST_RUNS} are needed",
            reference.text,
            most(&reference)
        )),
        _ => Err(format!(
            "no sample returned to one condition {FEWEST_RUNS} times; repeat a run now and then, and name its condition in [monitoring]"
        )),
    }
}

fn named(runs: &[RunRecord], facts: &[RunFacts], rules: &MonitoringRules) -> Reference {
    let words: Vec<String> = rules
        .reference
        .iter()
        .map(|(key, value)| words_of(key, value))
        .collect();
    Reference {
        text: words.join(", "),
        is_named: true,
        places: (0..facts.len())
            .filter(|&place| is_named(&runs[facts[place].run], rules))
            .collect(),
        center: None,
    }
}

/// `35 % RH` of a tag of campaign.toml.
fn words_of(key: &str, value: &str) -> String {
    match key {
        keys::ENVIRONMENT => value.to_owned(),
        keys::RELATIVE_HUMIDITY_PERCENT => format!("{value} % RH"),
        keys::VOLTAGE_V => format!("{value} V"),
        keys::TEMPERATURE_C => format!("{value} °C"),
        key => format!("{} {value}", key.replace('_', " ")),
    }
}

/// Whether a run was made in the condition that campaign.toml names.
fn is_named(run: &RunRecord, rules: &MonitoringRules) -> bool {
    rules.reference.iter().all(|(key, wanted)| {
        let Some(found) = run.tag(key) else {
            return false;
        };
        match (found.parse::<f64>(), wanted.parse::<f64>()) {
            (Ok(found), Ok(wanted)) => (found - wanted).abs() <= tolerance(key, wanted),
            _ => found == wanted,
        }
    })
}

fn tolerance(key: &str, wanted: f64) -> f64 {
    match key {
        keys::RELATIVE_HUMIDITY_PERCENT => HUMIDITY_TOLERANCE_PERCENT,
        keys::TEMPERATURE_C => TEMPERATURE_TOLERANCE_C,
        _ => 1e-6 * wanted.abs().max(1.0),
    }
}

/// Environment, voltage and humidity (within the tolerance about each run's own) that most runs of one sample share.
fn most_repeated(facts: &[RunFacts]) -> Option<Reference> {
    let mut of_sample: BTreeMap<&str, Vec<&RunFacts>> = BTreeMap::new();
    for fact in facts {
        of_sample.entry(&fact.sample).or_default().push(fact);
    }
    let repeats = |fact: &RunFacts| {
        let own = of_sample[fact.sample.as_str()].iter();
        own.filter(|other| alike(fact, other)).count()
    };
    let counts: Vec<usize> = facts.iter().map(repeats).collect();
    let most = counts.iter().copied().max()?;
    let place = counts.iter().position(|count| *count == most)?;
    let center = &facts[place];
    let mut words: Vec<String> = Vec::new();
    words.extend(center.names.get(&Covariate::Environment).cloned());
    words.extend(
        center
            .names
            .get(&Covariate::Voltage)
            .map(|volts| format!("{volts} V")),
    );
    words.extend(humidity(center).map(|percent| format!("{} % RH", fixed(percent, 0))));
    Some(Reference {
        text: words.join(", "),
        is_named: false,
        places: (0..facts.len())
            .filter(|&place| alike(center, &facts[place]))
            .collect(),
        center: Some(place),
    })
}

fn humidity(fact: &RunFacts) -> Option<f64> {
    fact.numbers
        .get(&Covariate::RelativeHumidity)
        .map(|known| known.value)
}

/// Whether two runs were made in the same environment, at the same voltage and humidity.
fn alike(a: &RunFacts, b: &RunFacts) -> bool {
    let same = |covariate| a.names.get(&covariate) == b.names.get(&covariate);
    let near = match (humidity(a), humidity(b)) {
        (Some(a), Some(b)) => (a - b).abs() <= HUMIDITY_TOLERANCE_PERCENT,
        (None, None) => true,
        _ => false,
    };
    same(Covariate::Environment) && same(Covariate::Voltage) && near
}
