//! One number of a parameter in two scopes: of the strips that were measured and of their material.
//!
//! The number is the coefficient of a column: a slope over what is followed, or a contrast of conditions. In the strips as
//! they are each has a level of its own, and all have one number where theirs do not differ by more than runs do; else it is
//! the mean of theirs, each weighed as it is known. Of the material the strips are a sample: that theirs differ is part of the
//! error. In both, what the runs of a strip in one surroundings share is left to chance. Where surroundings are set against
//! each other that is not told from what the strip does in them: of the strips it is told what they did, as they were
//! measured, and only their spread tells of the material.

use std::collections::BTreeMap;
use std::rc::Rc;

use ieap_numerics::grouped::Grouped;
use ieap_numerics::mixed::{Estimated, Width};
use ieap_numerics::sums::dot;

use super::measured::{Measured, Row, Value, distinct, model, one_of};
use super::policy::{LEAST_ERROR, MOST_STRIPS, ONE_SLOPE};

/// A model with the combination of its columns that is the number.
pub(super) struct Told {
    /// The model.
    pub of: Rc<Measured>,
    /// The combination.
    pub factors: Vec<f64>,
    /// On which side of it each value stands: positive above, negative below.
    pub side: Vec<f64>,
    /// What the model makes of each value; empty where nothing tells the scatter.
    pub fitted: Vec<f64>,
}

/// A number in both scopes.
pub(super) struct Scoped {
    /// Of the strips as they are; none where no strip stands on both sides, and of more than [`MOST_STRIPS`], whose material
    /// tells as much.
    pub strips: Option<Told>,
    /// Of the material; none of one strip.
    pub material: Option<Told>,
    /// How the strips' own numbers differ; none of one strip, and where the runs do not tell it.
    pub differ: Option<Differ>,
    /// Whether it sets surroundings against each other: what a strip does in them is not told from what its runs there share by
    /// chance, so that of the strips it is what they did, and the answer is that of the material.
    pub is_of_surroundings: bool,
}

/// How the strips' own numbers differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Differ {
    /// Chance of it where all have one number.
    pub p: f64,
    /// Least number.
    pub least: f64,
    /// Largest number.
    pub largest: f64,
}

/// Values, the column whose coefficient is the number, and what is taken out beside it.
pub(super) struct Columns<'a> {
    pub values: &'a [Value],
    /// Place of each value's sample among those that have one.
    pub sample: Vec<usize>,
    pub samples: usize,
    /// The column.
    pub x: Vec<f64>,
    /// The number for a coefficient of one.
    each: f64,
    /// On which side of the number each value stands.
    pub side: Vec<f64>,
    /// Columns that are taken out: levels, and what the design can carry beside.
    pub beside: Vec<Vec<f64>>,
    /// What the runs of a strip share by chance, by value, and all that there are.
    pub part: Vec<(usize, usize)>,
    parts: Vec<(usize, usize)>,
    /// Whether it sets surroundings against each other.
    pub is_of_surroundings: bool,
}

impl Scoped {
    /// None where nothing tells the number.
    pub fn of(columns: &Columns) -> Option<Scoped> {
        let (strips, differ) = columns.of_strips(|| columns.of_one_number()).unzip();
        let material = columns.of_material();
        (strips.is_some() || material.is_some()).then_some(Scoped {
            strips,
            material,
            differ: differ.flatten(),
            is_of_surroundings: false,
        })
    }
}

impl<'a> Columns<'a> {
    /// `x`: what is followed, in halves of its range; `part`: what the runs of a strip share by chance, which counts where
    /// strips have several of these, or in any case.
    pub fn followed(
        values: &'a [Value],
        (x, half): (Vec<f64>, f64),
        beside: Vec<Vec<f64>>,
        part: Vec<(usize, usize)>,
        in_any_case: bool,
    ) -> Columns<'a> {
        let columns = Columns {
            each: half.recip(),
            side: vec![1.0; values.len()],
            ..Columns::new(values, x, beside, part)
        };
        columns.with_parts(in_any_case)
    }

    /// The column of a combination of conditions, beside all that conditions differ by and it is not; none where its factors
    /// do not add up to none, for levels of strips are no such number.
    pub fn of_conditions(of: &'a Measured, factors: &[f64], side: Vec<f64>) -> Option<Columns<'a>> {
        let square = dot(factors, factors);
        if factors.iter().sum::<f64>().abs() > LEAST_ERROR || square <= 0.0 {
            return None;
        }
        let mut of_surroundings: BTreeMap<usize, f64> = BTreeMap::new();
        for (cell, factor) in of.cells.iter().zip(factors) {
            *of_surroundings.entry(cell.0).or_default() += factor;
        }
        let is_within = of_surroundings.values().all(|sum| sum.abs() <= LEAST_ERROR);
        let values = &of.values[..];
        let beside = |(cell, factor): (&_, &f64)| -> Vec<f64> {
            let each = values.iter().zip(&side);
            each.map(|(value, own)| f64::from(u8::from(value.cell == *cell)) - factor * own / square)
                .collect()
        };
        let beside = of.cells.iter().zip(factors).map(beside).collect();
        let x = side.iter().map(|own| own / square).collect();
        let part = values.iter().map(|value| (value.cell.0, 0)).collect();
        let columns = Columns {
            side,
            is_of_surroundings: !is_within,
            ..Columns::new(values, x, beside, part)
        };
        Some(if is_within {
            columns.with_parts(false)
        } else {
            columns
        })
    }

    fn new(
        values: &'a [Value],
        x: Vec<f64>,
        beside: Vec<Vec<f64>>,
        part: Vec<(usize, usize)>,
    ) -> Columns<'a> {
        let names = distinct(values.iter().map(|value| value.sample));
        let at = |value: &Value| names.binary_search(&value.sample).unwrap_or(0);
        Columns {
            sample: values.iter().map(at).collect(),
            samples: names.len(),
            x,
            each: 1.0,
            side: Vec::new(),
            beside,
            part,
            parts: Vec::new(),
            is_of_surroundings: false,
            values,
        }
    }

    fn with_parts(self, in_any_case: bool) -> Columns<'a> {
        let has_parts = in_any_case || self.strips_in_parts() > self.samples;
        let parts = has_parts.then(|| distinct(self.part.iter().copied()));
        Columns {
            parts: parts.unwrap_or_default(),
            ..self
        }
    }

    /// Whether what the runs of a strip share is left to chance.
    pub fn has_parts(&self) -> bool {
        !self.parts.is_empty()
    }

    /// Strips in what their runs share.
    pub fn strips_in_parts(&self) -> usize {
        distinct(self.sample.iter().zip(&self.part)).len()
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
        let columns = before..self.samples + of.len();
        let levels = |k: usize| one_of(&samples, &self.sample[k]);
        let fixed = |k: usize| [levels(k), of.iter().map(|own| own[k]).collect()].concat();
        let model = self.with_fixed(fixed)?;
        let told = self.told(model, fixed, vec![0.0; columns.end]);
        (!columns.is_empty()).then_some((told, columns))
    }

    /// The model of the strips as they are with these fixed columns, by value.
    pub fn with_fixed(&self, fixed: impl Fn(usize) -> Vec<f64>) -> Option<Measured> {
        let row = |k: usize| Row {
            block: self.sample[k],
            fixed: fixed(k),
            random: one_of(&self.parts, &self.part[k]),
        };
        self.model(row, &self.chance(&[]))
    }

    /// The number where all strips have one.
    pub fn of_one_number(&self) -> Option<Told> {
        let (mut one, columns) = self.with_levels(vec![self.x.clone()])?;
        one.factors[columns.start] = self.each;
        Some(one)
    }

    /// Whether the number is told beside a level for each strip.
    pub fn is_told_beside_levels(&self) -> bool {
        !self.columns(&self.sample, vec![self.x.clone()]).1.is_empty()
    }

    /// The number of the strips as they are; `one`: where all of them have one.
    pub fn of_strips(&self, one: impl FnOnce() -> Option<Told>) -> Option<(Told, Option<Differ>)> {
        if self.samples > MOST_STRIPS {
            return None;
        }
        let one = one()?;
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
            .map(|of| differ(of, columns.clone(), self.each));
        if differ.is_none_or(|differ| differ.p > ONE_SLOPE) {
            return Some((one, differ));
        }
        let mean = own.of.estimated().map(|of| mean(of, columns, self.each));
        own.factors = mean.unwrap_or_default();
        Some((own, differ))
    }

    /// The number of the material; none of one strip.
    pub fn of_material(&self) -> Option<Told> {
        let (mut told, columns) = self.by_chance(vec![self.x.clone()])?;
        told.factors[columns.start] = self.each;
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
        let fixed =
            |k: usize| -> Vec<f64> { std::iter::once(1.0).chain(of.iter().map(|own| own[k])).collect() };
        let row = |k: usize| Row {
            block: self.sample[k],
            fixed: fixed(k),
            random: [vec![1.0, self.x[k]], one_of(&self.parts, &self.part[k])].concat(),
        };
        // Strips are not alike because their runs repeat; neither are their slopes.
        let chance = self.chance(&[(1, Width::All), (1, Width::Readings)]);
        let columns = before..of.len() + 1;
        let told = self.told(self.model(row, &chance)?, fixed, vec![0.0; columns.end]);
        (!columns.is_empty()).then_some((told, columns))
    }

    /// Columns of chance: these, then what the runs of a strip share.
    fn chance(&self, of_strips: &[(usize, Width)]) -> Vec<(usize, Width)> {
        let parts = self.has_parts().then_some((self.parts.len(), Width::Readings));
        of_strips.iter().copied().chain(parts).collect()
    }

    fn model(&self, row: impl Fn(usize) -> Row, chance: &[(usize, Width)]) -> Option<Measured> {
        let model = model(self.values, (0..self.values.len()).map(row), chance);
        Measured::of_columns(self.values.to_vec(), &model)
    }

    /// With what it makes of each value by these fixed columns.
    fn told(&self, of: Measured, fixed: impl Fn(usize) -> Vec<f64>, factors: Vec<f64>) -> Told {
        let fitted = of.estimated().map_or_else(Vec::new, |estimated| {
            let own = |k: usize| dot(&fixed(k), &estimated.coefficients);
            (0..self.values.len()).map(own).collect()
        });
        Told {
            of: Rc::new(of),
            factors,
            side: self.side.clone(),
            fitted,
        }
    }
}

/// How numbers, so many times the coefficients at `columns`, differ.
fn differ(of: &Estimated, columns: std::ops::Range<usize>, each: f64) -> Differ {
    let numbers = || columns.clone().map(|k| each * of.coefficients[k]);
    let against_first = |k: usize| {
        let mut factors = vec![0.0; of.coefficients.len()];
        (factors[columns.start], factors[k]) = (1.0, -1.0);
        factors
    };
    let contrasts: Vec<Vec<f64>> = columns.clone().skip(1).map(against_first).collect();
    Differ {
        p: of.joint_chance(&contrasts),
        least: numbers().fold(f64::INFINITY, f64::min),
        largest: numbers().fold(f64::NEG_INFINITY, f64::max),
    }
}

/// The combination that is the mean of numbers, each weighed as it is known.
fn mean(of: &Estimated, columns: std::ops::Range<usize>, each: f64) -> Vec<f64> {
    let keep: Vec<usize> = columns.clone().collect();
    let weights = of.covariance.part(&keep).solve(&vec![1.0; keep.len()], 1e-12);
    let sum: f64 = weights.iter().sum();
    let mut factors = vec![0.0; of.coefficients.len()];
    columns
        .zip(weights)
        .for_each(|(k, weight)| factors[k] = each * weight / sum);
    factors
}
