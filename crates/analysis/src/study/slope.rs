//! The slope of one parameter of one material over the humidity, or over another number that differs from run to run: of the
//! strips that were measured and of their material.
//!
//! In the strips as they are each has a level of its own, and all have one slope where theirs do not differ by more than
//! runs do; else it is the mean of theirs, each weighed as it is known. Of the material the strips are a sample: that theirs
//! differ is part of the error. In both the runs of a strip in one surroundings share what is left to chance.

use ieap_numerics::grouped::{Grouped, dot};
use ieap_numerics::mixed::Estimated;

use super::also::USE;
use super::measured::{Measured, Row, Value, distinct, model, one_of};
use super::policy::{LEAST_ERROR, MOST_STRIPS, ONE_SLOPE};
use crate::conditions::HUMIDITY_GAP_PERCENT;
use crate::laws::Covariate;
use crate::laws::facts::RunFacts;
use crate::laws::policy::{INFLATION_LIMIT, LEFT_FOR_OTHERS, LEFT_FOR_TIED, TIED_ABOVE};

/// A model with the combination of its columns that is the slope.
pub(super) struct Told {
    /// The model.
    pub of: Measured,
    /// The combination.
    pub factors: Vec<f64>,
    /// What the model makes of each value; empty where nothing tells the scatter.
    pub fitted: Vec<f64>,
}

/// What is followed: a number of each value.
pub(super) struct Followed {
    /// What it is of.
    pub of: Covariate,
    /// Of each value, in the unit of the covariate.
    pub numbers: Vec<f64>,
}

/// A slope in both scopes.
pub(super) struct Slope {
    /// Of the strips as they are; none where no strip was measured at two
    /// humidities, and of more than [`MOST_STRIPS`], whose material tells as much.
    pub strips: Option<Told>,
    /// Of the material; none of one strip.
    pub material: Option<Told>,
    /// How the strips' own slopes differ; none of one strip, and where the runs do not tell it.
    pub differ: Option<Differ>,
    /// From the least to the largest number, in its unit.
    pub range: (f64, f64),
    /// The numbers of its values.
    pub numbers: Vec<f64>,
    /// What changed with it so that the design cannot tell them apart.
    pub tied: Vec<Covariate>,
}

/// The slope over what differs beside what the study compares.
pub(super) struct Other {
    /// What it is of.
    pub of: Covariate,
    /// The number that is followed, or one of two names.
    pub upper: String,
    /// The other name; empty for a number.
    pub lower: String,
    /// The slope.
    pub slope: Slope,
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

/// Runs over what is followed.
pub(super) struct Over<'a> {
    of: Covariate,
    /// Mean, and half of the range: `x` in the unit of what is followed.
    pub mean: f64,
    pub half: f64,
    pub range: (f64, f64),
    /// What changed with it so that the design cannot tell them apart.
    pub tied: Vec<Covariate>,
    values: &'a [Value],
    /// Place of each value's sample among those that have one.
    sample: Vec<usize>,
    pub samples: usize,
    /// What is followed about its mean, in halves of its range.
    pub x: Vec<f64>,
    /// Columns that are taken out: levels, and what the design can carry beside.
    beside: Vec<Vec<f64>>,
    /// Surroundings and level of each value, and all that there are.
    part: Vec<(usize, usize)>,
    parts: Vec<(usize, usize)>,
}

impl Slope {
    /// None where nothing tells a slope.
    pub fn of(over: &Over) -> Option<Slope> {
        let (strips, differ) = if over.samples <= MOST_STRIPS {
            over.of_strips().unzip()
        } else {
            (None, None)
        };
        let material = over.of_material();
        (strips.is_some() || material.is_some()).then_some(Slope {
            strips,
            material,
            differ: differ.flatten(),
            range: over.range,
            numbers: over.x.iter().map(|x| over.mean + over.half * x).collect(),
            tied: over.tied.clone(),
        })
    }
}

impl<'a> Over<'a> {
    /// None where the number is the same in all runs, or where the levels leave nothing of it that is its own. `level`: what
    /// a value has a level of its own for.
    pub fn new(
        values: &'a [Value],
        followed: &Followed,
        facts: &[RunFacts],
        level: impl Fn(&Value) -> usize,
    ) -> Option<Over<'a>> {
        let numbers = &followed.numbers;
        let range = (
            numbers.iter().copied().reduce(f64::min)?,
            numbers.iter().copied().reduce(f64::max)?,
        );
        let half = 0.5 * (range.1 - range.0);
        if half <= 0.0 {
            return None;
        }
        let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
        // The runs of a strip at one humidity share how that was set.
        let begins = match followed.of {
            Covariate::RelativeHumidity => levels(numbers.iter().copied()),
            _ => Vec::new(),
        };
        let begin = |own: f64| begins.partition_point(|begin| *begin <= own);
        let part: Vec<(usize, usize)> = (values.iter().zip(numbers))
            .map(|(value, own)| (value.cell.0, begin(*own)))
            .collect();
        let names = distinct(values.iter().map(|value| value.sample));
        // What a strip has one of cannot be told from its level.
        let of_strips = distinct(
            values
                .iter()
                .zip(&part)
                .map(|(value, part)| (value.sample, *part)),
        );
        let has_parts = followed.of == Covariate::RelativeHumidity || of_strips.len() > names.len();
        let at = |value: &Value| names.binary_search(&value.sample).unwrap_or(0);
        let of_levels = distinct(values.iter().map(&level));
        let column = |own: &usize| -> Vec<f64> {
            let is = |value: &Value| f64::from(u8::from(level(value) == *own));
            values.iter().map(is).collect()
        };
        let mut over = Over {
            of: followed.of,
            mean,
            half,
            range,
            tied: Vec::new(),
            sample: values.iter().map(at).collect(),
            samples: names.len(),
            x: numbers.iter().map(|own| (own - mean) / half).collect(),
            beside: of_levels.iter().map(column).collect(),
            parts: if has_parts {
                distinct(part.iter().copied())
            } else {
                Vec::new()
            },
            part,
            values,
        };
        over.tied = over.carry(facts);
        Some(over)
    }

    /// Number of places at which it was measured.
    pub fn places(&self) -> usize {
        match self.of {
            Covariate::RelativeHumidity => distinct(self.part.iter().map(|part| part.1)).len(),
            _ => distinct(self.x.iter().map(|x| x.to_bits())).len(),
        }
    }

    /// By how much the levels inflate the variance of a slope, of the strips as they are or, where each strip has one number,
    /// of the material.
    pub fn inflation(&self) -> f64 {
        let square = |group: &[usize], beside: &[Vec<f64>]| -> f64 {
            let grouped = Grouped::new(&vec![1.0; self.values.len()], group, beside);
            grouped.residual(&self.x).iter().map(|x| x * x).sum()
        };
        let one = vec![0; self.values.len()];
        let whole = square(&one, &[]);
        let group = if square(&self.sample, &[]) > LEAST_ERROR * whole {
            &self.sample
        } else {
            &one
        };
        square(group, &[]) / square(group, &self.beside).max(LEAST_ERROR * whole)
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
        let is_use = Covariate::OF_AGE.contains(&self.of);
        let of_use = USE.into_iter().find_map(known).filter(|_| !is_use);
        let asked: Vec<(Covariate, Vec<f64>)> = [Covariate::RelativeHumidity, Covariate::Temperature]
            .into_iter()
            .filter(|other| *other != self.of)
            .filter_map(known)
            .chain(of_use)
            .collect();
        let square = |grouped: &Grouped| -> f64 { grouped.residual(&self.x).iter().map(|x| x * x).sum() };
        // What differs from one strip and level to the next is told from as many numbers as there are of these.
        let mut left = match self.of {
            Covariate::RelativeHumidity => {
                let cells = distinct(self.sample.iter().zip(&self.part)).len();
                cells.saturating_sub(self.samples + 1)
            }
            _ => (self.values.len()).saturating_sub(self.samples + self.beside.len() + 1),
        };
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

    /// A level for each strip, what is taken out beside, and these columns of all strips: the model and which of its columns
    /// they are.
    pub fn with_levels(&self, slopes: Vec<Vec<f64>>) -> Option<(Told, std::ops::Range<usize>)> {
        let samples: Vec<usize> = (0..self.samples).collect();
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
        let columns = before..self.samples + of.len();
        let told = self.told(row, vec![0; self.parts.len()], vec![0.0; columns.end])?;
        (!columns.is_empty()).then_some((told, columns))
    }

    /// The slope of the strips as they are.
    fn of_strips(&self) -> Option<(Told, Option<Differ>)> {
        let (mut one, columns) = self.with_levels(vec![self.x.clone()])?;
        one.factors[columns.start] = self.half.recip();
        let of_sample = |sample: usize| -> Vec<f64> {
            let own = self.x.iter().zip(&self.sample);
            own.map(|(x, of)| if *of == sample { *x } else { 0.0 }).collect()
        };
        let own = self.with_levels((0..self.samples).map(of_sample).collect());
        let own = own.filter(|(own, columns)| columns.len() > 1 && own.of.estimated().is_some());
        let Some((mut own, columns)) = own else {
            return Some((one, None));
        };
        let differ = own
            .of
            .estimated()
            .map(|of| differ(of, columns.clone(), self.half));
        if differ.is_none_or(|differ| differ.p > ONE_SLOPE) {
            return Some((one, differ));
        }
        let mean = own.of.estimated().map(|of| mean(of, columns, self.half));
        own.factors = mean.unwrap_or_default();
        Some((own, differ))
    }

    /// The slope of the material; none of one strip.
    fn of_material(&self) -> Option<Told> {
        let (mut told, columns) = self.by_chance(vec![self.x.clone()])?;
        told.factors[columns.start] = self.half.recip();
        Some(told)
    }

    /// The same with levels and slopes of the strips by chance; none of one strip.
    pub fn by_chance(&self, slopes: Vec<Vec<f64>>) -> Option<(Told, std::ops::Range<usize>)> {
        if self.samples < 2 {
            return None;
        }
        let (beside, slopes) = self.columns(&vec![0; self.values.len()], slopes);
        let before = beside.len() + 1;
        let of: Vec<Vec<f64>> = beside.into_iter().chain(slopes).collect();
        let row = |k: usize| Row {
            block: self.sample[k],
            fixed: std::iter::once(1.0).chain(of.iter().map(|own| own[k])).collect(),
            random: [vec![1.0, self.x[k]], one_of(&self.parts, &self.part[k])].concat(),
        };
        let components = [0, 1].into_iter().chain(self.parts.iter().map(|_| 2)).collect();
        let columns = before..of.len() + 1;
        let told = self.told(row, components, vec![0.0; columns.end])?;
        (!columns.is_empty()).then_some((told, columns))
    }

    fn told(&self, row: impl Fn(usize) -> Row, component_of: Vec<usize>, factors: Vec<f64>) -> Option<Told> {
        let model = model(self.values, (0..self.values.len()).map(&row), component_of);
        let of = Measured::of_columns(self.values.to_vec(), &model)?;
        let fitted = of.estimated().map_or_else(Vec::new, |estimated| {
            let own = |k: usize| dot(&row(k).fixed, &estimated.coefficients);
            (0..self.values.len()).map(own).collect()
        });
        Some(Told { of, factors, fitted })
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
