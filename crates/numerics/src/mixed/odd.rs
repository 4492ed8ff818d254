//! A reading that is not like its own: how likely it is of something else than what the model describes.
//!
//! Each reading in turn is given a shift of its own, the others saying what it should be: by the mixture over the scatters that
//! they leave likely, against the wide law that what is of something else follows. Two readings of one condition that lie apart
//! accuse each other alike, and of few readings nothing is odd: no rule says so, the mixture does.

use statrs::distribution::{Cauchy, Continuous};

use super::estimated::Estimated;
use super::likely::{AtReadings, Rows};
use super::model::{MixedModel, Unit};

/// Part of all readings that are of something else, before they are looked at: a run in a hundred. Chosen;
/// `cargo unit -p ieap-analysis study::tests` counts what follows: with nothing odd, and with two runs swapped.
const PART_ODD: f64 = 0.01;
/// Half-width, in standard errors of a reading, of the law of Cauchy that those follow: no size of a mistake is excluded. Chosen,
/// counted by the same command.
const ODD_WIDTH: f64 = 5.0;
/// Readings whose shift is asked in a round: those that stand furthest off. Chosen: two of a condition accuse each other, and
/// one more.
const ASKED: usize = 3;
/// Standard errors below which no reading is asked: there the odds are a tenth at most.
const NOT_ASKED_BELOW: f64 = 2.5;
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
    /// The model with each reading counted as it is likely to be of it, those that count as less than one, and what it says then.
    pub fn with_odd_weighed(mut self) -> (MixedModel, Vec<Odd>, Option<Estimated>) {
        let mut odd: Vec<Odd> = Vec::new();
        while let Some(found) = self.estimated() {
            let more = self.more_odd(&found);
            if more.is_empty() {
                return (self, odd, Some(found));
            }
            for own in &more {
                self.units[own.place.0].readings[own.place.1].weight = own.weight;
            }
            odd.extend(more);
        }
        (self, odd, None)
    }

    /// Readings that count as one and may be odd, where it is likelier that one of them is than that none is.
    fn more_odd(&self, found: &Estimated) -> Vec<Odd> {
        let mut far = self.standings(found).unwrap_or_default();
        far.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut asked: Vec<(Odd, f64)> = Vec::new();
        // Without a reading the others scatter less: so far off it stands of them.
        let left = self.readings() - found.coefficients.len() as f64;
        let alone = |off: f64| off * ((left - 1.0) / (left - off * off).max(0.0)).max(0.0).sqrt();
        if far.first().is_none_or(|(_, off)| alone(*off) < NOT_ASKED_BELOW) {
            return Vec::new();
        }
        for &(place, _) in far.iter().take(ASKED) {
            if let Some((off, odds)) = self.odds_of(place) {
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
    fn odds_of(&self, place: (usize, usize)) -> Option<(f64, f64)> {
        let fixed = self.units.first()?.fixed.len();
        let mut factors = vec![0.0; fixed + 1];
        factors[fixed] = 1.0;
        let shift = self.with_shift(place).estimated()?.combined(&factors);
        let error = shift.middle_error();
        let off = shift.mean() / error;
        let like = (shift.density(0.0) * error).ln();
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
        let rows = Rows::of(self);
        let at = AtReadings::of(&rows, *found.variances.last()?)?;
        let mut all = at.standings(&found.variances, OWN_PART);
        all.retain(|((unit, place), _)| self.units[*unit].readings[*place].weight == 1.0);
        Some(all)
    }
}
