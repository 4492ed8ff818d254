//! The slope of one parameter of one material over the humidity, or over another number that differs from run to run: which
//! runs, what is taken out beside it, and what cannot be told from it. A number in two scopes becomes of it in `scoped`.

use ieap_numerics::grouped::Grouped;

use super::also::USE;
use super::measured::{Value, distinct};
use super::policy::LEAST_ERROR;
use super::scoped::{Columns, Scoped};
use crate::conditions::HUMIDITY_KNOWN_TO_PERCENT;
use crate::laws::Covariate;
use crate::laws::facts::RunFacts;
use crate::laws::policy::{INFLATION_LIMIT, LEFT_FOR_OTHERS, LEFT_FOR_TIED, TIED_ABOVE};

/// What is followed: a number of each value.
pub(super) struct Followed {
    /// What it is of.
    pub of: Covariate,
    /// Of each value, in the unit of the covariate.
    pub numbers: Vec<f64>,
}

/// A slope in both scopes.
pub(super) struct Slope {
    /// The number.
    pub scoped: Scoped,
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

/// The humidities that were set: each value that lies further from the last one set than both are known to.
pub(super) fn set_humidities(of: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = of.collect();
    all.sort_by(f64::total_cmp);
    let mut begins: Vec<f64> = Vec::new();
    for own in all {
        if begins
            .last()
            .is_none_or(|last| own - last > 2.0 * HUMIDITY_KNOWN_TO_PERCENT)
        {
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
    /// What is followed about its mean, in halves of its range, and what is taken out.
    pub columns: Columns<'a>,
}

impl Slope {
    /// None where nothing tells a slope.
    pub fn of(over: &Over) -> Option<Slope> {
        let numbers = over.columns.x.iter();
        Some(Slope {
            scoped: Scoped::of(&over.columns)?,
            range: over.range,
            numbers: numbers.map(|x| over.mean + over.half * x).collect(),
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
            Covariate::RelativeHumidity => set_humidities(numbers.iter().copied()),
            _ => Vec::new(),
        };
        let begin = |own: f64| begins.partition_point(|begin| *begin <= own);
        let part: Vec<(usize, usize)> = (values.iter().zip(numbers))
            .map(|(value, own)| (value.cell.0, begin(*own)))
            .collect();
        let of_levels = distinct(values.iter().map(&level));
        let column = |own: &usize| -> Vec<f64> {
            let is = |value: &Value| f64::from(u8::from(level(value) == *own));
            values.iter().map(is).collect()
        };
        let x = numbers.iter().map(|own| (own - mean) / half).collect();
        let beside = of_levels.iter().map(column).collect();
        let mut over = Over {
            of: followed.of,
            mean,
            half,
            range,
            tied: Vec::new(),
            columns: Columns::followed(values, (x, half), beside, part, !begins.is_empty()),
        };
        over.tied = over.carry(facts);
        Some(over)
    }

    /// Number of places at which it was measured.
    pub fn places(&self) -> usize {
        let of = &self.columns;
        match self.of {
            Covariate::RelativeHumidity => distinct(of.part.iter().map(|part| part.1)).len(),
            _ => distinct(of.x.iter().map(|x| x.to_bits())).len(),
        }
    }

    /// By how much the levels inflate the variance of a slope, of the strips as they are or, where each strip has one number,
    /// of the material.
    pub fn inflation(&self) -> f64 {
        let of = &self.columns;
        let square = |group: &[usize], beside: &[Vec<f64>]| -> f64 {
            let grouped = Grouped::new(&vec![1.0; of.x.len()], group, beside);
            grouped.residual(&of.x).iter().map(|x| x * x).sum()
        };
        let one = vec![0; of.x.len()];
        let whole = square(&one, &[]);
        let group = if square(&of.sample, &[]) > LEAST_ERROR * whole {
            &of.sample
        } else {
            &one
        };
        square(group, &[]) / square(group, &of.beside).max(LEAST_ERROR * whole)
    }
}

impl Over<'_> {
    /// Decides which further covariates are taken out beside the slope: those that the design tells from it and has the runs
    /// for. Gives those that it does not.
    fn carry(&mut self, facts: &[RunFacts]) -> Vec<Covariate> {
        let of = &self.columns;
        let known = |covariate: Covariate| -> Option<(Covariate, Vec<f64>)> {
            let number = |value: &Value| Some(facts[value.place].numbers.get(&covariate)?.value);
            Some((covariate, of.values.iter().map(number).collect::<Option<_>>()?))
        };
        let is_use = Covariate::OF_AGE.contains(&self.of);
        let of_use = USE.into_iter().find_map(known).filter(|_| !is_use);
        let asked: Vec<(Covariate, Vec<f64>)> = [Covariate::RelativeHumidity, Covariate::Temperature]
            .into_iter()
            .filter(|other| *other != self.of)
            .filter_map(known)
            .chain(of_use)
            .collect();
        let square = |grouped: &Grouped| -> f64 { grouped.residual(&of.x).iter().map(|x| x * x).sum() };
        // What differs from one strip and level to the next is told from as many numbers as there are of these.
        let mut left = match self.of {
            Covariate::RelativeHumidity => of.strips_in_parts().saturating_sub(of.samples + 1),
            _ => (of.values.len()).saturating_sub(of.samples + of.beside.len() + 1),
        };
        let mut grouped = Grouped::new(&vec![1.0; of.values.len()], &of.sample, &of.beside);
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
        self.columns.beside.extend(carried);
        tied
    }
}
