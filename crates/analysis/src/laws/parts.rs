//! Runs of a material that are asked together: all of them, and for a covariate that some do not state, those that do.
//!
//! A run that does not state the humidity says nothing of what follows it. Put at the mean it would pull the law, and
//! left to a rule of the whole material a few such runs would take the question from all others.

use std::collections::{BTreeMap, BTreeSet};

use super::covariate::Covariate;
use super::design::{Level, Rows, rows};
use super::facts::RunFacts;
use super::policy::FEWEST_STATING;

/// Runs that are asked together, and what is asked of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The runs, as indices in the facts.
    pub places: Vec<usize>,
    /// Whether these are all runs of the material.
    pub is_whole: bool,
    /// Covariates that it is made for: those that some of the other runs do not state.
    covariates: BTreeSet<Covariate>,
    /// Rows within samples.
    pub within: Rows,
    /// Rows between samples.
    pub between: Rows,
    /// Covariates to ask about, those together that the design ties.
    pub sets: Vec<(Level, Vec<Covariate>)>,
}

/// A covariate that some runs do not state.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Lacking {
    /// Material.
    pub material: String,
    /// The covariate.
    pub covariate: Covariate,
    /// Runs that do not state it, as indices of runs; of [`Part::lacking`] as places among those of the material.
    pub without: Vec<usize>,
    /// Runs of the material.
    pub runs: usize,
    /// Environments of the runs that do not state it.
    pub environments: Vec<String>,
}

/// All runs first, then those that state what others do not.
pub fn parts(facts: &[RunFacts], places: &[usize]) -> Vec<Part> {
    let mut whole = Part::new(facts, places.to_vec(), BTreeSet::new());
    let stating = partly_stated(facts, places).into_iter();
    let mut parts: Vec<Part> = stating
        .map(|(places, covariates)| Part::new(facts, places, covariates))
        .filter(|part| !part.sets.is_empty())
        .collect();
    // What is tied to such a covariate is one question with it, and is asked where both are known.
    let elsewhere: BTreeSet<Covariate> = parts
        .iter()
        .flat_map(|part| part.sets.iter().flat_map(|(_, set)| set.iter().copied()))
        .collect();
    for (_, set) in &mut whole.sets {
        set.retain(|covariate| !elsewhere.contains(covariate));
    }
    whole.sets.retain(|(_, set)| !set.is_empty());
    parts.insert(0, whole);
    parts
}

/// Covariates that some runs do not state, by the runs that do, where these are enough.
fn partly_stated(facts: &[RunFacts], places: &[usize]) -> BTreeMap<Vec<usize>, BTreeSet<Covariate>> {
    let mut stating: BTreeMap<Covariate, Vec<usize>> = BTreeMap::new();
    for &place in places {
        let fact = &facts[place];
        for &covariate in fact.numbers.keys().chain(fact.names.keys()) {
            stating.entry(covariate).or_default().push(place);
        }
    }
    let mut parts: BTreeMap<Vec<usize>, BTreeSet<Covariate>> = BTreeMap::new();
    for (covariate, stating) in stating {
        if covariate.is_stated() && (FEWEST_STATING..places.len()).contains(&stating.len()) {
            parts.entry(stating).or_default().insert(covariate);
        }
    }
    parts
}

impl Part {
    fn new(facts: &[RunFacts], places: Vec<usize>, covariates: BTreeSet<Covariate>) -> Part {
        let [within, between] = rows(facts, &places);
        let is_whole = covariates.is_empty();
        let is_asked = |set: &&Vec<Covariate>| is_whole || set.iter().any(|one| covariates.contains(one));
        let sets = [&within, &between].into_iter().flat_map(|rows| {
            let asked = rows.sets.iter().filter(is_asked);
            asked.map(|set| (rows.level, set.clone()))
        });
        Part {
            sets: sets.collect(),
            places,
            is_whole,
            covariates,
            within,
            between,
        }
    }

    /// Rows at that level.
    pub fn rows(&self, level: Level) -> &Rows {
        match level {
            Level::Within => &self.within,
            Level::Between => &self.between,
        }
    }

    /// Covariates that differ and are asked here, those within samples first.
    pub fn differing(&self) -> impl Iterator<Item = Covariate> {
        let all = self.within.columns.keys().chain(self.between.columns.keys());
        all.copied()
            .filter(|one| self.is_whole || self.covariates.contains(one))
    }

    /// What the other runs of the material (`all`) do not state.
    pub fn lacking(&self, facts: &[RunFacts], all: &[usize], material: &str) -> Vec<Lacking> {
        let others = || (0..all.len()).filter(|&own| !self.places.contains(&all[own]));
        let environment = |own: usize| facts[all[own]].names.get(&Covariate::Environment).cloned();
        let environments: BTreeSet<String> = others().filter_map(environment).collect();
        // The direction follows from the humidity, and is said with it.
        let is_told = |one: &Covariate| !self.is_whole && *one != Covariate::Direction;
        let differing = self.differing().filter(is_told);
        differing
            .map(|covariate| Lacking {
                material: material.to_owned(),
                covariate,
                without: others().collect(),
                runs: all.len(),
                environments: environments.iter().cloned().collect(),
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::facts::Known;

    fn fact(environment: &str, humidity: Option<f64>, cycle: f64) -> RunFacts {
        let exact = |value: f64| Known {
            value,
            standard_error: None,
        };
        let humidity = humidity.map(|value| (Covariate::RelativeHumidity, exact(value)));
        RunFacts {
            run: 0,
            sample: "S1".to_owned(),
            material: "m".to_owned(),
            numbers: humidity
                .into_iter()
                .chain([(Covariate::Cycle, exact(cycle))])
                .collect(),
            names: [(Covariate::Environment, environment.to_owned())].into(),
        }
    }

    /// Six runs in vacuum without a humidity, then two of each humidity in air, in the order of `humidities`.
    fn study(humidities: [f64; 6]) -> Vec<RunFacts> {
        let vacuum = (0..6).map(|k| fact("vacuum", None, f64::from(k)));
        let air = humidities
            .iter()
            .zip(6..)
            .map(|(&humidity, k)| fact("air", Some(humidity), f64::from(k)));
        vacuum.chain(air).collect()
    }

    #[test]
    fn runs_without_a_humidity_take_it_from_no_other() {
        let facts = study([50.0, 20.0, 80.0, 20.0, 80.0, 50.0]);
        let all: Vec<usize> = (0..12).collect();
        let found = parts(&facts, &all);
        let [whole, humid] = found.as_slice() else {
            panic!("{found:?}");
        };
        assert_eq!(humid.places, [6, 7, 8, 9, 10, 11]);
        assert_eq!(humid.sets, [(Level::Within, vec![Covariate::RelativeHumidity])]);
        let in_whole = whole.sets.iter().flat_map(|(_, set)| set);
        assert!(in_whole.clone().any(|one| *one == Covariate::Cycle));
        assert!(
            in_whole
                .into_iter()
                .all(|one| *one != Covariate::RelativeHumidity)
        );
        let lacking = humid.lacking(&facts, &all, "m");
        assert_eq!(lacking[0].covariate, Covariate::RelativeHumidity);
        assert_eq!((lacking[0].without.len(), lacking[0].runs), (6, 12));
        assert_eq!(lacking[0].environments, ["vacuum"]);
    }

    #[test]
    fn what_changed_with_it_is_asked_with_it() {
        let facts = study([20.0, 30.0, 40.0, 50.0, 60.0, 70.0]);
        let found = parts(&facts, &(0..12).collect::<Vec<_>>());
        let together = vec![Covariate::RelativeHumidity, Covariate::Cycle];
        assert_eq!(found[1].sets, [(Level::Within, together)]);
        let in_whole = found[0].sets.iter().flat_map(|(_, set)| set);
        assert!(in_whole.into_iter().all(|one| *one != Covariate::Cycle));
    }

    #[test]
    fn where_all_or_few_state_it_there_is_one_part() {
        let mut facts = study([50.0, 20.0, 80.0, 20.0, 80.0, 50.0]);
        let places: Vec<usize> = (0..12).collect();
        for fact in &mut facts[9..] {
            fact.numbers.remove(&Covariate::RelativeHumidity);
        }
        assert_eq!(parts(&facts, &places).len(), 1);
        assert_eq!(parts(&facts, &[6, 7, 8]).len(), 1);
    }
}
