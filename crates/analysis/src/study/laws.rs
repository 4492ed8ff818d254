//! Questions about the voltage, laws of the humidity, and laws of what else differs from run to run.

use ieap_domain::Factor;

use super::also::{USE, changed_with};
use super::answer::{Answer, Drawn, Kind, Point, Scope};
use super::asking::Asking;
use super::combined::Term;
use super::measured::{Measured, Value, distinct};
use super::policy::FEWEST_LEVELS;
use super::scoped::Scoped;
use super::slope::{Followed, Other, Over, Slope, set_humidities};
use crate::conditions::{Conditions, HUMIDITY_KNOWN_TO_PERCENT, volts};
use crate::laws::Covariate;
use crate::laws::facts::RunFacts;
use crate::laws::policy::{FEWEST_OF_A_KIND, INFLATION_LIMIT};

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
            found.push(self.contrast(&[(of, factors, 1.0)], &ends, false, blank));
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
            let sizes = of
                .values
                .iter()
                .map(|own| self.conditions.voltages_v[own.cell.1].abs());
            found.push(Answer {
                also_changed: changed_with(self.facts, &of.values, &sizes.collect::<Vec<f64>>()),
                ..self.contrast(&[(of, factors, 1.0)], &used, asks, blank)
            });
        } else if let ([low, high], Some(factors)) = (&self.conditions.voltages_v[..], mean_of(&steps)) {
            let blank = self.blank(Kind::Voltage, material, key, (&volts(*high), &volts(*low)));
            found.push(self.contrast(&[(of, factors, 1.0)], &[0, 1], asks, blank));
        }
        found
    }

    /// The law of the humidity.
    pub(super) fn humidity_law(&self, material: usize, key: &'static str) -> Option<Answer> {
        let slope = self.slopes.get(&(material, key))?;
        let blank = self.blank(Kind::HumidityLaw, material, key, ("relative humidity", ""));
        let blank = Answer {
            covariate: Some(Covariate::RelativeHumidity.key()),
            ..blank
        };
        Some(self.law(&[(slope, 1.0)], self.asks(Factor::Humidity), blank))
    }

    /// Laws of what differs from run to run beside environment, humidity and voltage. Where campaign.toml says nothing of what is
    /// compared, the study asks of every condition among them.
    pub(super) fn other_laws(&self, material: usize, key: &'static str) -> Vec<Answer> {
        let all = self.others.get(&(material, key)).map_or(&[][..], Vec::as_slice);
        let answer = |other: &Other| {
            let (upper, lower) = (other.upper.as_str(), other.lower.as_str());
            let blank = Answer {
                covariate: Some(other.of.key()),
                ..self.blank(Kind::OtherLaw, material, key, (upper, lower))
            };
            let asks = self.rules.compare.is_empty() && other.of.is_condition();
            let answer = self.law(&[(&other.slope, 1.0)], asks, blank);
            Answer {
                from_to: answer.from_to.filter(|_| lower.is_empty()),
                ..answer
            }
        };
        all.iter().map(answer).collect()
    }

    /// Whether the first material follows the humidity otherwise.
    pub(super) fn humidity_by_material(&self, material: usize, key: &'static str) -> Option<Answer> {
        let of = |material| self.slopes.get(&(material, key));
        let (own, first) = (of(material)?, of(0).filter(|_| material > 0)?);
        let mut blank = self.blank(Kind::HumidityByMaterial, 0, key, ("relative humidity", ""));
        blank.against_material = Some(self.conditions.materials[material].clone());
        blank.covariate = Some(Covariate::RelativeHumidity.key());
        let is_asked = self.asks(Factor::Humidity) && self.asks(Factor::Material);
        Some(self.law(&[(first, 1.0), (own, -1.0)], is_asked, blank))
    }

    /// Values brought to the mean of what was taken out, for a picture; none where nothing tells the scatter.
    fn drawn(&self, slope: &Slope, scope: Scope) -> Option<Drawn> {
        let told = match scope {
            Scope::Strips => slope.scoped.strips.as_ref()?,
            Scope::Material => slope.scoped.material.as_ref()?,
        };
        let size = told.of.estimated()?.combined(&told.factors).mean();
        let count = told.fitted.len() as f64;
        let mean_x = slope.numbers.iter().sum::<f64>() / count;
        let mean_y = told.fitted.iter().sum::<f64>() / count;
        let each = told.of.values.iter().zip(&slope.numbers).zip(&told.fitted);
        let point = |((own, x), fitted): ((&Value, &f64), &f64)| Point {
            sample: self.facts[own.place].sample.clone(),
            run: self.facts[own.place].run,
            x: *x,
            y: own.y - fitted + mean_y + size * (x - mean_x),
            error: own.variance.sqrt(),
        };
        Some(Drawn {
            middle: (mean_x, mean_y),
            points: each.map(point).collect(),
        })
    }

    /// A sum of slopes.
    fn law(&self, slopes: &[(&Slope, f64)], is_asked: bool, blank: Answer) -> Answer {
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
        let of: Vec<(&Scoped, f64)> = slopes
            .iter()
            .map(|(slope, sign)| (&slope.scoped, *sign))
            .collect();
        let voltages = |told: &[Term]| {
            distinct((told.iter()).flat_map(|term| term.of.values.iter().map(|own| own.cell.1)))
        };
        let blank = Answer {
            from_to: Some(ends),
            span: Some(ends.1 - ends.0),
            ..blank
        };
        let answer = self.in_scopes(&of, voltages, is_asked, blank);
        let drawn = match slopes {
            [(slope, _)] => self.drawn(slope, answer.scope),
            _ => None,
        };
        Answer {
            drawn,
            also_changed: tied,
            ..answer
        }
    }
}

/// What else a parameter may follow: of what says how long a strip was used the first that is known.
pub(super) fn followed(facts: &[RunFacts]) -> Vec<Covariate> {
    let has = |of: &Covariate| {
        let mut all = facts.iter();
        all.any(|fact| fact.numbers.contains_key(of) || fact.names.contains_key(of))
    };
    let mut found: Vec<Covariate> = vec![Covariate::Temperature];
    found.extend(USE.into_iter().find(has));
    found.extend([
        Covariate::Exposure,
        Covariate::RestBefore,
        Covariate::FirstRun,
        Covariate::Direction,
        Covariate::Instrument,
        Covariate::Calibration,
        Covariate::Operator,
    ]);
    let declared = facts
        .iter()
        .flat_map(|fact| fact.numbers.keys().chain(fact.names.keys()));
    let is_tag = |of: &&Covariate| matches!(of, Covariate::TagNumber(_) | Covariate::TagName(_));
    found.extend(distinct(declared.filter(is_tag).copied()));
    found.retain(has);
    found
}

/// Slopes over what else differs, beside a level for each condition: of what the design tells from the conditions, and of
/// which each side was measured often enough.
pub(super) fn other_slopes(all: &Measured, facts: &[RunFacts]) -> Vec<Other> {
    followed(facts)
        .into_iter()
        .flat_map(|of| others_of(all, facts, of))
        .collect()
}

fn others_of(all: &Measured, facts: &[RunFacts], of: Covariate) -> Vec<Other> {
    let name = |own: &&Value| facts[own.place].names.get(&of).map(String::as_str);
    let names = distinct(all.values.iter().filter_map(|own| name(&own)));
    let slope = |values: &[Value], numbers: Vec<f64>| {
        let least = numbers.iter().copied().reduce(f64::min)?;
        let raised = numbers.iter().filter(|own| **own > least).count();
        (raised.min(numbers.len() - raised) >= FEWEST_OF_A_KIND
            || distinct(numbers.iter().map(|own| own.to_bits())).len() >= FEWEST_LEVELS)
            .then_some(())?;
        let over = over_conditions(values, &Followed { of, numbers }, facts)?;
        (over.inflation() <= INFLATION_LIMIT).then(|| Slope::of(&over))?
    };
    let other = |upper: &str, lower: &str, slope: Option<Slope>| {
        Some(Other {
            of,
            upper: upper.to_owned(),
            lower: lower.to_owned(),
            slope: slope?,
        })
    };
    if let [first, others @ ..] = &names[..] {
        let against_first = |own: &&str| {
            let is_of = |value: &&Value| name(value).is_some_and(|of| of == *own || of == *first);
            let values: Vec<Value> = all.values.iter().filter(is_of).copied().collect();
            let numbers = values
                .iter()
                .map(|value| f64::from(u8::from(name(&value) == Some(*own))));
            let found = slope(&values, numbers.collect());
            other(&format!("{} {own}", of.label()), first, found)
        };
        return others.iter().filter_map(against_first).collect();
    }
    let (values, numbers) = stating(all, facts, of);
    other(of.label(), "", slope(&values, numbers))
        .into_iter()
        .collect()
}

/// Values of runs that state a number, with that.
pub(super) fn stating(all: &Measured, facts: &[RunFacts], of: Covariate) -> (Vec<Value>, Vec<f64>) {
    let number = |own: &Value| Some((*own, facts[own.place].numbers.get(&of)?.value));
    all.values.iter().filter_map(number).unzip()
}

/// Values over what is followed, beside a level for each condition.
pub(super) fn over_conditions<'a>(
    values: &'a [Value],
    followed: &Followed,
    facts: &[RunFacts],
) -> Option<Over<'a>> {
    let cells = distinct(values.iter().map(|own| own.cell));
    Over::new(values, followed, facts, |own| {
        cells.binary_search(&own.cell).unwrap_or(0)
    })
}

/// Values over the humidity, beside a level for each environment and voltage where the humidity of an environment was varied,
/// else beside one for each voltage where it was set to three or more.
pub(super) fn of_humidity(all: &Measured, conditions: &Conditions) -> Option<Vec<Value>> {
    let known = all.values.iter().filter(|own| own.humidity_percent.is_some());
    let known: Vec<Value> = known.copied().collect();
    let varied = varied(&known, conditions);
    let environment = |own: &Value| conditions.surroundings[own.cell.0].environment.as_str();
    let is_of = |own: &&Value| varied.is_empty() || varied.contains(&environment(own));
    let values: Vec<Value> = known.iter().filter(is_of).copied().collect();
    let set = set_humidities(values.iter().filter_map(|own| own.humidity_percent));
    (!varied.is_empty() || set.len() >= FEWEST_LEVELS).then_some(values)
}

/// Environments of these values whose humidity was varied: by more than it is known to, and not between two levels, of which
/// the one against the other says it all.
fn varied<'a>(known: &[Value], conditions: &'a Conditions) -> Vec<&'a str> {
    let environment = |own: &Value| conditions.surroundings[own.cell.0].environment.as_str();
    let is_varied = |name: &&str| {
        let own = || known.iter().filter(|own| environment(own) == *name);
        let humidities = own().filter_map(|own| own.humidity_percent);
        let (low, high) = ends(humidities).unwrap_or_default();
        let levels = distinct(own().map(|own| own.cell.0)).len();
        high - low > 2.0 * HUMIDITY_KNOWN_TO_PERCENT && levels != 2
    };
    let names = distinct(known.iter().map(environment));
    names.into_iter().filter(is_varied).collect()
}

/// The values of [`of_humidity`] as the slope takes them.
pub(super) fn over_humidity<'a>(
    values: &'a [Value],
    conditions: &Conditions,
    facts: &[RunFacts],
) -> Option<Over<'a>> {
    let varied = varied(values, conditions);
    let environment = |own: &Value| conditions.surroundings[own.cell.0].environment.as_str();
    let level = |own: &Value| (varied.binary_search(&environment(own)).unwrap_or(0), own.cell.1);
    let distinct = distinct(values.iter().map(level));
    let numbers = values.iter().filter_map(|own| own.humidity_percent).collect();
    let of = Covariate::RelativeHumidity;
    Over::new(values, &Followed { of, numbers }, facts, |own| {
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
