//! Runs that have not been made: what would be known of them.

use ieap_numerics::robust::upper_median;
use std::collections::BTreeMap;

use crate::laws::covariate::Covariate;
use crate::laws::facts::{Known, RunFacts};
use crate::laws::policy::SAME_HUMIDITY_PERCENT;
use ieap_domain::Campaign;

/// What a run is to be made with.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Setting {
    /// Sample id.
    pub sample: String,
    /// Settings that are numbers: humidity, temperature, rest.
    pub numbers: BTreeMap<Covariate, f64>,
    /// Settings that are names: environment, voltage, instrument.
    pub names: BTreeMap<Covariate, String>,
    /// Whether no run was made at this humidity yet.
    pub is_new_humidity: bool,
}

/// The material whose runs are planned.
pub struct Material<'a> {
    name: String,
    campaign: &'a Campaign,
    /// By how much what grows with use grows from run to run.
    steps: BTreeMap<Covariate, f64>,
    /// Charge that a run passes, by its voltage.
    charge: BTreeMap<String, f64>,
}

impl<'a> Material<'a> {
    /// Learns from the runs at `places` by how much age, charge and exposure grow from run to run: their medians, of
    /// the charge at each voltage.
    pub fn of(name: &str, campaign: &'a Campaign, facts: &[RunFacts], places: &[usize]) -> Material<'a> {
        let mut steps = BTreeMap::new();
        for covariate in Covariate::OF_AGE {
            let step = match covariate {
                Covariate::Cycle | Covariate::RunOrder => Some(1.0),
                other => median_step(facts, places, other),
            };
            steps.extend(step.map(|step| (covariate, step)));
        }
        Material {
            name: name.to_owned(),
            campaign,
            charge: charge_by_voltage(facts, places),
            steps,
        }
    }

    /// Adds a run made with `setting` after all others of its sample; gives its place.
    pub fn append(&self, facts: &mut Vec<RunFacts>, places: &mut Vec<usize>, setting: &Setting) {
        let own: Vec<usize> = places
            .iter()
            .copied()
            .filter(|&place| facts[place].sample == setting.sample)
            .collect();
        let fact = match self.last(facts, &own) {
            Some(last) => self.after(facts, &own, last, setting),
            None => self.first(facts, places, setting),
        };
        places.push(facts.len());
        facts.push(fact);
    }

    /// The run of a sample that was made last.
    fn last(&self, facts: &[RunFacts], own: &[usize]) -> Option<usize> {
        let order = |place: usize| {
            let number = |covariate| facts[place].numbers.get(&covariate).map(|known| known.value);
            let of = number(Covariate::RunOrder).or_else(|| number(Covariate::Cycle));
            of.unwrap_or(place as f64)
        };
        own.iter()
            .copied()
            .max_by(|&a, &b| order(a).total_cmp(&order(b)).then(a.cmp(&b)))
    }

    /// The next run of a sample: what is not set stays as it was, and what grows with use grows.
    fn after(&self, facts: &[RunFacts], own: &[usize], last: usize, setting: &Setting) -> RunFacts {
        let before = &facts[last];
        let mut fact = before.clone();
        for covariate in [Covariate::RelativeHumidity, Covariate::Temperature] {
            fact.numbers.remove(&covariate);
        }
        set(&mut fact, setting);
        for (&covariate, &step) in &self.steps {
            let largest = own
                .iter()
                .filter_map(|&place| facts[place].numbers.get(&covariate))
                .map(|known| known.value)
                .reduce(f64::max);
            let passed = match covariate {
                Covariate::ChargeBefore => self.charge_of(before),
                _ => None,
            };
            if let Some(largest) = largest {
                let grown = largest + passed.unwrap_or(step);
                fact.numbers.insert(covariate, exact(grown));
            }
        }
        if let Some(first) = fact.numbers.get_mut(&Covariate::FirstRun) {
            *first = exact(0.0);
        }
        if let Some(direction) = direction(before, &fact) {
            fact.numbers.insert(Covariate::Direction, exact(direction));
        }
        fact
    }

    /// Charge that a run like this one passes.
    fn charge_of(&self, fact: &RunFacts) -> Option<f64> {
        self.charge.get(fact.names.get(&Covariate::Voltage)?).copied()
    }

    /// The first run of a sample; nothing is known of it that no other sample's runs state.
    fn first(&self, facts: &[RunFacts], places: &[usize], setting: &Setting) -> RunFacts {
        let known = |covariate| {
            places
                .iter()
                .any(|&place| facts[place].numbers.contains_key(&covariate))
        };
        let mut fact = RunFacts {
            run: usize::MAX,
            sample: setting.sample.clone(),
            material: self.name.clone(),
            numbers: BTreeMap::new(),
            names: BTreeMap::new(),
        };
        let starts = [
            (Covariate::Cycle, 1.0),
            (Covariate::Age, 0.0),
            (Covariate::ChargeBefore, 0.0),
            (Covariate::RunOrder, 1.0),
            (Covariate::FirstRun, 1.0),
            (Covariate::Direction, 0.0),
        ];
        for (covariate, value) in starts.into_iter().filter(|&(covariate, _)| known(covariate)) {
            fact.numbers.insert(covariate, exact(value));
        }
        // Instruments and people are those of the other samples until something else is set.
        if let Some(&example) = places.last() {
            for covariate in [Covariate::Instrument, Covariate::Operator, Covariate::Calibration] {
                let name = facts[example].names.get(&covariate).cloned();
                fact.names.extend(name.map(|name| (covariate, name)));
            }
            let rest = facts[example].numbers.get(&Covariate::RestBefore).copied();
            fact.numbers
                .extend(rest.map(|rest| (Covariate::RestBefore, rest)));
        }
        let batch = self
            .campaign
            .sample(&setting.sample)
            .and_then(|sample| sample.batch.clone());
        fact.names.extend(batch.map(|batch| (Covariate::Batch, batch)));
        set(&mut fact, setting);
        fact
    }
}

fn exact(value: f64) -> Known {
    Known {
        value,
        standard_error: None,
    }
}

fn set(fact: &mut RunFacts, setting: &Setting) {
    let numbers = setting.numbers.iter();
    fact.numbers
        .extend(numbers.map(|(&covariate, &value)| (covariate, exact(value))));
    let names = setting.names.iter();
    fact.names
        .extend(names.map(|(&covariate, name)| (covariate, name.clone())));
}

/// Half where the humidity rose, minus half where it fell, else as before.
fn direction(before: &RunFacts, after: &RunFacts) -> Option<f64> {
    let earlier = before.numbers.get(&Covariate::Direction)?.value;
    let humidity = |fact: &RunFacts| {
        fact.numbers
            .get(&Covariate::RelativeHumidity)
            .map(|known| known.value)
    };
    let (Some(old), Some(new)) = (humidity(before), humidity(after)) else {
        return Some(earlier);
    };
    Some(match (new - old).abs() > SAME_HUMIDITY_PERCENT {
        true if new > old => 0.5,
        true => -0.5,
        false => earlier,
    })
}

/// Median of the charge that runs at each voltage passed: what the next run of their sample has more before it.
fn charge_by_voltage(facts: &[RunFacts], places: &[usize]) -> BTreeMap<String, f64> {
    let mut of_sample: BTreeMap<&str, Vec<(f64, &RunFacts)>> = BTreeMap::new();
    for &place in places {
        let fact = &facts[place];
        if let Some(known) = fact.numbers.get(&Covariate::ChargeBefore) {
            of_sample
                .entry(&fact.sample)
                .or_default()
                .push((known.value, fact));
        }
    }
    let mut passed: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for runs in of_sample.values_mut() {
        runs.sort_by(|a, b| a.0.total_cmp(&b.0));
        for pair in runs.windows(2) {
            if let Some(voltage) = pair[0].1.names.get(&Covariate::Voltage) {
                passed
                    .entry(voltage.clone())
                    .or_default()
                    .push(pair[1].0 - pair[0].0);
            }
        }
    }
    passed
        .into_iter()
        .filter_map(|(voltage, mut charges)| Some((voltage, upper_median(&mut charges)?)))
        .collect()
}

/// Median growth of a number from one run of a sample to the next.
fn median_step(facts: &[RunFacts], places: &[usize], covariate: Covariate) -> Option<f64> {
    let mut of_sample: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for &place in places {
        if let Some(known) = facts[place].numbers.get(&covariate) {
            of_sample
                .entry(&facts[place].sample)
                .or_default()
                .push(known.value);
        }
    }
    let mut steps: Vec<f64> = Vec::new();
    for values in of_sample.values_mut() {
        values.sort_by(f64::total_cmp);
        steps.extend(values.windows(2).map(|pair| pair[1] - pair[0]));
    }
    upper_median(&mut steps)
}
