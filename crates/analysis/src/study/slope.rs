//! The slope of one parameter of one material over the humidity, of the strips that were measured and of their material.
//!
//! In the strips as they are each has a level of its own, and all have one slope where theirs do not differ by more than
//! runs do; else it is the mean of theirs, each weighed as it is known. Of the material the strips are a sample: that theirs
//! differ is part of the error. In both the runs of a strip in one surroundings share what is left to chance.

use ieap_numerics::grouped::Grouped;
use ieap_numerics::mixed::{Estimated, MixedModel};

use super::also::USE;
use super::measured::{Measured, Row, Value, distinct, model, one_of};
use super::policy::{MOST_STRIPS, ONE_SLOPE};
use crate::conditions::HUMIDITY_GAP_PERCENT;
use crate::laws::Covariate;
use crate::laws::facts::RunFacts;
use crate::laws::policy::{INFLATION_LIMIT, LEFT_FOR_OTHERS, LEFT_FOR_TIED, TIED_ABOVE};

/// A model with the combination of its columns that is the slope.
pub(super) type Told = (Measured, Vec<f64>);

/// A slope in both scopes.
pub(super) struct Slope {
    /// Of the strips as they are; none where no strip was measured at two
    /// humidities, and of more than [`MOST_STRIPS`], whose material tells as much.
    pub strips: Option<Told>,
    /// Of the material; none of one strip.
    pub material: Option<Told>,
    /// How the strips' own slopes differ; none of one strip, and where the runs do not tell it.
    pub differ: Option<Differ>,
    /// From the least to the largest humidity, percent.
    pub range: (f64, f64),
    /// What changed with it so that the design cannot tell them apart.
    pub tied: Vec<Covariate>,
}

/// How the strips' own slopes differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Differ {
    /// Chance of it where all have one slope.
    pub p: f64,
    /// Least slope.
    pub least: f64,
    /// Largest slope.
    pub largest: f64,
}

/// Where levels of the humidity begin: at each value that lies further than the gap between two levels from the begin of the
/// last, so that a range without gaps has levels too.
pub(super) fn levels(of: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = of.collect();
    all.sort_by(f64::total_cmp);
    let mut begins: Vec<f64> = Vec::new();
    for own in all {
        if begins.last().is_none_or(|last| own - last > HUMIDITY_GAP_PERCENT) {
            begins.push(own);
        }
    }
    begins
}

/// Runs over the humidity.
struct Over<'a> {
    values: &'a [Value],
    /// Place of each value's sample among those that have one.
    sample: Vec<usize>,
    samples: usize,
    /// The humidity about its mean, in halves of its range.
    x: Vec<f64>,
    /// Columns that are taken out: levels, and what the design can carry beside.
    beside: Vec<Vec<f64>>,
    /// Surroundings and level of each value, and all that there are.
    part: Vec<(usize, usize)>,
    parts: Vec<(usize, usize)>,
}

impl Slope {
    /// None where nothing tells a slope. `level`: what a value has a level of its own for.
    pub fn of(values: &[Value], facts: &[RunFacts], level: impl Fn(&Value) -> usize) -> Option<Slope> {
        let numbers: Vec<f64> = values
            .iter()
            .map(|value| value.humidity_percent)
            .collect::<Option<_>>()?;
        let ends = (
            numbers.iter().copied().reduce(f64::min)?,
            numbers.iter().copied().reduce(f64::max)?,
        );
        let half = 0.5 * (ends.1 - ends.0);
        if half <= 0.0 {
            return None;
        }
        let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
        let begins = levels(numbers.iter().copied());
        let begin = |own: f64| begins.partition_point(|begin| *begin <= own);
        let part: Vec<(usize, usize)> = (values.iter().zip(&numbers))
            .map(|(value, own)| (value.cell.0, begin(*own)))
            .collect();
        let names = distinct(values.iter().map(|value| value.sample));
        let at = |value: &Value| names.binary_search(&value.sample).unwrap_or(0);
        let of_levels = distinct(values.iter().map(&level));
        let column = |own: &usize| -> Vec<f64> {
            let is = |value: &Value| f64::from(u8::from(level(value) == *own));
            values.iter().map(is).collect()
        };
        let mut over = Over {
            sample: values.iter().map(at).collect(),
            samples: names.len(),
            x: numbers.iter().map(|own| (own - mean) / half).collect(),
            beside: of_levels.iter().map(column).collect(),
            parts: distinct(part.iter().copied()),
            part,
            values,
        };
        let tied = over.carry(facts);
        let (strips, differ) = if over.samples <= MOST_STRIPS {
            over.of_strips(half).unzip()
        } else {
            (None, None)
        };
        let material = over.of_material(half);
        (strips.is_some() || material.is_some()).then_some(Slope {
            strips,
            material,
            differ: differ.flatten(),
            range: ends,
            tied,
        })
    }
}

impl Over<'_> {
    /// Decides which further covariates are taken out beside the slope: those that the design tells from it and has the runs
    /// for. Gives those that it does not.
    fn carry(&mut self, facts: &[RunFacts]) -> Vec<Covariate> {
        let known = |covariate: Covariate| -> Option<(Covariate, Vec<f64>)> {
            let number = |value: &Value| Some(facts[value.place].numbers.get(&covariate)?.value);
            Some((covariate, self.values.iter().map(number).collect::<Option<_>>()?))
        };
        let asked: Vec<(Covariate, Vec<f64>)> = known(Covariate::Temperature)
            .into_iter()
            .chain(USE.into_iter().find_map(known))
            .collect();
        let square = |grouped: &Grouped| -> f64 { grouped.residual(&self.x).iter().map(|x| x * x).sum() };
        // What differs from one strip and level to the next is told from as many numbers as there are of these.
        let cells = distinct(self.sample.iter().zip(&self.part)).len();
        let mut left = cells.saturating_sub(self.samples + 1);
        let mut grouped = Grouped::new(&vec![1.0; self.values.len()], &self.sample, &self.beside);
        let (mut carried, mut tied) = (Vec::new(), Vec::new());
        for (covariate, column) in asked {
            let mut with = grouped.clone();
            if !with.take_out(&column) {
                continue;
            }
            let inflation = square(&grouped) / square(&with);
            let needed = if inflation > TIED_ABOVE {
                LEFT_FOR_TIED
            } else {
                LEFT_FOR_OTHERS
            };
            if inflation <= INFLATION_LIMIT && left > needed {
                (grouped, left) = (with, left - 1);
                carried.push(column);
            } else if inflation > TIED_ABOVE {
                tied.push(covariate);
            }
        }
        self.beside.extend(carried);
        tied
    }

    /// Columns beside the levels of groups that do not depend on each other: those to take out, and of `slopes` those that are
    /// left.
    fn columns(&self, group: &[usize], slopes: Vec<Vec<f64>>) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
        let mut grouped = Grouped::new(&vec![1.0; self.values.len()], group, &[]);
        let mut independent = |columns: Vec<Vec<f64>>| -> Vec<Vec<f64>> {
            columns.into_iter().filter(|own| grouped.take_out(own)).collect()
        };
        (independent(self.beside.clone()), independent(slopes))
    }

    /// The slope of the strips as they are.
    fn of_strips(&self, half: f64) -> Option<(Told, Option<Differ>)> {
        let samples: Vec<usize> = (0..self.samples).collect();
        let measured = |slopes: Vec<Vec<f64>>| {
            let (beside, slopes) = self.columns(&self.sample, slopes);
            let before = self.samples + beside.len();
            let of: Vec<Vec<f64>> = beside.into_iter().chain(slopes).collect();
            let row = |k: usize| Row {
                block: self.sample[k],
                fixed: [
                    one_of(&samples, &self.sample[k]),
                    of.iter().map(|own| own[k]).collect(),
                ]
                .concat(),
                random: one_of(&self.parts, &self.part[k]),
            };
            let model = self.model(row, vec![0; self.parts.len()]);
            let columns = before..self.samples + of.len();
            (!columns.is_empty()).then_some((Measured::of_columns(self.values.to_vec(), &model)?, columns))
        };
        let (one, columns) = measured(vec![self.x.clone()])?;
        let mut factors = vec![0.0; columns.end];
        factors[columns.start] = half.recip();
        let of_sample = |sample: usize| -> Vec<f64> {
            let own = self.x.iter().zip(&self.sample);
            own.map(|(x, of)| if *of == sample { *x } else { 0.0 }).collect()
        };
        let own =
            measured((0..self.samples).map(of_sample).collect()).filter(|(_, columns)| columns.len() > 1);
        let Some((own, columns)) = own.filter(|(own, _)| own.estimated().is_some()) else {
            return Some(((one, factors), None));
        };
        let differ = own.estimated().map(|of| differ(of, columns.clone(), half));
        if differ.is_none_or(|differ| differ.p > ONE_SLOPE) {
            return Some(((one, factors), differ));
        }
        let mean = own.estimated().map(|of| mean(of, columns, half));
        Some(((own, mean.unwrap_or_default()), differ))
    }

    /// The slope of the material; none of one strip.
    fn of_material(&self, half: f64) -> Option<Told> {
        if self.samples < 2 {
            return None;
        }
        let (beside, slope) = self.columns(&vec![0; self.values.len()], vec![self.x.clone()]);
        let of: Vec<Vec<f64>> = beside.into_iter().chain(slope).collect();
        let row = |k: usize| Row {
            block: self.sample[k],
            fixed: std::iter::once(1.0).chain(of.iter().map(|own| own[k])).collect(),
            random: [vec![1.0, self.x[k]], one_of(&self.parts, &self.part[k])].concat(),
        };
        let components = [0, 1].into_iter().chain(self.parts.iter().map(|_| 2)).collect();
        let mut factors = vec![0.0; of.len() + 1];
        *factors.last_mut()? = half.recip();
        let model = self.model(row, components);
        Some((Measured::of_columns(self.values.to_vec(), &model)?, factors))
    }

    fn model(&self, row: impl Fn(usize) -> Row, component_of: Vec<usize>) -> MixedModel {
        model(self.values, (0..self.values.len()).map(row), component_of)
    }
}

/// How slopes, the coefficients at `columns`, differ.
fn differ(of: &Estimated, columns: std::ops::Range<usize>, half: f64) -> Differ {
    let slopes = || columns.clone().map(|k| of.coefficients[k] / half);
    let against_first = |k: usize| {
        let mut factors = vec![0.0; of.coefficients.len()];
        (factors[columns.start], factors[k]) = (1.0, -1.0);
        factors
    };
    let contrasts: Vec<Vec<f64>> = columns.clone().skip(1).map(against_first).collect();
    Differ {
        p: of.joint_chance(&contrasts),
        least: slopes().fold(f64::INFINITY, f64::min),
        largest: slopes().fold(f64::NEG_INFINITY, f64::max),
    }
}

/// The combination that is the mean of slopes, each weighed as it is known.
fn mean(of: &Estimated, columns: std::ops::Range<usize>, half: f64) -> Vec<f64> {
    let keep: Vec<usize> = columns.clone().collect();
    let weights = of.plain.part(&keep).solve(&vec![1.0; keep.len()], 1e-12);
    let sum: f64 = weights.iter().sum();
    let mut factors = vec![0.0; of.coefficients.len()];
    columns
        .zip(weights)
        .for_each(|(k, weight)| factors[k] = weight / sum / half);
    factors
}
