//! Questions about the voltage, and laws of the humidity.

use ieap_domain::Factor;

use super::answer::{Answer, Kind, Scope};
use super::asking::Asking;
use super::combined::{Term, reach};
use super::measured::{Measured, Value, distinct};
use super::policy::FEWEST_LEVELS;
use super::slope::{Slope, Told, levels};
use crate::conditions::{Conditions, volts};
use crate::laws::facts::RunFacts;

impl Asking<'_> {
    /// Highest against lowest voltage in each surroundings; over all of them the law of three voltages and more, else the ratio.
    pub(super) fn voltages(&self, material: usize, key: &'static str) -> Vec<Answer> {
        let Some(of) = self.measured(material, key) else {
            return Vec::new();
        };
        let asks = self.asks(Factor::Voltage);
        let volt = |k: usize| self.conditions.voltages_v[of.cells[k].1];
        let (mut found, mut slopes, mut steps) = (Vec::new(), Vec::new(), Vec::new());
        let mut used: Vec<usize> = Vec::new();
        for at in self.surroundings(material) {
            let cells: Vec<usize> = (0..of.cells.len()).filter(|&k| of.cells[k].0 == at).collect();
            let [low, .., high] = cells[..] else {
                continue;
            };
            let mut factors = vec![0.0; of.cells.len()];
            (factors[high], factors[low]) = (1.0, -1.0);
            let name = self.conditions.surroundings[at].text();
            let names = (format!("{} in {name}", volts(volt(high))), volts(volt(low)));
            let blank = self.blank(Kind::Voltage, material, key, (&names.0, &names.1));
            let ends = [of.cells[low].1, of.cells[high].1];
            steps.push(factors.clone());
            found.push(self.answer(&[Term { of, factors }], &ends, false, blank));
            // A law goes over the size of the voltage: its sign is the side to which the strip bends.
            let size = |k: usize| volt(k).abs();
            let mut sizes: Vec<f64> = cells.iter().map(|&k| size(k)).collect();
            sizes.sort_by(f64::total_cmp);
            sizes.dedup();
            if sizes.len() >= FEWEST_LEVELS {
                let mean = cells.iter().map(|&k| size(k)).sum::<f64>() / cells.len() as f64;
                let square: f64 = cells.iter().map(|&k| (size(k) - mean).powi(2)).sum();
                let mut slope = vec![0.0; of.cells.len()];
                cells.iter().for_each(|&k| slope[k] = (size(k) - mean) / square);
                slopes.push(slope);
                used.extend(cells.iter().map(|&k| of.cells[k].1));
            }
        }
        if let Some(factors) = mean_of(&slopes) {
            used.sort_unstable();
            used.dedup();
            let ends = ends(used.iter().map(|&at| self.conditions.voltages_v[at].abs()));
            let blank = Answer {
                from_to: ends,
                span: ends.map(|(low, high)| high - low),
                ..self.blank(Kind::VoltageLaw, material, key, ("voltage", ""))
            };
            found.push(self.answer(&[Term { of, factors }], &used, asks, blank));
        } else if let ([low, high], Some(factors)) = (&self.conditions.voltages_v[..], mean_of(&steps)) {
            let blank = self.blank(Kind::Voltage, material, key, (&volts(*high), &volts(*low)));
            found.push(self.answer(&[Term { of, factors }], &[0, 1], asks, blank));
        }
        found
    }

    /// The law of the humidity.
    pub(super) fn humidity_law(&self, material: usize, key: &'static str) -> Option<Answer> {
        let slope = self.slopes.get(&(material, key))?;
        let blank = self.blank(Kind::HumidityLaw, material, key, ("relative humidity", ""));
        Some(self.law(&[(slope, 1.0)], self.asks(Factor::Humidity), blank))
    }

    /// Whether the first material follows the humidity otherwise.
    pub(super) fn humidity_by_material(&self, material: usize, key: &'static str) -> Option<Answer> {
        let of = |material| self.slopes.get(&(material, key));
        let (own, first) = (of(material)?, of(0).filter(|_| material > 0)?);
        let mut blank = self.blank(Kind::HumidityByMaterial, 0, key, ("relative humidity", ""));
        blank.against_material = Some(self.conditions.materials[material].clone());
        let is_asked = self.asks(Factor::Humidity) && self.asks(Factor::Material);
        Some(self.law(&[(first, 1.0), (own, -1.0)], is_asked, blank))
    }

    /// A sum of slopes: of the strips as they are, and beside it of their materials; of these alone where they tell more.
    fn law(&self, slopes: &[(&Slope, f64)], is_asked: bool, blank: Answer) -> Answer {
        let strips = terms(slopes, |slope| slope.strips.as_ref());
        let material = terms(slopes, |slope| slope.material.as_ref());
        // Where strips were measured at different humidities their material tells more than what differs within each.
        let by_strips = match (&strips, &material) {
            (Some(strips), Some(material)) => reach(strips) <= reach(material),
            (strips, _) => strips.is_some(),
        };
        let (scope, told) = if by_strips {
            (Scope::Strips, strips.as_ref())
        } else {
            (Scope::Material, material.as_ref())
        };
        let Some(told) = told else {
            return blank;
        };
        let voltages = distinct((told.iter()).flat_map(|term| term.of.values.iter().map(|own| own.cell.1)));
        let low = slopes.iter().map(|(slope, _)| slope.range.0).reduce(f64::max);
        let high = slopes.iter().map(|(slope, _)| slope.range.1).reduce(f64::min);
        let ends = low.zip(high).filter(|(low, high)| low < high);
        let Some(ends) = ends else {
            let reason = "no humidity lies within the range of both".to_owned();
            return Answer {
                reason: Some(reason),
                ..blank
            };
        };
        let mut tied: Vec<String> = (slopes.iter())
            .flat_map(|(slope, _)| &slope.tied)
            .map(|own| format!("the {}", own.label()))
            .collect();
        tied.dedup();
        let differ = slopes.first().filter(|_| slopes.len() == 1);
        let differ = differ.and_then(|(slope, _)| slope.differ);
        let answer = self.answer(
            told,
            &voltages,
            is_asked,
            Answer {
                from_to: Some(ends),
                span: Some(ends.1 - ends.0),
                ..blank
            },
        );
        Answer {
            scope,
            of_material: (material.filter(|_| scope == Scope::Strips)).and_then(|of| self.of_material(&of)),
            strips_differ_p: differ.map(|own| own.p),
            strips_from_to: differ.map(|own| (own.least, own.largest)),
            also_changed: tied,
            ..answer
        }
    }
}

/// Slopes in one scope, each with its sign; none where one is not told in it.
fn terms<'a>(slopes: &[(&'a Slope, f64)], scope: fn(&'a Slope) -> Option<&'a Told>) -> Option<Vec<Term<'a>>> {
    let term = |&(slope, sign): &(&'a Slope, f64)| {
        let (of, factors) = scope(slope)?;
        let factors = factors.iter().map(|factor| sign * factor).collect();
        Some(Term { of, factors })
    };
    slopes.iter().map(term).collect()
}

/// The slope of one parameter over the humidity, beside a level for each environment and voltage where an environment was
/// measured at three humidities or more, else beside one for each voltage; none of fewer.
pub(super) fn humidity_slope(all: &Measured, conditions: &Conditions, facts: &[RunFacts]) -> Option<Slope> {
    let known = all.values.iter().filter(|own| own.humidity_percent.is_some());
    let known: Vec<Value> = known.copied().collect();
    let environment = |own: &Value| conditions.surroundings[own.cell.0].environment.as_str();
    let has_law = |of: &mut dyn Iterator<Item = &Value>| {
        levels(of.filter_map(|own| own.humidity_percent)).len() >= FEWEST_LEVELS
    };
    let environments = distinct(known.iter().map(environment));
    let varied: Vec<&str> = environments
        .into_iter()
        .filter(|name| has_law(&mut known.iter().filter(|own| environment(own) == *name)))
        .collect();
    let is_of = |own: &&Value| varied.is_empty() || varied.contains(&environment(own));
    let values: Vec<Value> = known.iter().filter(is_of).copied().collect();
    let level = |own: &Value| (varied.binary_search(&environment(own)).unwrap_or(0), own.cell.1);
    let distinct = distinct(values.iter().map(level));
    has_law(&mut values.iter()).then_some(())?;
    Slope::of(&values, facts, |own| {
        distinct.binary_search(&level(own)).unwrap_or(0)
    })
}

/// The least and the largest of some numbers.
fn ends(of: impl Iterator<Item = f64> + Clone) -> Option<(f64, f64)> {
    of.clone().reduce(f64::min).zip(of.reduce(f64::max))
}

/// The mean of some combinations; none of none.
fn mean_of(all: &[Vec<f64>]) -> Option<Vec<f64>> {
    let count = all.len() as f64;
    let first = all.first()?;
    Some(
        (0..first.len())
            .map(|k| all.iter().map(|own| own[k]).sum::<f64>() / count)
            .collect(),
    )
}
