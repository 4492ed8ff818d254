//! The runs of a material in their conditions: numbers of them become what the mixed model takes, whatever is asked about.

use std::collections::BTreeMap;

use super::measured::{Bound, Cell, Measured, Value};
use crate::conditions::Conditions;
use crate::laws::facts::RunFacts;

/// The runs of a material in their conditions.
pub(super) struct Placed<'a> {
    pub facts: &'a [RunFacts],
    /// Conditions of its runs, by their places among the facts.
    pub cells: BTreeMap<usize, Cell>,
    /// Places of surroundings that hold no water.
    dry: Vec<usize>,
}

impl<'a> Placed<'a> {
    pub fn new(conditions: &Conditions, facts: &'a [RunFacts], material: usize) -> Placed<'a> {
        let mut cell_of: BTreeMap<usize, Cell> = BTreeMap::new();
        for condition in conditions.measured.iter().filter(|own| own.material == material) {
            let cell = (condition.surroundings, condition.voltage);
            cell_of.extend(condition.runs.iter().map(|&run| (run, cell)));
        }
        let placed = facts.iter().enumerate();
        let surroundings = conditions.surroundings.iter().enumerate();
        Placed {
            facts,
            cells: placed
                .filter_map(|(place, fact)| Some((place, *cell_of.get(&fact.run)?)))
                .collect(),
            dry: surroundings
                .filter(|(_, own)| own.is_dry())
                .map(|(at, _)| at)
                .collect(),
        }
    }

    /// Numbers with their variances, by place, over the conditions; `stated`: the variance from run to run that campaign.toml
    /// states, on their scale.
    pub fn measured(
        &self,
        found: &BTreeMap<usize, (f64, f64)>,
        bounds: BTreeMap<Cell, Bound>,
        stated: Option<f64>,
    ) -> Measured {
        let facts = self.facts;
        let mut samples: Vec<&str> = found.keys().map(|&place| facts[place].sample.as_str()).collect();
        samples.sort_unstable();
        samples.dedup();
        let value = |(&place, &(y, variance)): (&usize, &(f64, f64))| Value {
            place,
            sample: samples.binary_search(&facts[place].sample.as_str()).unwrap_or(0),
            cell: self.cells[&place],
            humidity_percent: humidity_percent(&facts[place]),
            y,
            variance,
            weight: 1.0,
            off: None,
        };
        Measured::new(found.iter().map(value).collect(), bounds, &self.dry, stated)
    }
}

fn humidity_percent(fact: &RunFacts) -> Option<f64> {
    let known = fact.numbers.get(&crate::laws::Covariate::RelativeHumidity)?;
    Some(known.value)
}
