//! A reading that is not like its own: how likely it is of something else than what the model describes.
//!
//! Each reading in turn is given a shift of its own, the others saying what it should be: Student's t over the degrees of
//! freedom that they leave, against the wide law that what is of something else follows. Two readings of one condition that lie
//! apart accuse each other alike, and of few degrees of freedom nothing is odd: no rule says so, the law of Student does.

use statrs::distribution::{Cauchy, Continuous, StudentsT};

use super::at::Likely;
use super::block::{blocks, least_variance};
use super::estimated::Estimated;
use super::model::{MixedModel, Reading, Unit};
use crate::sums::dot;

/// Part of all readings that are of something else, before they are looked at: a run in a hundred. Chosen;
/// `cargo unit -p ieap-analysis study::tests` counts what follows: with nothing odd, and with two runs swapped.
const PART_ODD: f64 = 0.01;
/// Half-width, in standard errors of a reading, of the law of Cauchy that those follow: no size of a mistake is excluded. Chosen,
/// counted by the same command.
const ODD_WIDTH: f64 = 5.0;
/// Readings whose shift is asked in a round: those that stand furthest off. Chosen: two of a condition accuse each other, and
/// one more.
const ASKED: usize = 3;
/// Part of its information that a shift must have of its own: below this nothing else is said of the reading. Rounding.
const OWN_PART: f64 = 1e-9;

/// A reading that may be of something else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Odd {
    /// Its unit, and its place there.
    pub place: (usize, usize),
    /// How far off it stands, in the standard errors that the others leave.
    pub off: f64,
    /// As how many readings it counts: the chance that it is like the others.
    pub weight: f64,
}

impl MixedModel {
    /// The model with each reading counted as it is likely to be of it, and those that count as less than one.
    pub fn with_odd_weighed(mut self) -> (MixedModel, Vec<Odd>) {
        let mut odd: Vec<Odd> = Vec::new();
        let mut last = None;
        while let Some(found) = self.estimated_from(last.as_ref()) {
            let more = self.more_odd(&found);
            if more.is_empty() {
                break;
            }
            for own in &more {
                self.units[own.place.0].readings[own.place.1].weight = own.weight;
            }
            odd.extend(more);
            last = Some(found);
        }
        (self, odd)
    }

    /// Readings that count as one and may be odd, where it is likelier that one of them is than that none is.
    fn more_odd(&self, found: &Estimated) -> Vec<Odd> {
        let mut far = self.standings(found).unwrap_or_default();
        far.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut asked: Vec<(Odd, f64)> = Vec::new();
        for &(place, _) in far.iter().take(ASKED) {
            if let Some((off, odds)) = self.odds_of(place, found) {
                let weight = 1.0;
                asked.push((Odd { place, off, weight }, odds));
            }
            // The others stand less far off: with them there is no even chance either.
            if asked
                .first()
                .is_some_and(|(_, odds)| *odds * (ASKED as f64) < 1.0)
            {
                return Vec::new();
            }
        }
        let some: f64 = asked.iter().map(|(_, odds)| odds).sum();
        if some < 1.0 {
            return Vec::new();
        }
        let weighed = asked.into_iter().map(|(own, odds)| Odd {
            weight: 1.0 - odds / (1.0 + some),
            ..own
        });
        weighed.collect()
    }

    /// How far off a reading stands of what the others say, and the odds that it is of something else; none where they say
    /// nothing of it.
    fn odds_of(&self, place: (usize, usize), found: &Estimated) -> Option<(f64, f64)> {
        let fixed = self.units.first()?.fixed.len();
        let mut factors = vec![0.0; fixed + 1];
        factors[fixed] = 1.0;
        let shift = self
            .with_shift(place)
            .estimated_from(Some(found))?
            .combined(&factors);
        let off = shift.value / shift.variance.sqrt();
        let like = StudentsT::new(0.0, 1.0, shift.freedom.min(1e6)).ok()?.ln_pdf(off);
        let odd = Cauchy::new(0.0, ODD_WIDTH).ok()?.ln_pdf(off);
        let odds = (PART_ODD / (1.0 - PART_ODD)).ln() + odd - like;
        // Beyond this a chance is 1 to the last digit.
        off.is_finite().then(|| (off, odds.min(40.0).exp()))
    }

    /// The same with a column that is one for this reading alone.
    pub(super) fn with_shift(&self, (of, place): (usize, usize)) -> MixedModel {
        let mut shifted = self.clone();
        for unit in &mut shifted.units {
            unit.fixed.push(0.0);
        }
        let own = &mut shifted.units[of];
        let reading = own.readings.remove(place);
        let mut alone = Unit {
            readings: vec![reading],
            ..own.clone()
        };
        if let Some(entry) = alone.fixed.last_mut() {
            *entry = 1.0;
        }
        if own.readings.is_empty() {
            shifted.units[of] = alone;
        } else {
            shifted.units.push(alone);
        }
        shifted
    }

    /// Readings that count as one, by unit and place, with how far off each stands, in its standard errors at the variances
    /// found: the score of a shift of it. Of what nothing else is said it is 0.
    pub(super) fn standings(&self, found: &Estimated) -> Option<Vec<((usize, usize), f64)>> {
        let (at, blocks) = (
            Likely::of(self, &found.variances)?,
            blocks(self, &found.variances)?,
        );
        let shared = *found.variances.last()?;
        let least = least_variance(self, shared);
        let by_chance: Vec<Option<Vec<f64>>> = (blocks.iter())
            .map(|block| block.as_ref().map(|own| own.by_chance(&at.coefficients).1))
            .collect();
        let mut stand = Vec::new();
        for (k, unit) in self.units.iter().enumerate() {
            let (Some(block), Some(chance)) = (&blocks[unit.block], &by_chance[unit.block]) else {
                continue;
            };
            let middle = block.middle.times_vector(&unit.random);
            let crossed = block.crossed.times_vector(&middle);
            let fixed = unit.fixed.iter().enumerate();
            let left: Vec<f64> = fixed
                .map(|(k, x)| x - crossed.get(k).copied().unwrap_or(0.0))
                .collect();
            let taken = at.covariance.form(&left, &left);
            let (said, own) = (
                dot(&unit.fixed, &at.coefficients) + dot(&unit.random, chance),
                dot(&unit.random, &middle),
            );
            let off = |reading: &Reading| {
                let w = (shared + reading.variance).max(least).recip();
                let size = w - w * w * (own + taken);
                if size > OWN_PART * w {
                    (w * (reading.value - said)).abs() / size.sqrt()
                } else {
                    0.0
                }
            };
            let whole = unit.readings.iter().enumerate();
            let whole = whole.filter(|(_, reading)| reading.weight == 1.0);
            stand.extend(whole.map(|(place, reading)| ((k, place), off(reading))));
        }
        Some(stand)
    }
}
