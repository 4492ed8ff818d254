//! Answers under a hash of all that they are made from. Runs are known there by their order among those of the material and of
//! the first, and by their names, so that a run more elsewhere changes nothing.

use std::collections::BTreeMap;

use ieap_domain::{Factor, InputHash};
use serde::{Deserialize, Serialize};

use super::answer::{Answer, Drawn};
use super::curves::points_of;
use super::evidence::{Evidence, Numbers};
use super::laws::followed;
use super::odd::OddValue;
use super::placed::Placed;
use crate::cache::{Cache, Hash};
use crate::conditions::Conditions;
use crate::laws::facts::RunFacts;
use crate::model_free::curves::StepCurves;

/// What a material is told of beside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Beside {
    Nothing,
    First,
}

/// A material, by itself or held against the first one.
pub(super) type Unit = (usize, Beside);

/// What is told of one parameter, or of the curves of one channel, of a unit: not yet judged beside the others.
pub(super) struct Kept {
    pub answers: Vec<Answer>,
    pub odd: Vec<OddValue>,
}

/// The same as it is written. What answers leave out of their own form stands beside them.
#[derive(Serialize, Deserialize)]
struct Written {
    answers: Vec<Answer>,
    of_runs: Vec<Vec<usize>>,
    drawn: Vec<Option<Drawn>>,
    odd: Vec<OddValue>,
}

impl Kept {
    /// Answers alone.
    pub fn of(answers: Vec<Answer>) -> Kept {
        Kept {
            answers,
            odd: Vec::new(),
        }
    }

    /// What was made from what has that hash, of these runs; none where it was not kept.
    pub fn earlier(hash: &str, runs: &[usize], kept: &Cache) -> Option<Kept> {
        let written: Written = kept.earlier(hash)?;
        let mut answers = written.answers;
        for ((own, of_runs), drawn) in answers.iter_mut().zip(written.of_runs).zip(written.drawn) {
            (own.of_runs, own.drawn) = (of_runs, drawn);
        }
        answers
            .iter_mut()
            .try_for_each(|own| renumber(own, &|at| runs.get(at).copied()))?;
        let odd = written.odd;
        Some(Kept { answers, odd })
    }

    /// Keeps it as made from what has that hash, of these runs.
    pub fn keep(&self, hash: &str, runs: &[usize], kept: &Cache) {
        let place: BTreeMap<usize, usize> = runs.iter().enumerate().map(|(at, &run)| (run, at)).collect();
        let mut answers = self.answers.clone();
        let numbered: Option<()> = answers
            .iter_mut()
            .try_for_each(|own| renumber(own, &|run| place.get(&run).copied()));
        // An answer about another run would be made anew.
        if numbered.is_none() {
            return;
        }
        let written = Written {
            of_runs: answers.iter().map(|own| own.of_runs.clone()).collect(),
            drawn: answers.iter_mut().map(|own| own.drawn.take()).collect(),
            odd: self.odd.clone(),
            answers,
        };
        kept.put(hash, &written);
    }
}

/// Gives the runs of an answer other numbers; none where one has none.
fn renumber(own: &mut Answer, number: &dyn Fn(usize) -> Option<usize>) -> Option<()> {
    let points = own.drawn.iter_mut().flat_map(|drawn| &mut drawn.points);
    let runs = own.of_runs.iter_mut().chain(points.map(|point| &mut point.run));
    for run in runs {
        *run = number(*run)?;
    }
    Some(())
}

/// What answers of each material are made from beside the numbers of one parameter.
pub(super) struct Grounds<'a> {
    facts: &'a [RunFacts],
    placed: &'a [Placed<'a>],
    /// Of the whole study.
    common: String,
    /// Of each material: its name, its runs, where they stand and what is known of them.
    materials: Vec<String>,
}

impl<'a> Grounds<'a> {
    /// Of a study.
    pub fn of(
        evidence: &Evidence,
        compared: &[Factor],
        conditions: &Conditions,
        (facts, placed): (&'a [RunFacts], &'a [Placed<'a>]),
    ) -> Grounds<'a> {
        let common = Hash::default()
            .with(&"what the study asked, its scatters integrated")
            .with(&evidence.campaign.study)
            .with(&compared)
            .with(&(&conditions.surroundings, &conditions.voltages_v))
            .with(&followed(facts))
            .text();
        let of_material = |(name, placed): (&String, &Placed)| {
            let runs = placed.cells.iter().map(|(&place, cell)| {
                let fact = &facts[place];
                let path = &evidence.runs[fact.run].path;
                (path, cell, &fact.sample, &fact.numbers, &fact.names)
            });
            let mut hash = Hash::default().with(name);
            for run in runs {
                hash = hash.with(&run);
            }
            hash.text()
        };
        let materials = conditions.materials.iter().zip(placed).map(of_material).collect();
        Grounds {
            facts,
            placed,
            common,
            materials,
        }
    }

    /// The runs by which answers of a material are kept: its own, after those of the first where it is held against that.
    pub fn runs(&self, (material, scope): Unit) -> Vec<usize> {
        let of = match scope {
            Beside::Nothing => vec![material],
            Beside::First => vec![0, material],
        };
        let places = of.iter().flat_map(|&at| self.placed[at].cells.keys());
        places.map(|&place| self.facts[place].run).collect()
    }

    /// The hash of all that answers about a parameter of these numbers are made from, of each unit.
    pub fn of_measure(
        &self,
        key: &str,
        numbers: &[Option<Result<Numbers, &'static str>>],
    ) -> BTreeMap<Unit, String> {
        let own = numbers.iter().zip(self.placed).map(|(numbers, placed)| {
            let mut hash = InputHash::new();
            match numbers {
                None => hash.text("none"),
                Some(Err(why)) => hash.text(why),
                Some(Ok(numbers)) => add(&mut hash, numbers, placed),
            };
            hash.finished()
        });
        self.with(key, &own.collect::<Vec<_>>())
    }

    /// The same of answers about curves of a channel.
    pub fn of_curves(&self, key: &str, curves: &[StepCurves]) -> BTreeMap<Unit, String> {
        let own = self.placed.iter().map(|placed| {
            let mut hash = InputHash::new();
            for &place in placed.cells.keys() {
                let points = curves
                    .get(self.facts[place].run)
                    .map_or(&[][..], |own| points_of(own, key));
                hash.count(points.len());
                for point in points {
                    hash.whole(point.place as u64)
                        .number(point.value)
                        .number(point.variance);
                }
            }
            hash.finished()
        });
        self.with(key, &own.collect::<Vec<_>>())
    }

    /// With what a material is, and the first one where it is held against that.
    fn with(&self, key: &str, own: &[String]) -> BTreeMap<Unit, String> {
        let of = |at: usize| (&self.materials[at], &own[at]);
        let alone = (0..own.len()).map(|at| ((at, Beside::Nothing), vec![of(at)]));
        let beside = (1..own.len()).map(|at| ((at, Beside::First), vec![of(0), of(at)]));
        let hash = |of: &Vec<_>| Hash::default().with(&self.common).with(&key).with(of).text();
        alone.chain(beside).map(|(unit, of)| (unit, hash(&of))).collect()
    }
}

/// Adds numbers by the order of the runs.
fn add<'h>(hash: &'h mut InputHash, numbers: &Numbers, placed: &Placed) -> &'h mut InputHash {
    hash.text("numbers").number_or_none(numbers.stated);
    for place in placed.cells.keys() {
        let own = numbers.found.get(place);
        hash.number_or_none(own.map(|own| own.0))
            .number_or_none(own.map(|own| own.1));
    }
    for (cell, bound) in &numbers.bounds {
        hash.count(cell.0).count(cell.1);
        hash.number_or_none(bound.below).number_or_none(bound.above);
    }
    hash
}
