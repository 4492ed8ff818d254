//! The scatters of a mixed model, integrated over the places at which the values make them likely.

use std::collections::{BTreeMap, BTreeSet};

use super::before::Before;
use super::estimated::{Estimated, Point};
use super::likely::{AtReadings, Rows};
use super::model::MixedModel;

/// Logarithm of the part of the likeliest place's mass down to which places have their neighbours tried: those behind hold less
/// than a thousandth.
const TRIED_DOWN_TO: f64 = 5.5;
/// The same down to which they count.
const COUNTS_DOWN_TO: f64 = 8.0;
/// Natural logarithms by which the likeliest place is first sought.
const FIRST_STRIDE: f64 = 1.0;

/// Places with what is known at them.
struct Tried<'r, 'a> {
    rows: &'r Rows<'a>,
    before: Before,
    at_readings: BTreeMap<i32, Option<AtReadings<'r, 'a>>>,
    log_mass: BTreeMap<Vec<i32>, f64>,
}

impl MixedModel {
    /// The model at stated variances: of each component, and of readings, last. None where `X` loses a direction.
    pub fn at(&self, variances: &[f64]) -> Option<Estimated> {
        let rows = Rows::of(self);
        let at = AtReadings::of(&rows, *variances.last()?)?;
        Some(Estimated::of(vec![Point::new(
            1.0,
            variances.to_vec(),
            at.with(variances),
        )]))
    }

    /// The model with its scatters integrated. None where `X` loses a direction, or where no reading is left over to tell a
    /// scatter from.
    pub fn estimated(&self) -> Option<Estimated> {
        let left = self.readings() - self.units.first()?.fixed.len() as f64;
        if left <= 0.0 {
            return None;
        }
        let rows = Rows::of(self);
        let mut tried = Tried {
            before: Before::new(self, &rows, left)?,
            rows: &rows,
            at_readings: BTreeMap::new(),
            log_mass: BTreeMap::new(),
        };
        let likeliest = tried.likeliest();
        tried.spread(likeliest);
        tried.estimated()
    }
}

impl Tried<'_, '_> {
    /// Logarithm of the mass of a place.
    fn log_mass(&mut self, place: &[i32]) -> f64 {
        if let Some(log_mass) = self.log_mass.get(place) {
            return *log_mass;
        }
        let (variances, before) = self.before.at(place);
        let shared = variances.last().copied().unwrap_or(0.0);
        let rows = self.rows;
        let at = self
            .at_readings
            .entry(place[0])
            .or_insert_with(|| AtReadings::of(rows, shared));
        let mass = at
            .as_ref()
            .map_or(f64::NAN, |at| before + at.log_likelihood(&variances));
        let log_mass = if mass.is_nan() { f64::NEG_INFINITY } else { mass };
        self.log_mass.insert(place.to_vec(), log_mass);
        log_mass
    }

    /// The places beside one, so many steps away along each axis.
    fn beside(&self, place: &[i32], strides: &[i32]) -> Vec<Vec<i32>> {
        let mut found = Vec::with_capacity(2 * place.len());
        for (k, (axis, stride)) in self.before.axes.iter().zip(strides).enumerate() {
            for step in [*stride, -stride] {
                let mut other = place.to_vec();
                other[k] = (place[k] + step).max(axis.first());
                if other[k] != place[k] {
                    found.push(other);
                }
            }
        }
        found
    }

    /// The place that no place beside it exceeds, sought by strides that are halved where none does.
    fn likeliest(&mut self) -> Vec<i32> {
        let axes = self.before.axes.iter();
        let mut strides: Vec<i32> = axes.map(|axis| axis.places(FIRST_STRIDE)).collect();
        let mut best = self.before.start.clone();
        let mut of_best = self.log_mass(&best);
        loop {
            let from = best.clone();
            for other in self.beside(&from, &strides) {
                let of_other = self.log_mass(&other);
                if of_other > of_best {
                    (best, of_best) = (other, of_other);
                }
            }
            if best == from {
                if strides.iter().all(|stride| *stride == 1) {
                    return best;
                }
                strides
                    .iter_mut()
                    .for_each(|stride| *stride = (*stride / 2).max(1));
            }
        }
    }

    /// Tries all places that hold a part of the mass.
    fn spread(&mut self, from: Vec<i32>) {
        let unit = vec![1; from.len()];
        let mut largest = self.log_mass(&from);
        let mut seen = BTreeSet::from([from.clone()]);
        let mut next = vec![from];
        while let Some(place) = next.pop() {
            if self.log_mass(&place) < largest - TRIED_DOWN_TO {
                continue;
            }
            for other in self.beside(&place, &unit) {
                if seen.insert(other.clone()) {
                    largest = largest.max(self.log_mass(&other));
                    next.push(other);
                }
            }
        }
        // What the search tried on its way may lie apart from the rest.
        self.log_mass.retain(|place, _| seen.contains(place));
    }

    fn estimated(self) -> Option<Estimated> {
        let largest = self.log_mass.values().copied().fold(f64::NEG_INFINITY, f64::max);
        let counts = self
            .log_mass
            .iter()
            .filter(|own| *own.1 > largest - COUNTS_DOWN_TO);
        let point = |(place, log_mass): (&Vec<i32>, &f64)| {
            let (variances, _) = self.before.at(place);
            let at = self.at_readings.get(&place[0])?.as_ref()?.with(&variances);
            Some(Point::new((log_mass - largest).exp(), variances, at))
        };
        let points: Vec<Point> = counts.filter_map(point).collect();
        (!points.is_empty()).then(|| Estimated::of(points))
    }
}
