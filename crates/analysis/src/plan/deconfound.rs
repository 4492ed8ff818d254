//! The fewest further runs that tell apart what the design ties together.

use rayon::prelude::*;

use super::candidates::candidates;
use super::future::{Material, Setting};
use super::policy::{JUDGED_BY, MOST_INFLATION, MOST_RUNS, REPEATS};
use super::ties::{Tie, Tightness, class, inflations, ties};
use crate::cache::{Cache, Hash};
use crate::groups::HUMIDITY_TOLERANCE_PERCENT;
use crate::laws::CampaignLaws;
use crate::laws::covariate::Covariate;
use crate::laws::design::Level;
use crate::laws::facts::RunFacts;
use crate::laws::find::TiedSet;
use crate::laws::policy::INFLATION_LIMIT;
use ieap_domain::{Campaign, RunRecord};

/// A run of a plan, and what it does.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Step {
    /// What it is made with.
    pub setting: Setting,
    /// Largest inflation before it, of what can be untied.
    pub inflation_before: f64,
    /// The same after it.
    pub inflation_after: f64,
    /// Pairs of covariates that it draws apart, those that are told apart from then on first.
    pub splits: Vec<(Covariate, Covariate)>,
}

/// A tied set and the runs that would untie it.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Deconfounding {
    /// Material.
    pub material: String,
    /// Whether runs or samples are compared.
    pub level: Level,
    /// The covariates that are tied.
    pub covariates: Vec<Covariate>,
    /// Largest inflation now, of what can be untied; infinite where something cannot be told apart at all.
    pub inflation_before: f64,
    /// The same with the runs of the plan.
    pub inflation_after: f64,
    /// Runs in the order in which they are to be made.
    pub steps: Vec<Step>,
    /// Pairs that no run in a condition of the design unties.
    pub left: Vec<(Covariate, Covariate)>,
    /// What would tell these apart, a sentence each.
    pub would: Vec<String>,
}

impl Deconfounding {
    /// Whether its runs bring anything.
    pub fn gains(&self) -> bool {
        let shown = |inflation: f64| inflation.min(MOST_INFLATION);
        !self.steps.is_empty() && shown(self.inflation_after) < shown(self.inflation_before)
    }

    /// Whether the runs named untie all that runs at hand can untie.
    pub fn is_reached(&self) -> bool {
        self.inflation_after <= INFLATION_LIMIT
    }
}

/// A plan for every tied set, taken from `kept` where it was made before. Deterministic, whatever the number of threads.
pub fn deconfound(
    laws: &CampaignLaws,
    runs: &[RunRecord],
    campaign: &Campaign,
    kept: &Cache,
) -> Vec<Deconfounding> {
    let of_set = |set: &TiedSet| {
        let of_material = laws.facts.iter().filter(|fact| fact.material == set.material);
        let facts: Vec<RunFacts> = of_material.cloned().collect();
        let is_fitted = |&place: &usize| {
            let fit = runs[facts[place].run].fit.as_ref();
            fit.is_some_and(|fit| fit.converged)
        };
        let places: Vec<usize> = (0..facts.len()).filter(is_fitted).collect();
        let hash = hash_of(set, &facts, &places, campaign);
        kept.or_make(&hash, || plan(set, &facts, &places, campaign))
    };
    laws.tied.iter().map(of_set).collect()
}

/// A hash over all that a plan is made from: which numbers the runs have among all is no part of it.
fn hash_of(set: &TiedSet, facts: &[RunFacts], places: &[usize], campaign: &Campaign) -> String {
    let hash = Hash::default()
        .with(&"plan")
        .with(set)
        .with(campaign)
        .with(&places);
    let of_fact = |hash: Hash, fact: &RunFacts| hash.with(&(&fact.sample, &fact.numbers, &fact.names));
    facts.iter().fold(hash, of_fact).text()
}

/// The plan for one set over the runs at `places`.
pub fn plan(set: &TiedSet, facts: &[RunFacts], places: &[usize], campaign: &Campaign) -> Deconfounding {
    let material = Material::of(&set.material, campaign, facts, places);
    let (open, stuck) = sorted_out(set, facts, places, campaign, &material);
    let mut design = Design {
        facts: facts.to_vec(),
        places: places.to_vec(),
        inflations: inflations(facts, places, &open),
        ties: open,
    };
    let before = design.largest();
    let mut steps = Vec::new();
    while steps.len() < MOST_RUNS && !Tightness::of(&design.inflations).is_loose() {
        let room = MOST_RUNS - steps.len();
        let Some(more) = design.best(campaign, &material, set, room) else {
            break;
        };
        steps.extend(more);
    }
    let left = pairs(&stuck);
    let would = super::words::would(set, facts, places, &left);
    Deconfounding {
        material: set.material.clone(),
        level: set.level,
        covariates: set.covariates.clone(),
        inflation_before: before,
        inflation_after: design.largest(),
        steps,
        left,
        would,
    }
}

/// Ties that runs in conditions of the design can undo, and those above the limit that they cannot: those that stay
/// where every condition is measured several times on every sample in an order without meaning.
fn sorted_out(
    set: &TiedSet,
    facts: &[RunFacts],
    places: &[usize],
    campaign: &Campaign,
    material: &Material,
) -> (Vec<Tie>, Vec<Tie>) {
    let all = ties(&set.covariates);
    let now = inflations(facts, places, &all);
    let singles: Vec<Setting> = candidates(facts, places, campaign, &set.covariates)
        .into_iter()
        .flatten()
        .collect();
    let mut ideal = facts.to_vec();
    let mut all_places = places.to_vec();
    let mut order: Vec<(u64, &Setting)> = Vec::new();
    for round in 0..REPEATS {
        let numbered = singles.iter().enumerate();
        order.extend(numbered.map(|(k, setting)| (shuffled(round * singles.len() + k), setting)));
    }
    order.sort_by_key(|(key, _)| *key);
    for (_, setting) in order {
        material.append(&mut ideal, &mut all_places, setting);
    }
    let best = inflations(&ideal, &all_places[places.len()..], &all);
    let (mut open, mut stuck) = (Vec::new(), Vec::new());
    for ((tie, now), best) in all.into_iter().zip(now).zip(best) {
        match (now > INFLATION_LIMIT, best > INFLATION_LIMIT) {
            (true, true) => stuck.push(tie),
            _ => open.push(tie),
        }
    }
    // A tie of three that holds one of two says nothing more.
    let of_two: Vec<Tie> = stuck
        .iter()
        .filter(|tie| tie.others.len() == 1)
        .cloned()
        .collect();
    stuck.retain(|tie| tie.others.len() == 1 || !holds_one_of(tie, &of_two));
    (open, stuck)
}

/// Whether a tie of three has a tie of two in it.
fn holds_one_of(tie: &Tie, of_two: &[Tie]) -> bool {
    let is_in = |pair: &Tie| {
        let mut names = std::iter::once(&tie.one).chain(&tie.others);
        let other = pair.others[0];
        names.clone().any(|name| *name == pair.one) && names.any(|name| *name == other)
    };
    of_two.iter().any(is_in)
}

/// A number without pattern for each index: multiplication by the golden ratio, then a mixing of bits.
fn shuffled(index: usize) -> u64 {
    let mut bits = (index as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits ^= bits >> 29;
    bits = bits.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits ^ (bits >> 32)
}

/// The design as it would be.
struct Design {
    facts: Vec<RunFacts>,
    places: Vec<usize>,
    ties: Vec<Tie>,
    inflations: Vec<f64>,
}

impl Design {
    fn largest(&self) -> f64 {
        self.inflations.iter().copied().fold(1.0, f64::max)
    }

    /// Makes the runs that lower the largest inflation most, for each run made; where none lowers it, the sum of what
    /// all exceed the limit by. None where nothing helps.
    fn best(
        &mut self,
        campaign: &Campaign,
        material: &Material,
        set: &TiedSet,
        room: usize,
    ) -> Option<Vec<Step>> {
        let (ties, now) = self.tightest();
        let before = Tightness::of(&now);
        let found = candidates(&self.facts, &self.places, campaign, &set.covariates);
        // Of all facts there is one copy a thread: a candidate is added to it and taken away again.
        let copied = || (self.facts.clone(), self.places.clone());
        let judged: Vec<(f64, f64, usize, usize)> = found
            .par_iter()
            .enumerate()
            .filter(|(_, settings)| settings.len() <= room)
            .map_init(copied, |(facts, places), (k, settings)| {
                for setting in settings {
                    material.append(facts, places, setting);
                }
                let after = Tightness::of(&inflations(facts, places, &ties));
                facts.truncate(self.facts.len());
                places.truncate(self.places.len());
                let runs = settings.len() as f64;
                let gain = |from: f64, to: f64| (from - to) / runs;
                (
                    gain(before.largest, after.largest),
                    gain(before.excess, after.excess),
                    settings.iter().map(|setting| self.made(setting)).sum(),
                    k,
                )
            })
            .collect();
        let coarse = |gain: f64| (gain * 1e6).round();
        let best = judged.into_iter().max_by(|a, b| {
            let by_largest = coarse(a.0).total_cmp(&coarse(b.0));
            let by_excess = coarse(a.1).total_cmp(&coarse(b.1));
            // Of equals those in the emptiest conditions, and of these the first.
            let by_emptiness = b.2.cmp(&a.2);
            by_largest.then(by_excess).then(by_emptiness).then(b.3.cmp(&a.3))
        })?;
        if coarse(best.0) <= 0.0 && coarse(best.1) <= 0.0 {
            return None;
        }
        Some(
            found[best.3]
                .iter()
                .map(|setting| self.make(material, setting))
                .collect(),
        )
    }

    /// Runs that were made, or are planned, on that sample in that condition.
    fn made(&self, setting: &Setting) -> usize {
        let is_same = |&&place: &&usize| {
            let fact = &self.facts[place];
            let same_names = [Covariate::Environment, Covariate::Voltage]
                .iter()
                .all(|key| fact.names.get(key) == setting.names.get(key));
            let humidity = fact.numbers.get(&Covariate::RelativeHumidity);
            let wanted = setting.numbers.get(&Covariate::RelativeHumidity);
            let same_humidity = match (humidity, wanted) {
                (Some(known), Some(wanted)) => (known.value - wanted).abs() <= HUMIDITY_TOLERANCE_PERCENT,
                _ => true,
            };
            fact.sample == setting.sample && same_names && same_humidity
        };
        self.places.iter().filter(is_same).count()
    }

    /// The tightest ties with their inflations, few, for every candidate is judged by them. Names of use grow together,
    /// so that of ties that differ only in which of them they hold one stands for all: the tightest.
    fn tightest(&self) -> (Vec<Tie>, Vec<f64>) {
        let mut active: Vec<usize> = (0..self.ties.len())
            .filter(|&k| self.inflations[k] > INFLATION_LIMIT)
            .collect();
        active.sort_by(|&a, &b| self.inflations[b].total_cmp(&self.inflations[a]).then(a.cmp(&b)));
        let mut seen: Vec<(Covariate, Vec<Covariate>)> = Vec::new();
        active.retain(|&k| {
            let tie = &self.ties[k];
            let mut others: Vec<Covariate> = tie.others.iter().map(|other| class(*other)).collect();
            others.sort();
            let kind = (class(tie.one), others);
            let is_new = !seen.contains(&kind);
            seen.push(kind);
            is_new
        });
        active.truncate(JUDGED_BY);
        let pair = |k: usize| (self.ties[k].clone(), self.inflations[k]);
        active.into_iter().map(pair).unzip()
    }

    fn make(&mut self, material: &Material, setting: &Setting) -> Step {
        let earlier = self.inflations.clone();
        let inflation_before = self.largest();
        material.append(&mut self.facts, &mut self.places, setting);
        self.inflations = inflations(&self.facts, &self.places, &self.ties);
        Step {
            setting: setting.clone(),
            inflation_before,
            inflation_after: self.largest(),
            splits: self.drawn_apart(&earlier),
        }
    }

    /// Pairs that were tied: first those that no longer are, else those whose inflation fell most.
    fn drawn_apart(&self, earlier: &[f64]) -> Vec<(Covariate, Covariate)> {
        let tied = |k: &usize| earlier[*k] > INFLATION_LIMIT;
        let loosened = (0..self.ties.len()).filter(tied);
        let freed: Vec<Tie> = loosened
            .clone()
            .filter(|&k| self.inflations[k] <= INFLATION_LIMIT)
            .map(|k| self.ties[k].clone())
            .collect();
        if !freed.is_empty() {
            return pairs(&freed);
        }
        let fall = |k: usize| earlier[k].min(MOST_INFLATION) / self.inflations[k].min(MOST_INFLATION);
        let most = loosened
            .filter(|&k| fall(k) > 1.0)
            .max_by(|&a, &b| fall(a).total_cmp(&fall(b)));
        most.map_or_else(Vec::new, |k| pairs(&[self.ties[k].clone()]))
    }
}

/// Pairs of covariates in ties, each once, the names of use as the one that the tie has; ties of two first.
fn pairs(ties: &[Tie]) -> Vec<(Covariate, Covariate)> {
    let mut seen = Vec::new();
    let mut found = Vec::new();
    let singles = ties.iter().filter(|tie| tie.others.len() == 1);
    let doubles = ties.iter().filter(|tie| tie.others.len() > 1);
    for tie in singles.chain(doubles) {
        for &other in &tie.others {
            let mut key = [class(tie.one), class(other)];
            key.sort();
            if !seen.contains(&key) {
                seen.push(key);
                // A name of use stands second: "voltage from cycle".
                let is_use = Covariate::OF_AGE.contains(&tie.one);
                found.push(if is_use {
                    (other, tie.one)
                } else {
                    (tie.one, other)
                });
            }
        }
    }
    found
}
