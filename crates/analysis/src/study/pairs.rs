//! Which surroundings are held against which, and at which voltages.

use ieap_domain::Factor;

use super::asking::Asking;
use super::measured::{Cell, Measured};
use super::policy::{MEMBERS_DIFFER, MOST_FOR_ALL_PAIRS};

/// Surroundings as one side of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Side {
    pub name: String,
    pub surroundings: Vec<usize>,
}

/// Two sides, and whether the study asks for them.
pub(super) struct Pair {
    pub upper: Side,
    pub lower: Side,
    pub is_of_study: bool,
}

impl Asking<'_> {
    /// Sides that the study compares: surroundings, or an environment as a whole where a law answers what its humidity does.
    pub(super) fn sides(&self, material: usize) -> Vec<Side> {
        let all = self.surroundings(material);
        let known = &self.conditions.surroundings;
        let mut sides: Vec<Side> = Vec::new();
        for at in all {
            // Of two levels the second against the first says what a law would.
            let levels = known
                .iter()
                .filter(|own| own.environment == known[at].environment);
            let has_law = self.asks(Factor::Humidity)
                && levels.count() != 2
                && self.conditions.varies_humidity(&known[at].environment);
            let name = if has_law {
                known[at].environment.clone()
            } else {
                known[at].text()
            };
            match sides.iter_mut().find(|side| side.name == name) {
                Some(side) => side.surroundings.push(at),
                None => sides.push(Side {
                    name,
                    surroundings: vec![at],
                }),
            }
        }
        sides
    }

    /// Pairs of sides. Where some are dry and some are not, the study asks whether the dry ones are alike, and what the others
    /// do against them, together where these values have them alike and else against each; without dry ones each is held
    /// against the first. Surroundings are held against each other as details.
    pub(super) fn pairs(&self, material: usize, of: &[&Measured]) -> Vec<Pair> {
        let known = &self.conditions.surroundings;
        let asks = self.asks(Factor::Environment) || self.asks(Factor::Humidity);
        let mut pairs: Vec<Pair> = Vec::new();
        let mut add = |upper: &Side, lower: &Side, is_of_study| {
            let is_new = pairs.iter().all(|own| own.upper != *upper || own.lower != *lower);
            if is_new {
                pairs.push(Pair {
                    upper: upper.clone(),
                    lower: lower.clone(),
                    is_of_study,
                });
            }
        };
        let is_dry = |side: &Side| side.surroundings.iter().all(|&at| known[at].is_dry());
        let (dry, wet): (Vec<Side>, Vec<Side>) = self.sides(material).into_iter().partition(is_dry);
        match &dry[..] {
            [first, others @ ..] if !others.is_empty() && !wet.is_empty() => {
                let names: Vec<&str> = dry.iter().map(|side| side.name.as_str()).collect();
                let together = Side {
                    name: format!("dry ({})", names.join(", ")),
                    surroundings: dry.iter().flat_map(|side| side.surroundings.clone()).collect(),
                };
                if of.iter().all(|of| self.are_alike(of, &dry)) {
                    wet.iter().for_each(|side| add(side, &together, asks));
                } else {
                    for side in &wet {
                        dry.iter().for_each(|own| add(side, own, asks));
                    }
                }
                others.iter().for_each(|side| add(side, first, asks));
            }
            _ => {
                let all = self.sides(material);
                all.iter().skip(1).for_each(|side| add(side, &all[0], asks));
            }
        }
        let all = self.surroundings(material);
        let side = |&at: &usize| Side {
            name: known[at].text(),
            surroundings: vec![at],
        };
        for (k, lower) in all.iter().enumerate() {
            let is_shown = k == 0 || all.len() <= MOST_FOR_ALL_PAIRS;
            let others = all[k + 1..].iter().filter(|_| is_shown);
            others.for_each(|at| add(&side(at), &side(lower), false));
        }
        pairs
    }

    /// Whether values tell no side from the first, by their scatter where that is known and else by the fits.
    fn are_alike(&self, of: &Measured, sides: &[Side]) -> bool {
        let differs = |side: &Side| {
            let shared = self.shared(of, side, &sides[0]);
            let factors = self.difference(of, side, &sides[0], &shared)?;
            let law = of.with_scatter(&factors).map(|(law, _)| law);
            let law = law.or_else(|| of.by_fits(&factors))?;
            Some(law.chance_of_none() <= MEMBERS_DIFFER / (sides.len() - 1) as f64)
        };
        !sides.iter().skip(1).any(|side| differs(side) == Some(true))
    }

    /// Voltages at which both sides have a value in all of their surroundings.
    pub(super) fn shared(&self, of: &Measured, upper: &Side, lower: &Side) -> Vec<usize> {
        let is_known = |at: usize, voltage: usize| of.at((at, voltage)).is_some();
        let has = |side: &Side, voltage| side.surroundings.iter().all(|&at| is_known(at, voltage));
        let some = |side: &Side, voltage| side.surroundings.iter().any(|&at| is_known(at, voltage));
        let at = |is_in: &dyn Fn(&Side, usize) -> bool| -> Vec<usize> {
            let all = 0..self.conditions.voltages_v.len();
            all.filter(|&voltage| is_in(upper, voltage) && is_in(lower, voltage))
                .collect()
        };
        // An environment that has none at which all of its humidities were measured is compared by those that were.
        Some(at(&has))
            .filter(|found| !found.is_empty())
            .unwrap_or_else(|| at(&some))
    }

    /// Factors of the mean of one side less that of the other at these voltages; each over its own voltages where the study
    /// puts voltages together.
    pub(super) fn difference(
        &self,
        of: &Measured,
        upper: &Side,
        lower: &Side,
        voltages: &[usize],
    ) -> Option<Vec<f64>> {
        let mut factors = vec![0.0; of.cells.len()];
        for (side, sign) in [(upper, 1.0), (lower, -1.0)] {
            let is_in = |cell: &Cell| {
                let is_at = self.rules.voltages_together || voltages.contains(&cell.1);
                side.surroundings.contains(&cell.0) && is_at
            };
            let cells: Vec<usize> = (0..of.cells.len()).filter(|&k| is_in(&of.cells[k])).collect();
            if cells.is_empty() {
                return None;
            }
            cells
                .iter()
                .for_each(|&k| factors[k] += sign / cells.len() as f64);
        }
        Some(factors)
    }
}
