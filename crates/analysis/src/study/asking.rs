//! The questions: which combination of conditions answers each.

use std::collections::BTreeMap;

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Factor, StudyRules};
use ieap_numerics::student::{quantile, quantile_95, two_sided_chance};

use super::also::also_changed;
use super::answer::{Answer, Basis, Kind, Scale, Verdict};
use super::measured::{Bound, Cell, Measured, Value};
use super::measures::{BENDING_LOST, MEASURES};
use super::policy::{FEWEST_LEVELS, LEAST_ERROR, MOST_FOR_ALL_PAIRS};
use crate::conditions::{Conditions, HUMIDITY_GAP_PERCENT, volts};
use crate::laws::facts::RunFacts;

/// All that questions are asked of.
pub struct Asking<'a> {
    pub rules: &'a StudyRules,
    pub compared: &'a [Factor],
    pub conditions: &'a Conditions,
    pub facts: &'a [RunFacts],
    /// Of each material and parameter; why its values cannot be compared, where they cannot.
    pub measured: BTreeMap<(usize, &'static str), Result<Measured, &'static str>>,
}

/// Surroundings as one side of a comparison.
#[derive(Debug, Clone, PartialEq)]
struct Side {
    name: String,
    surroundings: Vec<usize>,
}

/// Two sides, and whether the study asks for them.
struct Pair {
    upper: Side,
    lower: Side,
    is_of_study: bool,
}

/// A combination of the conditions of one parameter of one material.
struct Term<'a> {
    of: &'a Measured,
    factors: Vec<f64>,
}

impl Asking<'_> {
    /// Every answer, by material.
    pub fn answers(&self) -> Vec<Answer> {
        let materials = 0..self.conditions.materials.len();
        let all = materials.flat_map(|material| {
            let of_key = |key| {
                let mut found = self.environments(material, key);
                found.extend(self.voltages(material, key));
                found.extend(self.humidity_law(material, key));
                found.extend(self.materials(material, key));
                found
            };
            let mut found: Vec<Answer> = MEASURES.into_iter().flat_map(of_key).collect();
            found.sort_by_key(|own| (!own.is_of_study, own.kind));
            found
        });
        all.collect()
    }

    fn measured(&self, material: usize, key: &'static str) -> Option<&Measured> {
        self.measured.get(&(material, key))?.as_ref().ok()
    }

    fn asks(&self, factor: Factor) -> bool {
        self.compared.contains(&factor)
    }

    /// Surroundings in which a material was measured.
    fn surroundings(&self, material: usize) -> Vec<usize> {
        let of = self
            .conditions
            .measured
            .iter()
            .filter(|own| own.material == material);
        let mut found: Vec<usize> = of.map(|own| own.surroundings).collect();
        found.dedup();
        found
    }

    /// Sides that the study compares: surroundings, or an environment as a whole where a law answers what its humidity does.
    fn sides(&self, material: usize) -> Vec<Side> {
        let all = self.surroundings(material);
        let known = &self.conditions.surroundings;
        let middle = |at: usize| {
            known[at]
                .humidity
                .map(|level| 0.5 * (level.low_percent + level.high_percent))
        };
        let levels: Vec<f64> = all.iter().filter_map(|&at| middle(at)).collect();
        let has_law = self.asks(Factor::Humidity) && count_levels(levels) >= FEWEST_LEVELS;
        let mut sides: Vec<Side> = Vec::new();
        for at in all {
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
    /// do against them; else each is held against the first. Surroundings are held against each other as details.
    fn pairs(&self, material: usize) -> Vec<Pair> {
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
                wet.iter().for_each(|side| add(side, &together, asks));
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

    /// Voltages at which both sides have a value in all of their surroundings.
    fn shared(&self, of: &Measured, upper: &Side, lower: &Side) -> Vec<usize> {
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
    fn difference(&self, of: &Measured, upper: &Side, lower: &Side, voltages: &[usize]) -> Option<Vec<f64>> {
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

    /// What the study asked of a parameter whose values cannot be compared.
    fn refused(&self, material: usize, key: &'static str, why: &str) -> Vec<Answer> {
        let pairs = self.pairs(material).into_iter().filter(|pair| pair.is_of_study);
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

    fn environments(&self, material: usize, key: &'static str) -> Vec<Answer> {
        let of = match self.measured.get(&(material, key)) {
            None => return Vec::new(),
            Some(Err(why)) => return self.refused(material, key, why),
            Some(Ok(of)) => of,
        };
        let mut found = Vec::new();
        for pair in self.pairs(material) {
            let (upper, lower) = (&pair.upper, &pair.lower);
            let shared = self.shared(of, upper, lower);
            let blank = self.blank(Kind::Environment, material, key, (&upper.name, &lower.name));
            let pooled = self
                .difference(of, upper, lower, &shared)
                .filter(|_| !shared.is_empty() || self.rules.voltages_together);
            match pooled {
                Some(factors) => {
                    found.push(self.answer(
                        &[Term { of, factors }],
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
            found.extend(self.by_material(&pair, material, key));
        }
        found
    }

    /// One condition against another at one voltage; a bound where one side is one.
    fn at_voltage(&self, of: &Measured, cells: (Cell, Cell), blank: Answer) -> Option<Answer> {
        let (upper, lower) = (of.at(cells.0), of.at(cells.1));
        if let (Some(above), Some(below)) = (upper, lower) {
            let mut factors = vec![0.0; of.cells.len()];
            (factors[above], factors[below]) = (1.0, -1.0);
            return Some(self.answer(&[Term { of, factors }], &[cells.0.1], false, blank));
        }
        let side = |cell: Cell, at: Option<usize>| -> Option<Bound> {
            let Some(at) = at else {
                return of.bounds.get(&cell).copied();
            };
            let mut factors = vec![0.0; of.cells.len()];
            factors[at] = 1.0;
            let own = of.by_fits(&factors)?;
            let reach = NORMAL_95 * own.variance.sqrt();
            Some(Bound {
                below: Some(own.value + reach),
                above: Some(own.value - reach),
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
    fn by_voltage(
        &self,
        of: &Measured,
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
        Some(self.answer(&[Term { of, factors }], &[low, high], false, blank))
    }

    /// Whether a pair differs otherwise than in the first material.
    fn by_material(&self, pair: &Pair, material: usize, key: &'static str) -> Option<Answer> {
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
            let factors = factors.into_iter().map(|factor| sign * factor).collect();
            terms.push(Term { of, factors });
        }
        let mut blank = self.blank(Kind::ByMaterial, 0, key, (&pair.upper.name, &pair.lower.name));
        blank.against_material = Some(self.conditions.materials[material].clone());
        let is_asked = pair.is_of_study && self.asks(Factor::Material);
        Some(self.answer(&terms, &shared, is_asked, blank))
    }

    /// Highest against lowest voltage in each surroundings; over all of them the law of three voltages and more, else the ratio.
    fn voltages(&self, material: usize, key: &'static str) -> Vec<Answer> {
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
    fn humidity_law(&self, material: usize, key: &'static str) -> Option<Answer> {
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

    /// A material against the first, over the conditions that both have.
    fn materials(&self, material: usize, key: &'static str) -> Option<Answer> {
        if material == 0 {
            return None;
        }
        let (own, first) = (self.measured(material, key)?, self.measured(0, key)?);
        let shared: Vec<Cell> = own
            .cells
            .iter()
            .copied()
            .filter(|&cell| first.at(cell).is_some())
            .collect();
        if shared.is_empty() {
            return None;
        }
        let terms = [(own, 1.0), (first, -1.0)].map(|(of, sign)| {
            let factor = |cell: &Cell| {
                if shared.contains(cell) {
                    sign / shared.len() as f64
                } else {
                    0.0
                }
            };
            Term {
                of,
                factors: of.cells.iter().map(factor).collect(),
            }
        });
        let mut blank = self.blank(
            Kind::Material,
            material,
            key,
            (
                &self.conditions.materials[material],
                &self.conditions.materials[0],
            ),
        );
        blank.against_material = Some(self.conditions.materials[0].clone());
        let mut voltages: Vec<usize> = shared.iter().map(|cell| cell.1).collect();
        voltages.sort_unstable();
        voltages.dedup();
        Some(self.answer(&terms, &voltages, false, blank))
    }

    fn blank(
        &self,
        kind: Kind,
        material: usize,
        parameter: &'static str,
        (upper, lower): (&str, &str),
    ) -> Answer {
        let is_law = matches!(kind, Kind::HumidityLaw | Kind::VoltageLaw);
        Answer {
            kind,
            is_of_study: false,
            parameter,
            material: self.conditions.materials[material].clone(),
            against_material: None,
            upper: upper.to_owned(),
            lower: lower.to_owned(),
            voltages_v: Vec::new(),
            span: None,
            scale: match parameter {
                BENDING_LOST => Scale::Points,
                _ if is_law => Scale::PerUnit,
                _ => Scale::Ratio,
            },
            value: None,
            fits_low_95: None,
            fits_high_95: None,
            low_95: None,
            high_95: None,
            at_least: None,
            at_most: None,
            basis: Basis::Unknown,
            scatter: None,
            degrees_of_freedom: None,
            undone_by_scatter: None,
            no_more_than: None,
            p: None,
            q: None,
            verdict: Verdict::NotTold,
            samples: 0,
            runs: (0, 0),
            of_runs: Vec::new(),
            also_changed: Vec::new(),
            reason: None,
        }
    }

    /// The sum of some combinations as an answer.
    fn answer(&self, terms: &[Term], voltages: &[usize], is_of_study: bool, blank: Answer) -> Answer {
        let scale = blank.scale;
        let shown = |number: f64| Answer::shown(scale, number);
        // What an error of this size is called: percent of the parameter, or points.
        let size = |number: f64| match scale {
            Scale::Points => number,
            Scale::Ratio | Scale::PerUnit => 100.0 * number.exp_m1(),
        };
        let by_fits: Option<Vec<_>> = terms.iter().map(|term| term.of.by_fits(&term.factors)).collect();
        let Some(by_fits) = by_fits else {
            return blank;
        };
        let with_scatter: Option<Vec<_>> = terms
            .iter()
            .map(|term| term.of.with_scatter(&term.factors))
            .collect();
        // Values that are alike to the last digit tell no scatter.
        let with_scatter = with_scatter
            .filter(|all| all.iter().map(|(own, _)| own.variance).sum::<f64>().sqrt() > LEAST_ERROR);
        // Where the scatter is known, runs and samples are weighed by it.
        let value: f64 = match &with_scatter {
            Some(all) => all.iter().map(|(own, _)| own.value).sum(),
            None => by_fits.iter().map(|own| own.value).sum(),
        };
        let of_fits: f64 = by_fits.iter().map(|own| own.variance).sum();
        let reach = NORMAL_95 * of_fits.sqrt();
        let (upper, lower) = self.places(terms);
        let mut samples: Vec<&str> = upper
            .iter()
            .chain(&lower)
            .map(|&at| self.facts[at].sample.as_str())
            .collect();
        samples.sort_unstable();
        samples.dedup();
        let is_law = matches!(blank.kind, Kind::HumidityLaw | Kind::VoltageLaw);
        let mut answer = Answer {
            is_of_study,
            voltages_v: voltages
                .iter()
                .map(|&at| self.conditions.voltages_v[at])
                .collect(),
            value: Some(shown(value)),
            fits_low_95: Some(shown(value - reach)),
            fits_high_95: Some(shown(value + reach)),
            samples: samples.len(),
            runs: (upper.len(), lower.len()),
            of_runs: upper.iter().chain(&lower).map(|&at| self.facts[at].run).collect(),
            also_changed: if is_law {
                Vec::new()
            } else {
                also_changed(self.facts, &upper, &lower)
            },
            ..blank
        };
        if let Some(all) = with_scatter {
            let variance: f64 = all.iter().map(|(own, _)| own.variance).sum();
            // Satterthwaite's rule for a sum of variances.
            let parts: f64 = all
                .iter()
                .map(|(own, _)| own.variance.powi(2) / own.freedom)
                .sum();
            let freedom = if parts > 0.0 {
                variance * variance / parts
            } else {
                f64::INFINITY
            };
            let error = variance.sqrt();
            answer.low_95 = Some(shown(value - quantile_95(freedom) * error));
            answer.high_95 = Some(shown(value + quantile_95(freedom) * error));
            // Of a law, over all that was measured.
            let largest = value.abs() + quantile(0.95, freedom) * error;
            answer.no_more_than = Some(size(answer.span.unwrap_or(1.0) * largest));
            answer.p = Some(two_sided_chance(value / error, freedom));
            answer.degrees_of_freedom = freedom.is_finite().then_some(freedom);
            answer.basis = all
                .iter()
                .map(|(_, basis)| *basis)
                .max()
                .unwrap_or(Basis::Unknown);
            let scatter: f64 = terms
                .iter()
                .filter_map(|term| term.of.scatter())
                .fold(0.0, f64::max);
            answer.scatter = Some(if scale == Scale::Points {
                scatter
            } else {
                100.0 * scatter
            });
        }
        if terms.iter().all(|term| term.of.is_of_single_runs()) {
            let square: f64 = terms
                .iter()
                .flat_map(|term| &term.factors)
                .map(|factor| factor * factor)
                .sum();
            let left = (value / NORMAL_95).powi(2) - of_fits;
            answer.undone_by_scatter = (left > 0.0 && square > 0.0).then(|| size((left / square).sqrt()));
        }
        answer
    }

    /// Places of the runs above and below: those whose factor is positive, and negative.
    fn places(&self, terms: &[Term]) -> (Vec<usize>, Vec<usize>) {
        let (mut upper, mut lower) = (Vec::new(), Vec::new());
        for term in terms {
            for value in &term.of.values {
                match term.of.at(value.cell).map_or(1.0, |at| term.factors[at]) {
                    factor if factor > 0.0 => upper.push(value.place),
                    factor if factor < 0.0 => lower.push(value.place),
                    _ => {}
                }
            }
        }
        (upper, lower)
    }
}

/// Levels of humidity among some values.
fn humidity_levels(values: &[&Value]) -> usize {
    count_levels(values.iter().filter_map(|own| own.humidity_percent).collect())
}

/// Levels among some humidities, percent.
fn count_levels(mut all: Vec<f64>) -> usize {
    all.sort_by(f64::total_cmp);
    let gaps = all
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > HUMIDITY_GAP_PERCENT);
    gaps.count() + usize::from(!all.is_empty())
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
