//! Asks every question of a study, parameter by parameter. Answers about a parameter of a material are made from its own runs,
//! and those that hold it against the first material from the runs of both: where these are as they were, the answers are taken
//! from what was kept.

use std::collections::BTreeMap;

use ieap_domain::Factor;
use ieap_numerics::interrupt;
use rayon::prelude::*;

use super::answer::Answer;
use super::asking::Asking;
use super::combinations::Combinations;
use super::curves::Curves;
use super::evidence::{Evidence, Numbers, numbers};
use super::kept::{Beside, Grounds, Kept, Unit};
use super::laws::{of_humidity, other_slopes, over_humidity};
use super::measures::{CURVES, MEASURES};
use super::odd::{OddValue, odd_values};
use super::placed::Placed;
use super::slope::Slope;
use crate::cache::Cache;
use crate::conditions::Conditions;
use crate::laws::facts::RunFacts;

/// All that a study asks of.
pub(super) struct Asked<'a> {
    pub evidence: Evidence<'a>,
    pub compared: &'a [Factor],
    pub conditions: &'a Conditions,
    pub facts: &'a [RunFacts],
}

/// What is told of each parameter of each unit.
type Told = BTreeMap<(&'static str, Unit), Kept>;

impl Asked<'_> {
    /// Every answer, by material, and every odd value.
    pub fn answered(&self, kept: &Cache) -> (Vec<Answer>, Vec<OddValue>) {
        let materials = 0..self.conditions.materials.len();
        let placed = materials
            .clone()
            .map(|at| Placed::new(self.conditions, self.facts, at));
        let placed: Vec<Placed> = placed.collect();
        let grounds = Grounds::of(
            &self.evidence,
            self.compared,
            self.conditions,
            (self.facts, &placed),
        );
        // Each by itself, side by side: what becomes of them does not hang on their order.
        let of_measures = MEASURES.into_par_iter().map(|key| {
            interrupt::check();
            self.tell_measure(key, (&placed, &grounds), kept)
        });
        let of_curves = CURVES.into_par_iter().map(|key| {
            interrupt::check();
            self.tell_curves(key, (&placed, &grounds), kept)
        });
        let all: Vec<Told> = of_measures.chain(of_curves).collect();
        let mut told: Told = all.into_iter().flatten().collect();
        let mut odd: Vec<OddValue> = Vec::new();
        for material in materials.clone() {
            let mut keys = MEASURES;
            keys.sort_unstable();
            let own = keys.map(|key| told.get(&(key, (material, Beside::Nothing))));
            odd.extend(own.into_iter().flatten().flat_map(|own| own.odd.iter().cloned()));
        }
        odd.sort_by(|a, b| a.run.cmp(&b.run));
        let mut answers = Vec::new();
        for material in materials {
            let keys = MEASURES.into_iter().chain(CURVES);
            let units = keys.flat_map(|key| [Beside::Nothing, Beside::First].map(|of| (key, (material, of))));
            let own = units.filter_map(|unit| told.remove(&unit));
            let mut found: Vec<Answer> = own.flat_map(|own| own.answers).collect();
            found.sort_by_key(|own| (!own.is_of_study, own.kind));
            answers.extend(found);
        }
        (answers, odd)
    }

    /// What is told of a parameter of each unit.
    fn tell_measure(
        &self,
        key: &'static str,
        (placed, grounds): (&[Placed], &Grounds),
        kept: &Cache,
    ) -> Told {
        let mut told = Told::new();
        let all: Vec<_> = placed
            .iter()
            .map(|own| numbers(&self.evidence, own, key))
            .collect();
        let due = due(key, grounds, grounds.of_measure(key, &all), kept, &mut told);
        let each = (0..all.len()).filter(|at| is_needed(*at, &due));
        let measured = each.filter_map(|at| Some(((at, key), measured(all[at].as_ref()?, &placed[at]))));
        let measured: BTreeMap<_, _> = measured.collect();
        let slope = |(&at, of): (&_, &Result<Combinations, _>)| {
            let values = of_humidity(of.as_ref().ok()?, self.conditions)?;
            let over = over_humidity(&values, self.conditions, self.facts)?;
            Some((at, Slope::of(&over)?))
        };
        let slopes = measured.iter().filter_map(slope).collect();
        let alone = measured
            .iter()
            .filter(|((at, _), _)| due.contains_key(&(*at, Beside::Nothing)));
        let other = |(&at, of): (&_, &Result<Combinations, _>)| {
            Some((at, other_slopes(of.as_ref().ok()?, self.facts)))
        };
        let others = alone.filter_map(other).collect();
        let asking = Asking {
            measured,
            slopes,
            others,
            ..self.asking()
        };
        let run = |place: usize| self.evidence.runs[self.facts[place].run].path.clone();
        for (unit, hash) in due {
            let own = asking.measured(unit.0, key).map(|of| (key, &**of));
            let found = match unit.1 {
                Beside::Nothing => Kept {
                    answers: asking.alone(unit.0, key),
                    odd: odd_values(own.into_iter(), |own| run(own.place)),
                },
                Beside::First => Kept::of(asking.against_first(unit.0, key)),
            };
            found.keep(&hash, &grounds.runs(unit), kept);
            told.insert((key, unit), found);
        }
        told
    }

    /// What is told of curves of each unit.
    fn tell_curves(&self, key: &'static str, (placed, grounds): (&[Placed], &Grounds), kept: &Cache) -> Told {
        let mut told = Told::new();
        let due = due(
            key,
            grounds,
            grounds.of_curves(key, self.evidence.curves),
            kept,
            &mut told,
        );
        let stated = self.evidence.campaign.study.scatter_percent;
        let curves = |at: usize| {
            Some((
                (at, key),
                Curves::of(&placed[at], self.evidence.curves, stated, key)?,
            ))
        };
        let needed = (0..placed.len()).filter(|at| is_needed(*at, &due));
        let asking = Asking {
            curves: needed.filter_map(curves).collect(),
            ..self.asking()
        };
        for (unit, hash) in due {
            let found = Kept::of(match unit.1 {
                Beside::Nothing => asking.whole_curves(unit.0, key),
                Beside::First => asking.curves_of_materials(unit.0, key).into_iter().collect(),
            });
            found.keep(&hash, &grounds.runs(unit), kept);
            told.insert((key, unit), found);
        }
        told
    }

    /// Nothing measured yet.
    fn asking(&self) -> Asking<'_> {
        Asking {
            rules: &self.evidence.campaign.study,
            compared: self.compared,
            conditions: self.conditions,
            facts: self.facts,
            measured: BTreeMap::new(),
            slopes: BTreeMap::new(),
            others: BTreeMap::new(),
            curves: BTreeMap::new(),
        }
    }
}

fn measured(of: &Result<Numbers, &'static str>, placed: &Placed) -> Result<Combinations, &'static str> {
    let measured = of.as_ref().map(|own| own.measured(placed));
    measured.map(Combinations::new).map_err(|why| *why)
}

/// Takes what was kept, and gives the units of which nothing was, with their hashes.
fn due(
    key: &'static str,
    grounds: &Grounds,
    hashes: BTreeMap<Unit, String>,
    kept: &Cache,
    told: &mut Told,
) -> BTreeMap<Unit, String> {
    let mut due = BTreeMap::new();
    for (unit, hash) in hashes {
        match Kept::earlier(&hash, &grounds.runs(unit), kept) {
            Some(found) => {
                told.insert((key, unit), found);
            }
            None => {
                due.insert(unit, hash);
            }
        }
    }
    due
}

/// Whether something that is due is told from a material.
fn is_needed(material: usize, due: &BTreeMap<Unit, String>) -> bool {
    let mut units = due.keys();
    units.any(|(own, beside)| *own == material || material == 0 && *beside == Beside::First)
}
