//! Questions about environments.

use ieap_domain::Factor;
use ieap_domain::quantiles::NORMAL_95;

use super::answer::{Answer, Kind};
use super::asking::Asking;
use super::combinations::Combinations;
use super::measured::{Bound, Cell};
use super::pairs::Pair;
use crate::conditions::volts;

impl Asking<'_> {
    /// What the study asked of a parameter whose values cannot be compared.
    pub(super) fn refused(&self, material: usize, key: &'static str, why: &str) -> Vec<Answer> {
        let pairs = self.pairs(material, &[]).into_iter();
        let pairs = pairs.filter(|pair| pair.is_of_study);
        let answer = |pair: Pair| Answer {
            is_of_study: true,
            reason: Some(why.to_owned()),
            ..self.blank(
                Kind::Environment,
                material,
                key,
                (&pair.upper.name, &pair.lower.name),
            )
        };
        pairs.map(answer).collect()
    }

    pub(super) fn environments(&self, material: usize, key: &'static str) -> Vec<Answer> {
        let of = match self.measured.get(&(material, key)) {
            None => return Vec::new(),
            Some(Err(why)) => return self.refused(material, key, why),
            Some(Ok(of)) => of,
        };
        let mut found = Vec::new();
        for pair in self.pairs(material, &[of]) {
            let (upper, lower) = (&pair.upper, &pair.lower);
            let shared = self.shared(of, upper, lower);
            let blank = self.blank(Kind::Environment, material, key, (&upper.name, &lower.name));
            let pooled = self
                .difference(of, upper, lower, &shared)
                .filter(|_| !shared.is_empty() || self.rules.voltages_together);
            match pooled {
                Some(factors) => {
                    found.push(self.contrast(
                        &[(of, factors, 1.0)],
                        &shared,
                        pair.is_of_study,
                        blank.clone(),
                    ));
                }
                None if pair.is_of_study => found.push(Answer {
                    is_of_study: true,
                    reason: Some("it was not determined on both sides at any voltage".to_owned()),
                    ..blank.clone()
                }),
                None => {}
            }
            if let ([single_upper], [single_lower]) = (&upper.surroundings[..], &lower.surroundings[..]) {
                for voltage in 0..self.conditions.voltages_v.len() {
                    let cells = ((*single_upper, voltage), (*single_lower, voltage));
                    if shared != [voltage] {
                        found.extend(self.at_voltage(of, cells, blank.clone()));
                    }
                }
            }
            found.extend(self.by_voltage(of, &pair, &shared, material, key));
        }
        found
    }

    /// One condition against another at one voltage; a bound where one side is one.
    pub(super) fn at_voltage(&self, of: &Combinations, cells: (Cell, Cell), blank: Answer) -> Option<Answer> {
        let (upper, lower) = (of.at(cells.0), of.at(cells.1));
        if let (Some(above), Some(below)) = (upper, lower) {
            let mut factors = vec![0.0; of.cells.len()];
            (factors[above], factors[below]) = (1.0, -1.0);
            return Some(self.contrast(&[(of, factors, 1.0)], &[cells.0.1], false, blank));
        }
        let side = |cell: Cell, at: Option<usize>| -> Option<Bound> {
            let Some(at) = at else {
                return of.bounds.get(&cell).copied();
            };
            let mut factors = vec![0.0; of.cells.len()];
            factors[at] = 1.0;
            let own = of.by_fits(&factors)?;
            let reach = NORMAL_95 * own.error();
            Some(Bound {
                below: Some(own.mean() + reach),
                above: Some(own.mean() - reach),
            })
        };
        let (above, below) = (side(cells.0, upper)?, side(cells.1, lower)?);
        let both = |a: Option<f64>, b: Option<f64>| Some(Answer::shown(blank.scale, a? - b?));
        let (at_least, at_most) = (both(above.above, below.below), both(above.below, below.above));
        (at_least.is_some() || at_most.is_some()).then(|| Answer {
            at_least,
            at_most,
            voltages_v: vec![self.conditions.voltages_v[cells.0.1]],
            ..blank
        })
    }

    /// Whether a pair differs otherwise at the highest voltage than at the lowest.
    pub(super) fn by_voltage(
        &self,
        of: &Combinations,
        pair: &Pair,
        shared: &[usize],
        material: usize,
        key: &'static str,
    ) -> Option<Answer> {
        let (low, high) = (*shared.first()?, *shared.last()?);
        if low == high || self.rules.voltages_together {
            return None;
        }
        let at = |voltage| self.difference(of, &pair.upper, &pair.lower, &[voltage]);
        let factors = at(high)?
            .iter()
            .zip(at(low)?)
            .map(|(high, low)| high - low)
            .collect();
        let volts = |voltage: usize| volts(self.conditions.voltages_v[voltage]);
        let names = (
            format!("{} at {}", pair.upper.name, volts(high)),
            format!("{} at {}", pair.lower.name, volts(low)),
        );
        let blank = self.blank(Kind::ByVoltage, material, key, (&names.0, &names.1));
        Some(self.contrast(&[(of, factors, 1.0)], &[low, high], false, blank))
    }

    /// Whether a pair differs otherwise than in the first material.
    pub(super) fn by_material(&self, pair: &Pair, material: usize, key: &'static str) -> Option<Answer> {
        if material == 0 {
            return None;
        }
        let (own, first) = (self.measured(material, key)?, self.measured(0, key)?);
        let shared: Vec<usize> = (self.shared(own, &pair.upper, &pair.lower).into_iter())
            .filter(|voltage| self.shared(first, &pair.upper, &pair.lower).contains(voltage))
            .collect();
        if shared.is_empty() {
            return None;
        }
        let mut terms = Vec::new();
        for (of, sign) in [(first, 1.0), (own, -1.0)] {
            let factors = self.difference(of, &pair.upper, &pair.lower, &shared)?;
            terms.push((of, factors, sign));
        }
        let mut blank = self.blank(Kind::ByMaterial, 0, key, (&pair.upper.name, &pair.lower.name));
        blank.against_material = Some(self.conditions.materials[material].clone());
        let is_asked = pair.is_of_study && self.asks(Factor::Material);
        Some(self.contrast(&terms, &shared, is_asked, blank))
    }
}
