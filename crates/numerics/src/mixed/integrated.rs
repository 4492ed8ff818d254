//! The scatters of a mixed model, integrated over the places at which the values make them likely.

use std::collections::BTreeMap;

use super::before::{Before, MOST_SCATTERS, Place};
use super::estimated::{Estimated, Point};
use super::likely::{AtReadings, Room, Rows};
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
    found: BTreeMap<Place, Found>,
    room: Room,
    variances: Vec<f64>,
}

/// What is known of a place.
#[derive(Clone, Copy)]
struct Found {
    log_mass: f64,
    /// Whether it stands beside one that holds a part of the mass.
    is_reached: bool,
}

impl MixedModel {
    /// The model at stated variances: of each component, and of readings, last. None where `X` loses a direction.
    pub fn at(&self, variances: &[f64]) -> Option<Estimated> {
        let rows = Rows::of(self);
        let at = AtReadings::of(&rows, *variances.last()?)?;
        Some(Estimated::of(vec![Point::new(
            1.0,
            variances.to_vec(),
            at.with(variances, &mut Room::default())?,
        )]))
    }

    /// The model with its scatters integrated. None where `X` loses a direction, or where no reading is left over to tell a
    /// scatter from.
    ///
    /// # Panics
    /// It has more than three components.
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
            found: BTreeMap::new(),
            room: Room::default(),
            variances: Vec::new(),
        };
        let likeliest = tried.likeliest();
        tried.spread(likeliest);
        tried.estimated()
    }
}

impl Tried<'_, '_> {
    /// Logarithm of the mass of a place.
    fn log_mass(&mut self, place: Place) -> f64 {
        if let Some(found) = self.found.get(&place) {
            return found.log_mass;
        }
        let before = self.before.at(&place, &mut self.variances);
        let shared = self.variances.last().copied().unwrap_or(0.0);
        let rows = self.rows;
        let at = self
            .at_readings
            .entry(place[0])
            .or_insert_with(|| AtReadings::of(rows, shared));
        let mass = at.as_ref().map_or(f64::NAN, |at| {
            before + at.log_likelihood(&self.variances, &mut self.room)
        });
        let log_mass = if mass.is_nan() { f64::NEG_INFINITY } else { mass };
        let is_reached = false;
        self.found.insert(place, Found { log_mass, is_reached });
        log_mass
    }

    /// Notes that a place is reached, and gives the logarithm of its mass where it was not before.
    fn reach(&mut self, place: Place) -> Option<f64> {
        let log_mass = self.log_mass(place);
        let found = self.found.get_mut(&place).filter(|own| !own.is_reached)?;
        found.is_reached = true;
        Some(log_mass)
    }

    /// The places beside one, so many steps away along each axis.
    fn beside(&self, place: Place, strides: Place) -> impl Iterator<Item = Place> + use<> {
        let mut found = [place; 2 * MOST_SCATTERS];
        for (k, axis) in self.before.axes.iter().enumerate() {
            found[2 * k][k] = place[k] + strides[k];
            found[2 * k + 1][k] = (place[k] - strides[k]).max(axis.first());
        }
        found.into_iter().filter(move |other| *other != place)
    }

    /// The place that no place beside it exceeds, sought by strides that are halved where none does.
    fn likeliest(&mut self) -> Place {
        let mut strides = [1; MOST_SCATTERS];
        let axes = self.before.axes.iter().zip(&mut strides);
        axes.for_each(|(axis, stride)| *stride = axis.places(FIRST_STRIDE));
        let mut best = self.before.start;
        let mut of_best = self.log_mass(best);
        loop {
            let from = best;
            for other in self.beside(from, strides) {
                let of_other = self.log_mass(other);
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
    fn spread(&mut self, from: Place) {
        let mut largest = self.reach(from).unwrap_or(f64::NEG_INFINITY);
        let mut next = vec![(from, largest)];
        while let Some((place, log_mass)) = next.pop() {
            if log_mass < largest - TRIED_DOWN_TO {
                continue;
            }
            for other in self.beside(place, [1; MOST_SCATTERS]) {
                if let Some(of_other) = self.reach(other) {
                    largest = largest.max(of_other);
                    next.push((other, of_other));
                }
            }
        }
        // What the search tried on its way may lie apart from the rest.
        self.found.retain(|_, own| own.is_reached);
    }

    fn estimated(mut self) -> Option<Estimated> {
        let all = self.found.values().map(|own| own.log_mass);
        let largest = all.fold(f64::NEG_INFINITY, f64::max);
        let mut points = Vec::new();
        for (place, found) in &self.found {
            if found.log_mass <= largest - COUNTS_DOWN_TO {
                continue;
            }
            let mut variances = Vec::with_capacity(self.before.axes.len());
            self.before.at(place, &mut variances);
            let at = self.at_readings.get(&place[0]).and_then(Option::as_ref);
            if let Some(likely) = at.and_then(|at| at.with(&variances, &mut self.room)) {
                points.push(Point::new((found.log_mass - largest).exp(), variances, likely));
            }
        }
        (!points.is_empty()).then(|| Estimated::of(points))
    }
}
