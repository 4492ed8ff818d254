//! Questions about the voltage, and the law of the humidity.

use ieap_domain::Factor;

use super::answer::{Answer, Kind};
use super::asking::Asking;
use super::combined::Term;
use super::measured::{Measured, Value};
use super::policy::FEWEST_LEVELS;
use crate::conditions::{count_levels, volts};

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
            let blank = Answer {
                span: span(used.iter().map(|&at| self.conditions.voltages_v[at].abs())),
                ..self.blank(Kind::VoltageLaw, material, key, ("voltage", ""))
            };
            found.push(self.answer(&[Term { of, factors }], &used, asks, blank));
        } else if let ([low, high], Some(factors)) = (&self.conditions.voltages_v[..], mean_of(&steps)) {
            let blank = self.blank(Kind::Voltage, material, key, (&volts(*high), &volts(*low)));
            found.push(self.answer(&[Term { of, factors }], &[0, 1], asks, blank));
        }
        found
    }

    /// The slope over the humidity, beside a level for each environment and voltage where an environment was measured at three
    /// humidities or more, else beside one for each voltage.
    pub(super) fn humidity_law(&self, material: usize, key: &'static str) -> Option<Answer> {
        let all = self.measured(material, key)?;
        let known: Vec<Value> = all
            .values
            .iter()
            .filter(|own| own.humidity_percent.is_some())
            .copied()
            .collect();
        let environment = |own: &Value| self.conditions.surroundings[own.cell.0].environment.as_str();
        let mut environments: Vec<&str> = known.iter().map(environment).collect();
        environments.sort_unstable();
        environments.dedup();
        let of = |name: &str| {
            known
                .iter()
                .filter(|own| environment(own) == name)
                .collect::<Vec<_>>()
        };
        let varied: Vec<&str> = environments
            .iter()
            .copied()
            .filter(|name| humidity_levels(&of(name)) >= FEWEST_LEVELS)
            .collect();
        let values: Vec<Value> = match varied.is_empty() {
            false => known
                .iter()
                .filter(|own| varied.contains(&environment(own)))
                .copied()
                .collect(),
            true if humidity_levels(&known.iter().collect::<Vec<_>>()) >= FEWEST_LEVELS => known.clone(),
            true => return None,
        };
        let level = |own: &Value| {
            let at = varied
                .iter()
                .position(|name| *name == environment(own))
                .unwrap_or(0);
            (at, own.cell.1)
        };
        let mut distinct: Vec<(usize, usize)> = values.iter().map(level).collect();
        distinct.sort_unstable();
        distinct.dedup();
        let of = Measured::over_humidity(values, |own| distinct.binary_search(&level(own)).unwrap_or(0))?;
        let factors = of.slope();
        let blank = Answer {
            span: span(of.values.iter().filter_map(|own| own.humidity_percent)),
            ..self.blank(Kind::HumidityLaw, material, key, ("relative humidity", ""))
        };
        let mut voltages: Vec<usize> = of.values.iter().map(|own| own.cell.1).collect();
        voltages.sort_unstable();
        voltages.dedup();
        Some(self.answer(
            &[Term { of: &of, factors }],
            &voltages,
            self.asks(Factor::Humidity),
            blank,
        ))
    }
}

/// Levels of humidity among some values.
fn humidity_levels(values: &[&Value]) -> usize {
    count_levels(values.iter().filter_map(|own| own.humidity_percent).collect())
}

/// From the least to the largest of some numbers.
fn span(of: impl Iterator<Item = f64> + Clone) -> Option<f64> {
    let (low, high) = (of.clone().reduce(f64::min)?, of.reduce(f64::max)?);
    Some(high - low)
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
