//! Runs that could be made on the samples of a material: in conditions that it was measured in and, where the humidity is
//! tied, at a humidity between those.

use std::collections::{BTreeMap, BTreeSet};

use super::future::Setting;
use super::policy::{MOST_CANDIDATES, MOST_SAMPLES, NEAR_THE_OTHER, ONE_LEVEL};
use crate::laws::covariate::Covariate;
use crate::laws::facts::RunFacts;
use ieap_domain::Campaign;

/// A condition of the design.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// Humidity and temperature, where they are stated.
    pub numbers: BTreeMap<Covariate, f64>,
    /// Environment and voltage.
    pub names: BTreeMap<Covariate, String>,
    /// Whether no run was made at this humidity yet.
    pub is_new_humidity: bool,
    /// Mean place among the runs of a sample.
    order: f64,
}

/// The conditions that the runs at `places` were made in, in the order in which they were first gone through.
pub fn conditions(facts: &[RunFacts], places: &[usize]) -> Vec<Condition> {
    let humidity = Levels::of(facts, places, Covariate::RelativeHumidity);
    let temperature = Levels::of(facts, places, Covariate::Temperature);
    let mut found: BTreeMap<String, (Condition, f64)> = BTreeMap::new();
    for &place in places {
        let fact = &facts[place];
        let mut numbers = BTreeMap::new();
        for levels in [&humidity, &temperature] {
            let number = fact.numbers.get(&levels.covariate);
            numbers.extend(number.map(|known| (levels.covariate, levels.level(known.value))));
        }
        let mut names = BTreeMap::new();
        for covariate in [Covariate::Environment, Covariate::Voltage] {
            let name = fact.names.get(&covariate).cloned();
            names.extend(name.map(|name| (covariate, name)));
        }
        let order = fact
            .numbers
            .get(&Covariate::RunOrder)
            .map_or(place as f64, |known| known.value);
        let condition = Condition {
            numbers,
            names,
            is_new_humidity: false,
            order: 0.0,
        };
        let key = format!("{condition:?}");
        let entry = found.entry(key).or_insert((condition, 0.0));
        entry.0.order += order;
        entry.1 += 1.0;
    }
    let mut conditions: Vec<Condition> = found
        .into_values()
        .map(|(mut condition, count)| {
            condition.order /= count;
            condition
        })
        .collect();
    conditions.sort_by(|a, b| a.order.total_cmp(&b.order));
    conditions
}

/// Candidates for one step of a plan: single runs, and, on a sample that has none yet, the last condition followed
/// by the first.
pub fn candidates(
    facts: &[RunFacts],
    places: &[usize],
    campaign: &Campaign,
    set: &[Covariate],
) -> Vec<Vec<Setting>> {
    let conditions = conditions(facts, places);
    let between = if set.contains(&Covariate::RelativeHumidity) {
        new_humidities(&conditions)
    } else {
        Vec::new()
    };
    let variants: Vec<Condition> = conditions
        .iter()
        .chain(&between)
        .flat_map(|condition| variants(condition, facts, places, set))
        .collect();
    let measured = samples(
        facts,
        places,
        (MOST_CANDIDATES / variants.len().max(1)).clamp(1, MOST_SAMPLES),
    );
    let mut candidates: Vec<Vec<Setting>> = Vec::new();
    for sample in &measured {
        candidates.extend(variants.iter().map(|condition| vec![setting(sample, condition)]));
    }
    if let (Some(sample), Some(first), Some(last)) = (
        unused(facts, places, campaign),
        conditions.first(),
        conditions.last(),
    ) && first != last
    {
        candidates.push(vec![setting(&sample, last), setting(&sample, first)]);
    }
    candidates
}

fn setting(sample: &str, condition: &Condition) -> Setting {
    Setting {
        sample: sample.to_owned(),
        numbers: condition.numbers.clone(),
        names: condition.names.clone(),
        is_new_humidity: condition.is_new_humidity,
    }
}

/// Conditions at a humidity that was not measured yet: of each environment that is not dry, a place in the widest gap
/// between the levels of the campaign that one of its own levels ends. Half way between two of its own, else nearer to that
/// of the other environment.
fn new_humidities(conditions: &[Condition]) -> Vec<Condition> {
    let humidity = |one: &Condition| one.numbers.get(&Covariate::RelativeHumidity).copied();
    let mut levels: Vec<f64> = conditions.iter().filter_map(humidity).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let mut of_environment: BTreeMap<Option<&String>, Vec<&Condition>> = BTreeMap::new();
    for one in conditions.iter().filter(|one| humidity(one).is_some()) {
        let environment = one.names.get(&Covariate::Environment);
        of_environment.entry(environment).or_default().push(one);
    }
    let mut new: Vec<Condition> = Vec::new();
    for own in of_environment.values() {
        let is_own = |level: f64| own.iter().any(|one| humidity(one) == Some(level));
        // What is kept dry, a vacuum say, cannot be made humid.
        if own.iter().all(|one| humidity(one) <= Some(ONE_LEVEL)) {
            continue;
        }
        let gaps = levels.windows(2).map(|pair| (pair[0], pair[1]));
        let gaps = gaps.filter(|&(low, high)| high - low > 2.0 * ONE_LEVEL && (is_own(low) || is_own(high)));
        let Some((low, high)) = gaps.max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0))) else {
            continue;
        };
        for one in own {
            let mut at_new = (*one).clone();
            let part = match (is_own(low), is_own(high)) {
                (true, true) => 0.5,
                (false, _) => NEAR_THE_OTHER,
                (_, false) => 1.0 - NEAR_THE_OTHER,
            };
            let between = (low + part * (high - low)).round();
            at_new.numbers.insert(Covariate::RelativeHumidity, between);
            at_new.is_new_humidity = true;
            if !new.iter().any(|known| known.names == at_new.names) {
                new.push(at_new);
            }
        }
    }
    new
}

/// The condition with every level of what else can be set and is tied: rest, instrument, calibration, operator.
fn variants(
    condition: &Condition,
    facts: &[RunFacts],
    places: &[usize],
    set: &[Covariate],
) -> Vec<Condition> {
    let mut variants = vec![condition.clone()];
    if set.contains(&Covariate::RestBefore) {
        let rests = places
            .iter()
            .filter_map(|&place| facts[place].numbers.get(&Covariate::RestBefore));
        let rests: Vec<f64> = rests.map(|known| known.value).collect();
        let ends = [f64::min, f64::max].map(|end| rests.iter().copied().reduce(end));
        variants = with(&variants, ends.into_iter().flatten(), |one, rest| {
            one.numbers.insert(Covariate::RestBefore, rest);
        });
    }
    for covariate in [Covariate::Instrument, Covariate::Calibration, Covariate::Operator] {
        if !set.contains(&covariate) {
            continue;
        }
        let names = places
            .iter()
            .filter_map(|&place| facts[place].names.get(&covariate));
        let names: BTreeSet<&String> = names.collect();
        variants = with(&variants, names.into_iter(), |one, name| {
            one.names.insert(covariate, name.clone());
        });
    }
    variants
}

fn with<T: Copy>(
    conditions: &[Condition],
    levels: impl Iterator<Item = T>,
    put: impl Fn(&mut Condition, T),
) -> Vec<Condition> {
    let levels: Vec<T> = levels.collect();
    let of = |condition: &Condition| {
        let mut of_condition = Vec::new();
        for &level in &levels {
            let mut one = condition.clone();
            put(&mut one, level);
            of_condition.push(one);
        }
        of_condition
    };
    conditions.iter().flat_map(of).collect()
}

/// Samples to plan on: one of each batch before a second of any, those with the most runs first.
fn samples(facts: &[RunFacts], places: &[usize], most: usize) -> Vec<String> {
    let mut runs: BTreeMap<&str, usize> = BTreeMap::new();
    let mut batch: BTreeMap<&str, &str> = BTreeMap::new();
    for &place in places {
        let fact = &facts[place];
        *runs.entry(&fact.sample).or_insert(0) += 1;
        let own = fact.names.get(&Covariate::Batch).map_or("", String::as_str);
        batch.insert(&fact.sample, own);
    }
    let mut of_batch: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    let mut ordered: Vec<&str> = runs.keys().copied().collect();
    ordered.sort_by(|a, b| runs[b].cmp(&runs[a]).then(a.cmp(b)));
    for sample in ordered {
        of_batch.entry(batch[sample]).or_default().push(sample);
    }
    let longest = of_batch.values().map(Vec::len).max().unwrap_or(0);
    let in_turn = (0..longest).flat_map(|k| of_batch.values().filter_map(move |list| list.get(k)));
    in_turn.take(most).map(|sample| (*sample).to_owned()).collect()
}

/// A sample of the material in campaign.toml that has no run yet.
fn unused(facts: &[RunFacts], places: &[usize], campaign: &Campaign) -> Option<String> {
    let material = &facts[*places.first()?].material;
    let is_used = |id: &str| facts.iter().any(|fact| fact.sample == id);
    let of_material = campaign
        .samples
        .iter()
        .filter(|sample| sample.material == *material);
    let mut unused = of_material.filter(|sample| !is_used(&sample.id));
    unused.next().map(|sample| sample.id.clone())
}

/// Levels of a measured number: clusters of its values, each with its median.
struct Levels {
    covariate: Covariate,
    /// Largest value and median of each, rising.
    levels: Vec<(f64, f64)>,
}

impl Levels {
    fn of(facts: &[RunFacts], places: &[usize], covariate: Covariate) -> Levels {
        let mut values: Vec<f64> = places
            .iter()
            .filter_map(|&place| facts[place].numbers.get(&covariate))
            .map(|known| known.value)
            .collect();
        values.sort_by(f64::total_cmp);
        let mut levels = Vec::new();
        let mut from = 0;
        for at in 0..values.len() {
            let ends = values
                .get(at + 1)
                .is_none_or(|next| next - values[at] > ONE_LEVEL);
            if ends {
                levels.push((values[at], values[(from + at) / 2]));
                from = at + 1;
            }
        }
        Levels { covariate, levels }
    }

    fn level(&self, value: f64) -> f64 {
        let mut levels = self.levels.iter();
        levels
            .find(|(largest, _)| value <= *largest)
            .map_or(value, |(_, median)| *median)
    }
}
