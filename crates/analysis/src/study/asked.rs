//! Asks every question of a study, parameter by parameter. The answers about one parameter of a material are made from its
//! runs and from those of the first material, against which it is held: where both are as they were, they are taken from what
//! was kept.

use std::collections::BTreeMap;

use ieap_domain::Factor;

use super::answer::Answer;
use super::asking::Asking;
use super::curves::Curves;
use super::evidence::{Evidence, Numbers, numbers};
use super::kept::{Grounds, Kept};
use super::laws::{of_humidity, other_slopes, over_humidity};
use super::measured::Measured;
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

/// What is told of each material and parameter.
type Told = BTreeMap<(usize, &'static str), Kept>;

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
        let mut told = Told::new();
        for key in MEASURES {
            self.tell_measure(key, (&placed, &grounds), kept, &mut told);
        }
        for key in CURVES {
            self.tell_curves(key, (&placed, &grounds), kept, &mut told);
        }
        let (mut answers, mut odd) = (Vec::new(), Vec::new());
        odd.extend(told.values().flat_map(|own| own.odd.iter().cloned()));
        odd.sort_by(|a: &OddValue, b| a.run.cmp(&b.run));
        for material in materials {
            let keys = MEASURES.into_iter().chain(CURVES);
            let own = keys.filter_map(|key| told.remove(&(material, key)));
            let mut found: Vec<Answer> = own.flat_map(|own| own.answers).collect();
            found.sort_by_key(|own| (!own.is_of_study, own.kind));
            answers.extend(found);
        }
        (answers, odd)
    }

    /// What is told of a parameter of each material.
    fn tell_measure(
        &self,
        key: &'static str,
        (placed, grounds): (&[Placed], &Grounds),
        kept: &Cache,
        told: &mut Told,
    ) {
        let all: Vec<_> = placed
            .iter()
            .map(|own| numbers(&self.evidence, own, key))
            .collect();
        let hashes = grounds.of_measure(key, &all);
        let due = due(key, (grounds, &hashes), kept, told);
        let needed = |at: &usize| due.contains(at) || *at == 0 && !due.is_empty();
        let each = (0..all.len()).filter(needed);
        let measured = each.filter_map(|at| Some(((at, key), measured(all[at].as_ref()?, &placed[at]))));
        let measured: BTreeMap<_, _> = measured.collect();
        let slope = |(&at, of): (&_, &Result<Measured, _>)| {
            let values = of_humidity(of.as_ref().ok()?, self.conditions)?;
            let over = over_humidity(&values, self.conditions, self.facts)?;
            Some((at, Slope::of(&over)?))
        };
        let slopes = measured.iter().filter_map(slope).collect();
        let of_due = measured.iter().filter(|((at, _), _)| due.contains(at));
        let other =
            |(&at, of): (&_, &Result<Measured, _>)| Some((at, other_slopes(of.as_ref().ok()?, self.facts)));
        let others = of_due.filter_map(other).collect();
        let asking = Asking {
            measured,
            slopes,
            others,
            ..self.asking()
        };
        for at in due {
            let own = asking.measured(at, key).map(|of| (key, of));
            let run = |place: usize| self.evidence.runs[self.facts[place].run].path.clone();
            let found = Kept {
                answers: asking.of_measure(at, key),
                odd: odd_values(own.into_iter(), |own| run(own.place)),
            };
            found.keep(&hashes[at], &grounds.runs(at), kept);
            told.insert((at, key), found);
        }
    }

    /// What is told of curves of each material.
    fn tell_curves(
        &self,
        key: &'static str,
        (placed, grounds): (&[Placed], &Grounds),
        kept: &Cache,
        told: &mut Told,
    ) {
        let hashes = grounds.of_curves(key, self.evidence.curves);
        let due = due(key, (grounds, &hashes), kept, told);
        let needed = |at: &usize| due.contains(at) || *at == 0 && !due.is_empty();
        let stated = self.evidence.campaign.study.scatter_percent;
        let curves = |at: usize| {
            Some((
                (at, key),
                Curves::of(&placed[at], self.evidence.curves, stated, key)?,
            ))
        };
        let asking = Asking {
            curves: (0..placed.len()).filter(needed).filter_map(curves).collect(),
            ..self.asking()
        };
        for at in due {
            let found = Kept {
                answers: asking.whole_curves(at, key),
                odd: Vec::new(),
            };
            found.keep(&hashes[at], &grounds.runs(at), kept);
            told.insert((at, key), found);
        }
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

fn measured(of: &Result<Numbers, &'static str>, placed: &Placed) -> Result<Measured, &'static str> {
    of.as_ref().map(|own| own.measured(placed)).map_err(|why| *why)
}

/// Takes what was kept, and gives the materials of which nothing was.
fn due(
    key: &'static str,
    (grounds, hashes): (&Grounds, &[String]),
    kept: &Cache,
    told: &mut Told,
) -> Vec<usize> {
    let mut due = Vec::new();
    for (at, hash) in hashes.iter().enumerate() {
        match Kept::earlier(hash, &grounds.runs(at), kept) {
            Some(found) => {
                told.insert((at, key), found);
            }
            None => due.push(at),
        }
    }
    due
}
