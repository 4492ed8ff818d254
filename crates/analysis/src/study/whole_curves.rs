//! Whole curves of current and bending, at every time since the step.
//!
//! At each time of a grid the difference of two sides is a combination of the same mixed model as that of a parameter. Two
//! curves differ nowhere by more than the largest of what is not excluded at the times: each bound holds by itself, so that
//! this needs no correction for their number (intersection-union, Berger, Technometrics 24, 295, 1982). That they differ
//! somewhere is claimed by the smallest chance times the number of times.

use std::collections::BTreeMap;

use super::answer::{Answer, Kind};
use super::asking::Asking;
use super::combined::Term;
use super::curves::{Curves, range};
use super::measured::Cell;
use super::policy::FEWEST_TIMES;
use crate::false_discovery::CLAIMED_BELOW;
use crate::model_free::curves::time_s;

/// Conditions of one material with their factors in a difference.
type Weights<'a> = (&'a Curves, Vec<(Cell, f64)>);

impl Asking<'_> {
    /// The curves of what the study asks about surroundings: over all voltages that both have, then at each; and, as a detail,
    /// those of the material against the first.
    pub(super) fn whole_curves(&self, material: usize, key: &'static str) -> Vec<Answer> {
        let own = self.curves.get(&(material, key));
        let Some((of, widest)) = own.and_then(|of| Some((of, of.fullest()?))) else {
            return Vec::new();
        };
        if self.rules.voltages_together {
            return Vec::new();
        }
        let mut found = Vec::new();
        let pairs = self.pairs(material, &[widest]).into_iter();
        for pair in pairs.filter(|pair| pair.is_of_study) {
            let shared = self.shared(widest, &pair.upper, &pair.lower);
            let names = (pair.upper.name.as_str(), pair.lower.name.as_str());
            let single = shared
                .iter()
                .map(|&voltage| vec![voltage])
                .filter(|_| shared.len() > 1);
            for voltages in std::iter::once(shared.clone()).chain(single) {
                let factors = self.difference(widest, &pair.upper, &pair.lower, &voltages);
                let weights = widest.cells.iter().copied().zip(factors.unwrap_or_default());
                let weights = weights.filter(|(_, factor)| *factor != 0.0).collect();
                let blank = self.blank(Kind::Environment, material, key, names);
                found.push(self.whole(
                    &[(of, weights)],
                    &voltages,
                    Answer {
                        is_of_study: voltages == shared,
                        ..blank
                    },
                ));
            }
        }
        found
    }

    pub(super) fn curves_of_materials(&self, material: usize, key: &'static str) -> Option<Answer> {
        let of = |material| {
            self.curves
                .get(&(material, key))
                .filter(|_| !self.rules.voltages_together)
        };
        let (own, first) = (of(material)?, of(0).filter(|_| material > 0)?);
        let cells: Vec<Cell> = own.fullest()?.cells.clone();
        let shared: Vec<Cell> = cells
            .into_iter()
            .filter(|cell| first.sizes.contains_key(cell))
            .collect();
        let weights = |sign: f64| {
            shared
                .iter()
                .map(|&cell| (cell, sign / shared.len() as f64))
                .collect()
        };
        let sides = [(own, weights(1.0)), (first, weights(-1.0))];
        let mut voltages: Vec<usize> = shared.iter().map(|cell| cell.1).collect();
        voltages.sort_unstable();
        voltages.dedup();
        (!shared.is_empty()).then(|| self.whole(&sides, &voltages, self.blank_of_materials(material, key)))
    }

    /// The difference of conditions at every time at which all of them have a value, as one answer.
    fn whole(&self, sides: &[Weights], voltages: &[usize], blank: Answer) -> Answer {
        let is_known = |at: &i32| {
            let has = |(of, weights): &Weights| {
                of.at
                    .get(at)
                    .is_some_and(|own| weights.iter().all(|(cell, _)| own.at(*cell).is_some()))
            };
            sides.iter().all(has)
        };
        let first = sides.iter().take(1).filter(|(_, weights)| !weights.is_empty());
        let times: Vec<i32> = first
            .flat_map(|(of, _)| of.at.keys().copied())
            .filter(is_known)
            .collect();
        let range_at = |voltage: usize| {
            let mean = |at: &i32| {
                let mut sums = (0.0, 0.0);
                for (of, weights) in sides {
                    for (cell, weight) in weights.iter().filter(|(cell, _)| cell.1 == voltage) {
                        sums = (sums.0 + weight.abs() * of.means[cell][at], sums.1 + weight.abs());
                    }
                }
                sums.0 / sums.1
            };
            range(times.iter().map(mean))
        };
        let ranges: BTreeMap<usize, f64> = voltages
            .iter()
            .map(|&voltage| (voltage, range_at(voltage)))
            .collect();
        if !ranges.values().all(|range| *range > 0.0) {
            return over_times(&[], |_, _| blank.clone(), &blank);
        }
        let term = |(of, weights): &Weights<'_>, at: i32| -> Vec<f64> {
            let mut factors = vec![0.0; of.at[&at].cells.len()];
            for (cell, weight) in weights {
                let place = of.at[&at].at(*cell).unwrap_or(0);
                factors[place] = weight * of.sizes[cell] / ranges[&cell.1];
            }
            factors
        };
        let at_time = |at: i32, of: usize| {
            let terms: Vec<Term> = sides
                .iter()
                .map(|side| Term::of_conditions(&side.0.at[&at], term(side, at)))
                .collect();
            let blank = Answer {
                most_at_s: Some(time_s(at)),
                ..blank.clone()
            };
            self.chosen(&terms, voltages, blank.is_of_study, (blank, of))
        };
        over_times(&times, at_time, &blank)
    }
}

/// The answers at several times as one: where the curves differ most, and what holds of all times. `at`: that at a time, which
/// was chosen from so many.
fn over_times(times: &[i32], at: impl Fn(i32, usize) -> Answer, blank: &Answer) -> Answer {
    let mut all: Vec<(i32, Answer)> = times.iter().map(|&time| (time, at(time, 1))).collect();
    // A time at which nothing tells the scatter has no bound.
    if all.iter().any(|(_, own)| own.no_more_than.is_some()) {
        all.retain(|(_, own)| own.no_more_than.is_some());
    }
    let no_more_than = all
        .iter()
        .filter_map(|(_, own)| own.no_more_than)
        .reduce(f64::max);
    let least = all.iter().filter_map(|(_, own)| own.p).reduce(f64::min);
    let times_s = all
        .first()
        .zip(all.last())
        .map(|(a, b)| (time_s(a.0), time_s(b.0)));
    let count = all.len();
    // Where a difference is shown, the largest of those that are.
    let is_shown = |own: &Answer| own.p.is_some_and(|p| count as f64 * p <= CLAIMED_BELOW);
    let size = |(_, own): &(i32, Answer)| (is_shown(own), own.value.map_or(0.0, f64::abs));
    let order = |a: &(bool, f64), b: &(bool, f64)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
    let largest = all.iter().max_by(|a, b| order(&size(a), &size(b)));
    let Some((time, _)) = largest.filter(|_| count >= FEWEST_TIMES) else {
        let reason =
            "the curves of both sides have too few times in common at equal voltage, or stay at nothing";
        return Answer {
            reason: Some(reason.to_owned()),
            ..blank.clone()
        };
    };
    // The time was chosen by what was found there: the interval holds at all of them together.
    Answer {
        p: least.map(|p| (count as f64 * p).min(1.0)),
        no_more_than,
        times_s,
        ..at(*time, count)
    }
}
