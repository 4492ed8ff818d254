//! What is known of every run that a parameter may follow.

use std::collections::BTreeMap;

use super::covariate::{Covariate, DeclaredTag, Kind};
use super::policy::{FEWEST_OF_A_KIND, SAME_HUMIDITY_PERCENT};
use crate::conditions::nominal_voltage_v;
use ieap_domain::number::digits;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, ClimateQuantity, RunRecord};

/// A stated accuracy is the half-width of an even distribution: its standard deviation is this part of it.
const EVEN: f64 = 0.577_350_269_189_625_8;

/// A number with its standard error; none where nothing states one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Value in the covariate's unit.
    pub value: f64,
    /// Standard error that is the run's own: what differs from run to run.
    pub standard_error: Option<f64>,
}

/// One run as laws see it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RunFacts {
    /// Index of the run.
    pub run: usize,
    /// Sample id.
    pub sample: String,
    /// Material of the sample; the sample itself where campaign.toml lacks it.
    pub material: String,
    /// Numbers.
    pub numbers: BTreeMap<Covariate, Known>,
    /// Names.
    pub names: BTreeMap<Covariate, String>,
}

/// Facts of every run that has a sample, in the order of the runs.
pub fn facts(runs: &[RunRecord], campaign: &Campaign) -> Vec<RunFacts> {
    let declared = declared(runs, &campaign.extra_tags);
    let mut facts: Vec<RunFacts> = runs
        .iter()
        .enumerate()
        .filter_map(|(index, run)| of_run(index, run, campaign, &declared))
        .collect();
    add_history(&mut facts, runs);
    facts
}

/// Facts of a run that is not among `runs`: what it states of itself, and where it would stand among those of its sample,
/// whose facts are `known` and stay as they are. As it counts for none of them it stands between two in their order. The
/// way of the humidity to it is not among them. The index of the run is 0.
pub fn facts_beside(
    run: &RunRecord,
    runs: &[RunRecord],
    known: &[RunFacts],
    campaign: &Campaign,
) -> Option<RunFacts> {
    let mut fact = of_run(0, run, campaign, &declared(runs, &campaign.extra_tags))?;
    let mates: Vec<&RunFacts> = known.iter().filter(|mate| mate.sample == fact.sample).collect();
    let exact = |value: f64| Known {
        value,
        standard_error: None,
    };
    let starts: Option<Vec<f64>> = mates.iter().map(|mate| start_s(&runs[mate.run])).collect();
    let started = start_s(run).zip(starts);
    if let Some((start, starts)) = &started
        && let Some(first) = starts.iter().copied().reduce(f64::min)
    {
        fact.numbers
            .insert(Covariate::Age, exact((start - first) / 3600.0));
    }
    let cycle = |fact: &RunFacts| fact.numbers.get(&Covariate::Cycle).map(|known| known.value);
    let cycles: Option<Vec<f64>> = mates.iter().map(|mate| cycle(mate)).collect();
    if let Some((own, others)) = started.or_else(|| cycle(&fact).zip(cycles)) {
        let before = others.iter().filter(|other| **other < own).count();
        fact.numbers
            .insert(Covariate::RunOrder, exact(before as f64 + 0.5));
    }
    Some(fact)
}

/// The covariate of each declared tag: of numbers where every value that a run states is one, else of names.
fn declared<'k>(runs: &[RunRecord], extra: &'k [String]) -> Vec<(&'k str, Covariate)> {
    let covariate = |key: &'k String| {
        let mut stated = runs.iter().filter(|run| run.tag(key).is_some());
        let are_numbers = stated.all(|run| run.tag_number(key).is_some());
        let built_in = Covariate::ALL.into_iter().find(|known| known.key() == key);
        let tag = DeclaredTag::of(key);
        (
            key.as_str(),
            match built_in {
                Some(known) => known,
                None if are_numbers => Covariate::TagNumber(tag),
                None => Covariate::TagName(tag),
            },
        )
    };
    extra.iter().map(covariate).collect()
}

fn of_run(
    index: usize,
    run: &RunRecord,
    campaign: &Campaign,
    declared: &[(&str, Covariate)],
) -> Option<RunFacts> {
    let sample = run.tag(keys::SAMPLE)?;
    let known = campaign.sample(sample);
    let mut numbers = BTreeMap::new();
    let mut number = |covariate, found: Option<Known>| {
        if let Some(found) = found {
            numbers.insert(covariate, found);
        }
    };
    number(
        Covariate::RelativeHumidity,
        climate(
            run,
            ClimateQuantity::RelativeHumidity,
            keys::RELATIVE_HUMIDITY_PERCENT,
        ),
    );
    number(
        Covariate::Temperature,
        climate(run, ClimateQuantity::Temperature, keys::TEMPERATURE_C),
    );
    let exact = |value: f64| Known {
        value,
        standard_error: None,
    };
    for (covariate, key) in [
        (Covariate::Cycle, keys::CYCLE),
        (Covariate::RestBefore, keys::REST_BEFORE_S),
        (Covariate::Exposure, keys::EXPOSURE_H),
    ] {
        number(covariate, run.tag_number(key).map(exact));
    }
    let mut names = BTreeMap::new();
    for (covariate, key) in [
        (Covariate::Environment, keys::ENVIRONMENT),
        (Covariate::Instrument, keys::INSTRUMENT),
        (Covariate::Operator, keys::OPERATOR),
        (Covariate::Calibration, keys::CALIBRATION),
    ] {
        if let Some(name) = run.tag(key) {
            names.insert(covariate, name.to_owned());
        }
    }
    if let Some(volts) = nominal_voltage_v(run) {
        names.insert(Covariate::Voltage, digits(volts + 0.0, 2));
    }
    if let Some(batch) = known.and_then(|sample| sample.batch.clone()) {
        names.insert(Covariate::Batch, batch);
    }
    for &(key, covariate) in declared {
        match covariate.kind() {
            Kind::Number => numbers.extend(run.tag_number(key).map(|value| (covariate, exact(value)))),
            Kind::Category => names.extend(run.tag(key).map(|name| (covariate, name.to_owned()))),
        }
    }
    Some(RunFacts {
        run: index,
        sample: sample.to_owned(),
        material: known.map_or(sample, |sample| &sample.material).to_owned(),
        numbers,
        names,
    })
}

/// The tag with the uncertainty of the readings that it came from. A label carries none.
fn climate(run: &RunRecord, quantity: ClimateQuantity, key: &str) -> Option<Known> {
    let value = run.tag_number(key)?;
    let measured = run
        .climate
        .iter()
        .find(|climate| climate.chosen && climate.quantity == quantity);
    let is_measured = run
        .tags
        .iter()
        .find(|tag| tag.key == key)
        .is_some_and(|tag| tag.source.is_measured_climate());
    let standard_error = measured.filter(|_| is_measured).and_then(|measured| {
        let parts = [
            measured.standard_deviation,
            measured.accuracy.map(|accuracy| accuracy * EVEN),
        ];
        let square: f64 = parts.iter().flatten().map(|part| part * part).sum();
        (square > 0.0).then(|| square.sqrt())
    });
    Some(Known {
        value,
        standard_error,
    })
}

/// Adds what follows from the order of each sample's runs. Without starts the cycle gives the order; where neither
/// does, nothing is added.
fn add_history(facts: &mut [RunFacts], runs: &[RunRecord]) {
    let mut samples: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (place, fact) in facts.iter().enumerate() {
        samples.entry(fact.sample.clone()).or_default().push(place);
    }
    let (mut first_runs, mut rises, mut falls) = (Vec::new(), 0, 0);
    for places in samples.values() {
        let Some(ordered) = in_order(places, facts, runs) else {
            continue;
        };
        let first_start = start_s(&runs[facts[ordered[0]].run]);
        for (order, &place) in ordered.iter().enumerate() {
            let run = facts[place].run;
            let exact = |value: f64| Known {
                value,
                standard_error: None,
            };
            let numbers = &mut facts[place].numbers;
            numbers.insert(Covariate::RunOrder, exact((order + 1) as f64));
            numbers.insert(Covariate::FirstRun, exact(if order == 0 { 1.0 } else { 0.0 }));
            first_runs.extend((order == 0).then_some(place));
            if let (Some(first), Some(start)) = (first_start, start_s(&runs[run])) {
                numbers.insert(Covariate::Age, exact((start - first) / 3600.0));
            }
        }
        for (place, direction) in directions(&ordered, facts) {
            rises += usize::from(direction > 0.0);
            falls += usize::from(direction < 0.0);
            let known = Known {
                value: direction,
                standard_error: None,
            };
            facts[place].numbers.insert(Covariate::Direction, known);
        }
    }
    let forget = |facts: &mut [RunFacts], covariate| {
        for fact in facts {
            fact.numbers.remove(&covariate);
        }
    };
    if first_runs.len() < FEWEST_OF_A_KIND {
        forget(facts, Covariate::FirstRun);
    }
    if rises.min(falls) < FEWEST_OF_A_KIND {
        forget(facts, Covariate::Direction);
    }
}

/// Half for runs to which the humidity rose, minus half where it fell; a run at the humidity of the one before goes
/// with it, and before any change there is neither.
fn directions(ordered: &[usize], facts: &[RunFacts]) -> Vec<(usize, f64)> {
    let mut found = Vec::new();
    let (mut level, mut direction): (Option<f64>, f64) = (None, 0.0);
    for &place in ordered {
        let Some(humidity) = facts[place].numbers.get(&Covariate::RelativeHumidity) else {
            continue;
        };
        match level {
            Some(before) if (humidity.value - before).abs() > SAME_HUMIDITY_PERCENT => {
                direction = if humidity.value > before { 0.5 } else { -0.5 };
                level = Some(humidity.value);
            }
            Some(_) => {}
            None => level = Some(humidity.value),
        }
        found.push((place, direction));
    }
    found
}

/// Places of one sample in the order in which they were measured: by start, else by cycle.
pub(super) fn in_order(places: &[usize], facts: &[RunFacts], runs: &[RunRecord]) -> Option<Vec<usize>> {
    let by = |key: &dyn Fn(usize) -> Option<f64>| -> Option<Vec<usize>> {
        let mut keyed: Vec<(f64, usize)> = places
            .iter()
            .map(|&place| Some((key(place)?, place)))
            .collect::<Option<_>>()?;
        keyed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let distinct = keyed.windows(2).all(|pair| pair[0].0 < pair[1].0);
        distinct.then(|| keyed.into_iter().map(|(_, place)| place).collect())
    };
    by(&|place| start_s(&runs[facts[place].run])).or_else(|| {
        by(&|place| {
            facts[place]
                .numbers
                .get(&Covariate::Cycle)
                .map(|known| known.value)
        })
    })
}

/// When a run was started, s since 1970 UTC, where a tag says it.
pub fn start_s(run: &RunRecord) -> Option<f64> {
    let start: jiff::Timestamp = run.tag(keys::STARTED_AT)?.parse().ok()?;
    Some(start.as_millisecond() as f64 / 1000.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{campaign, run, tag};

    #[test]
    fn history_follows_from_starts_and_from_cycles() {
        let mut runs: Vec<RunRecord> = ["c", "a", "b"]
            .iter()
            .map(|name| run(name, "CNaf-01", "air", Some(34.0), 2.0))
            .collect();
        for (run, cycle) in runs.iter_mut().zip(["3", "1", "2"]) {
            run.tags.push(tag(keys::CYCLE, cycle));
        }
        let found = facts(&runs, &campaign());
        let of = |k: usize, covariate| found[k].numbers.get(&covariate).map(|known| known.value);
        // One first run cannot be told from a run.
        assert_eq!(of(1, Covariate::FirstRun), None);
        assert_eq!(of(0, Covariate::RunOrder), Some(3.0));
        assert_eq!(of(0, Covariate::Age), None);
        for (run, hour) in runs.iter_mut().zip([0, 1, 5]) {
            run.tags
                .push(tag(keys::STARTED_AT, &format!("2026-11-20T{hour:02}:00:00Z")));
        }
        let found = facts(&runs, &campaign());
        let ages: Vec<f64> = found
            .iter()
            .map(|fact| fact.numbers[&Covariate::Age].value)
            .collect();
        assert_eq!(ages, [0.0, 1.0, 5.0]);
    }

    #[test]
    fn a_run_beside_the_others_stands_between_them_and_moves_none() {
        let of = |name: &str, hour: u32| {
            let mut run = run(name, "CNaf-01", "air", Some(34.0), 2.0);
            let start = format!("2026-11-20T{hour:02}:00:00Z");
            run.tags.push(tag(keys::STARTED_AT, &start));
            run
        };
        let runs = [of("a", 4), of("b", 8)];
        let known = facts(&runs, &campaign());
        let beside = |hour| facts_beside(&of("odd", hour), &runs, &known, &campaign()).unwrap();
        let of = |hour, covariate| beside(hour).numbers.get(&covariate).map(|known| known.value);
        assert_eq!(of(6, Covariate::RunOrder), Some(1.5));
        assert_eq!(of(6, Covariate::Age), Some(2.0));
        assert_eq!(of(9, Covariate::RunOrder), Some(2.5));
        assert_eq!(of(1, Covariate::Age), Some(-3.0));
    }

    #[test]
    fn a_declared_tag_is_a_number_where_all_its_values_are_and_an_undeclared_one_is_nothing() {
        let mut runs: Vec<RunRecord> = ["a", "b"]
            .iter()
            .map(|name| run(name, "CNaf-01", "air", Some(34.0), 2.0))
            .collect();
        for (run, values) in runs.iter_mut().zip([["10", "1", "x"], ["20", "left", "y"]]) {
            for (key, value) in ["pre_charge_s", "specimen", "mood"].iter().zip(values) {
                run.tags.push(tag(key, value));
            }
        }
        let mut stated = campaign();
        stated.extra_tags = vec!["pre_charge_s".to_owned(), "specimen".to_owned()];
        let found = facts(&runs, &stated);
        let number = Covariate::TagNumber(DeclaredTag::of("pre_charge_s"));
        let name = Covariate::TagName(DeclaredTag::of("specimen"));
        assert_eq!(found[1].numbers[&number].value, 20.0);
        assert_eq!(found[1].names[&name], "left");
        let keys = found[1].names.keys().chain(found[1].numbers.keys());
        assert!(keys.map(|covariate| covariate.key()).all(|key| key != "mood"));
    }

    #[test]
    fn runs_that_nothing_orders_have_no_history() {
        let runs = [
            run("a", "CNaf-01", "air", Some(34.0), 2.0),
            run("b", "CNaf-01", "air", Some(34.0), 2.0),
        ];
        let found = facts(&runs, &campaign());
        assert!(!found[0].numbers.contains_key(&Covariate::RunOrder));
        assert_eq!(
            found[0].numbers[&Covariate::RelativeHumidity].standard_error,
            None
        );
    }
}
