//! One question and its answer: does this parameter of this material follow these covariates, and by which law.

use super::chance_of::{Answer, Basis, ask};
use super::covariate::{Covariate, Kind};
use super::design::{Level, Rows};
use super::facts::RunFacts;
use super::fitted::{self, Fitted, Interval, Material};
use super::jump::{self, Jump};
use super::policy::{
    AS_GOOD, INFLATION_LIMIT, LEAST_RELIABILITY, LEFT_FOR_FACTORS, LEFT_FOR_OTHERS, LEFT_FOR_TIED, ONE_LEVEL,
    TIED_ABOVE,
};
use super::rivals::ToldApart;
use super::shape::{Bend, Law, Span, bends, progress};
use super::table::Table;
use super::values::Values;
use crate::false_discovery::CLAIMED_BELOW;
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_numerics::grouped::{Grouped, shared_variance};

/// A point of a figure: the parameter of one run (or the mean of one sample) brought to the mean sample and to the
/// means of what was taken out.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Point {
    /// Sample, as an index in [`Dependence::samples`].
    pub sample: usize,
    /// Covariate.
    pub x: f64,
    /// Its standard error, where one is known.
    pub x_error: Option<f64>,
    /// Parameter.
    pub value: f64,
    /// Lower end of its 95 % interval by the fit.
    pub low_95: f64,
    /// Upper end.
    pub high_95: f64,
    /// 1 after wetting, -1 after drying, 0 where neither is known.
    pub direction: i8,
}

/// The answer to one question.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Dependence {
    /// Material.
    pub material: String,
    /// Stored key of the parameter.
    pub parameter: String,
    /// The covariate that describes it best, of those that cannot be told apart.
    pub covariate: Covariate,
    /// Covariates that the design ties to it, less those that the readings rule out.
    pub confounded_with: Vec<Covariate>,
    /// What the readings say of covariates that the design ties to it.
    pub told_apart: ToldApart,
    /// Whether runs or samples are compared.
    pub level: Level,
    /// Probability of a tie at least as strong by chance.
    pub p: f64,
    /// The same over all questions of the campaign; 1 until all are asked.
    pub q: f64,
    /// What `p` rests on.
    pub basis: Basis,
    /// Number of runs.
    pub runs: usize,
    /// Indices of the runs whose values it is told from.
    pub used: Vec<usize>,
    /// Ids of the samples.
    pub samples: Vec<String>,
    /// Fitted runs that give a bound or nothing.
    pub left_out: usize,
    /// Whether changes are factors; differences otherwise.
    pub is_log: bool,
    /// What was taken out.
    pub adjusted_for: Vec<Covariate>,
    /// What is tied to it but could not be taken out, for want of runs.
    pub not_adjusted_for: Vec<Covariate>,
    /// Laws, the chosen one first; empty for names.
    pub laws: Vec<Fitted>,
    /// Criterion without a law.
    pub bic_of_none: f64,
    /// Left-out deviation without a law.
    pub rms_of_none: f64,
    /// Span of the covariate.
    pub span: Option<Span>,
    /// Largest difference between names.
    pub jump: Option<Jump>,
    /// Part of the covariate's variance that is no error of its measurement; none where no error is known.
    pub reliability: Option<f64>,
    /// Whether the size differs between samples by more than the errors.
    pub differs_between_samples: bool,
    /// Points for a figure.
    pub points: Vec<Point>,
    /// Value of the parameter that the law starts from, on its scale.
    pub start: f64,
}

impl Dependence {
    /// Logarithm of the ratio of the parameter between the ends of the span or the names; a difference on a plain
    /// scale.
    pub fn change(&self) -> Option<Interval> {
        let of_law = self.laws.first().map(|law| law.size);
        of_law.or(self.jump.as_ref().map(|jump| jump.size))
    }

    /// Whether it may be claimed: chance makes it seldom, and what was measured of the covariate is not mostly error.
    pub fn is_claimed(&self) -> bool {
        self.q <= CLAIMED_BELOW && !self.is_blurred()
    }

    /// Whether most of what was measured of the covariate is the error of its sensor.
    pub fn is_blurred(&self) -> bool {
        self.reliability.is_some_and(|part| part < LEAST_RELIABILITY)
    }

    /// The law that is claimed with its coefficient; none where nothing is claimed, or where it changes by no law that is
    /// known here.
    pub fn stated(&self) -> Option<(Law, Interval)> {
        let names = match self.covariate {
            Covariate::Sample => Law::Offset,
            _ => Law::Jump,
        };
        let of_law = self.laws.first().map(|own| (own.law, own.coefficient));
        let of_names = self.jump.as_ref().map(|jump| (names, jump.size));
        let known = self.covariate == Covariate::Sample || self.change().is_some_and(Interval::is_directed);
        of_law.or(of_names).filter(|_| known && self.is_claimed())
    }

    /// Laws that describe it as well as the chosen one.
    pub fn as_good(&self) -> Vec<Law> {
        let Some(best) = self.laws.iter().map(|law| law.bic).min_by(f64::total_cmp) else {
            return Vec::new();
        };
        self.laws
            .iter()
            .filter(|law| law.bic <= best + AS_GOOD)
            .map(|law| law.law)
            .collect()
    }

    /// Of a claim only covariates that the readings leave open stay confounded; of what is not claimed nothing is told.
    pub(super) fn keep_rivals(&mut self) {
        if self.q > CLAIMED_BELOW {
            self.told_apart = ToldApart::default();
        }
        let ruled_out = &self.told_apart.ruled_out;
        self.confounded_with
            .retain(|one| ruled_out.iter().all(|rival| rival.covariate != *one));
    }

    /// Every covariate that changed with it, whether the readings tell it apart or not.
    pub fn tied_to(&self) -> impl Iterator<Item = Covariate> {
        let ruled_out = self.told_apart.ruled_out.iter().map(|rival| rival.covariate);
        self.confounded_with.iter().copied().chain(ruled_out)
    }

    /// Value of the parameter that the chosen law gives at `x`, with the ends of the band about it.
    pub fn curve_at(&self, x: f64) -> Option<(f64, f64, f64)> {
        let (law, span) = (self.laws.first()?, self.span?);
        let at = |size: f64| {
            let own = |x: f64| fitted::value_at(law.law, size, x, span, law.bend, self.is_log);
            // The level is known best in the middle of the points: sizes turn about it.
            let mean = |size_of: f64| {
                let of =
                    |point: &Point| fitted::value_at(law.law, size_of, point.x, span, law.bend, self.is_log);
                self.points.iter().map(of).sum::<f64>() / self.points.len().max(1) as f64
            };
            let y = self.start + mean(law.size.value) - mean(size) + own(x);
            if self.is_log { y.exp() } else { y }
        };
        let ends = [
            at(law.size.low_95.unwrap_or(law.size.value)),
            at(law.size.high_95.unwrap_or(law.size.value)),
        ];
        Some((at(law.size.value), ends[0].min(ends[1]), ends[0].max(ends[1])))
    }
}

/// What a question is asked with.
pub struct Asking<'a> {
    /// Facts of all runs.
    pub facts: &'a [RunFacts],
    /// Material.
    pub material: &'a str,
    /// Values of the parameter.
    pub values: &'a Values,
    /// Rows at the level of the set.
    pub rows: &'a Rows,
    /// Rows within samples.
    pub within: &'a Rows,
    /// Seed of the draws.
    pub seed: u64,
}

impl Asking<'_> {
    /// Asks about the covariates of `set` together; none where too little is known.
    pub fn about(&self, set: &[Covariate]) -> Option<Dependence> {
        let table = Table::new(self.values, self.rows, self.within);
        let members: Vec<Covariate> = set
            .iter()
            .copied()
            .filter(|covariate| !covariate.is_factor())
            .collect();
        let first = *members.first()?;
        let (adjusted_for, not_adjusted_for) = self.adjusters(&table, set, first);
        let nuisance = table.columns_of(&adjusted_for);
        let shapes: Vec<(Covariate, Vec<Vec<f64>>)> = members
            .iter()
            .flat_map(|&covariate| self.shapes(&table, covariate))
            .collect();
        let shared = shared_variance(&table.y, &table.variance, &table.group, &nuisance);
        let variance: Vec<f64> = table.variance.iter().map(|v| floor(v + shared)).collect();
        let null = Grouped::new(&variance, &table.group, &nuisance);
        let alternatives: Vec<Grouped> = shapes
            .iter()
            .map(|(_, columns)| {
                let mut model = null.clone();
                model.take_out_all(columns);
                model
            })
            .collect();
        let answer = ask(&table.y, &null, &alternatives, &table.group, self.seed)?;
        let mut found = self.empty_of(&table, shapes[answer.best].0, answer);
        found.adjusted_for = adjusted_for;
        // A factor of the design that could not be taken out may be what the parameter follows.
        let (factors, others): (Vec<Covariate>, Vec<Covariate>) =
            not_adjusted_for.into_iter().partition(|one| one.is_factor());
        found.confounded_with.retain(|one| !factors.contains(one));
        found.confounded_with.extend(factors);
        // What the drive or the surroundings were set to is named before what use or order may do.
        found.confounded_with.sort_by_key(|one| !one.is_factor());
        found.not_adjusted_for = others;
        Some(found)
    }

    /// Adds laws, or the largest difference between names, to an answer of [`Asking::about`].
    pub fn describe(&self, found: &mut Dependence) {
        let table = Table::new(self.values, self.rows, self.within);
        let covariate = found.covariate;
        let nuisance = table.columns_of(&found.adjusted_for);
        let mut flexible = nuisance.clone();
        flexible.extend(
            self.shapes(&table, covariate)
                .into_iter()
                .flat_map(|(_, columns)| columns),
        );
        let shared = shared_variance(&table.y, &table.variance, &table.group, &flexible);
        let variance: Vec<f64> = table.variance.iter().map(|v| floor(v + shared)).collect();
        let null = Grouped::new(&variance, &table.group, &nuisance);
        match self.numbers(&table, covariate) {
            Some(x) => self.add_laws(found, &table, &x, &variance, &null),
            None => {
                found.jump = jump::largest(self.facts, &table, covariate, &variance, &nuisance);
            }
        }
        found.told_apart = self.told_apart(found, &table, &variance, &null);
    }

    /// Covariates to take out, and those that ought to be but leave too little.
    fn adjusters(
        &self,
        table: &Table,
        set: &[Covariate],
        first: Covariate,
    ) -> (Vec<Covariate>, Vec<Covariate>) {
        let own = table.columns.get(&first).map_or(1, Vec::len);
        let mut taken = Vec::new();
        let mut model = Grouped::new(&vec![1.0; table.y.len()], &table.group, &[]);
        let mut missed = Vec::new();
        let mut take = |covariate: Covariate, left: usize, is_needed: bool| {
            let mut more = model.clone();
            let columns = &table.columns[&covariate];
            more.take_out_all(columns);
            if more.freedom() >= left + own {
                taken.push(covariate);
                model = more;
            } else if is_needed {
                missed.push(covariate);
            }
        };
        let inflation = |other: Covariate| self.rows.inflation(first, &[other]);
        for factor in table.columns.keys().copied().filter(|one| one.is_factor()) {
            if inflation(factor) <= INFLATION_LIMIT {
                take(factor, LEFT_FOR_FACTORS, true);
            }
        }
        let mut others: Vec<(f64, Covariate)> = self
            .rows
            .sets
            .iter()
            .filter(|other| !other.contains(&first))
            .filter_map(|other| {
                other
                    .iter()
                    .copied()
                    .find(|one| !one.is_factor() && !set.contains(one))
            })
            .map(|other| (inflation(other), other))
            .collect();
        others.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (inflation, other) in others {
            if inflation > TIED_ABOVE {
                take(other, LEFT_FOR_TIED, true)
            } else {
                take(other, LEFT_FOR_OTHERS, false)
            }
        }
        (taken, missed)
    }

    /// Columns that stand for a covariate, one set for each form that a dependence may have.
    pub(super) fn shapes(&self, table: &Table, covariate: Covariate) -> Vec<(Covariate, Vec<Vec<f64>>)> {
        let Some(columns) = table.columns.get(&covariate) else {
            return Vec::new();
        };
        let mut shapes = vec![(covariate, columns.clone())];
        let Some(x) = self.numbers(table, covariate) else {
            return shapes;
        };
        let span = Span::of(&x);
        let levels = levels(&x, span);
        let mut form = |law: Law, bend: Bend| {
            let column = x.iter().map(|&x| progress(law, x, span, bend)).collect();
            shapes.push((covariate, vec![column]));
        };
        match covariate {
            Covariate::RelativeHumidity | Covariate::Temperature if levels.len() >= 4 => {
                form(Law::Threshold, Bend { at: 0.6, part: 0.0 });
            }
            Covariate::RestBefore => {
                shapes.clear();
                let tried = bends(Law::Decay, &levels, span);
                for bend in [tried[2], tried[7], tried[12]] {
                    let column = x.iter().map(|&x| progress(Law::Decay, x, span, bend)).collect();
                    shapes.push((covariate, vec![column]));
                }
            }
            covariate if Covariate::OF_AGE.contains(&covariate) && levels.len() >= 4 => {
                form(Law::SquareRoot, Bend { at: 0.0, part: 1.0 });
                form(Law::Threshold, Bend { at: 0.6, part: 0.0 });
            }
            _ => {}
        }
        shapes
    }

    /// Numbers of a covariate in its unit, those that are not stated at the mean; none for names.
    pub(super) fn numbers(&self, table: &Table, covariate: Covariate) -> Option<Vec<f64>> {
        if covariate.kind() == Kind::Category {
            return None;
        }
        let of_row = |members: &Vec<usize>| -> Option<f64> {
            let stated: Vec<f64> = members
                .iter()
                .filter_map(|&place| self.facts[place].numbers.get(&covariate).map(|known| known.value))
                .collect();
            (!stated.is_empty()).then(|| stated.iter().sum::<f64>() / stated.len() as f64)
        };
        let stated: Vec<Option<f64>> = table.members.iter().map(of_row).collect();
        let known: Vec<f64> = stated.iter().copied().flatten().collect();
        let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
        let numbers: Vec<f64> = stated.iter().map(|x| x.unwrap_or(mean)).collect();
        (Span::of(&numbers).length() > 0.0).then_some(numbers)
    }

    /// Root mean square of the errors of a covariate over the members of a row, by the number of members.
    pub(super) fn number_error(&self, members: &[usize], covariate: Covariate) -> Option<f64> {
        let errors: Vec<f64> = members
            .iter()
            .filter_map(|&place| self.facts[place].numbers.get(&covariate)?.standard_error)
            .collect();
        let square: f64 = errors.iter().map(|error| error * error).sum();
        (!errors.is_empty()).then(|| square.sqrt() / members.len() as f64)
    }

    /// The answer without laws.
    pub(super) fn empty_of(&self, table: &Table, covariate: Covariate, answer: Answer) -> Dependence {
        let confounded = self.rows.confounded.get(&covariate);
        let set = self.rows.set_of(covariate);
        let mut samples: Vec<String> = table
            .members
            .iter()
            .flatten()
            .map(|&place| self.facts[place].sample.clone())
            .collect();
        samples.sort();
        samples.dedup();
        let places = self.values.values.iter().map(|value| value.place);
        let used = places.filter(|place| table.members.iter().any(|row| row.contains(place)));
        Dependence {
            material: self.material.to_owned(),
            parameter: self.values.key.clone(),
            covariate,
            confounded_with: match confounded {
                Some(_) => set.iter().copied().filter(|other| *other != covariate).collect(),
                None => Vec::new(),
            },
            told_apart: ToldApart::default(),
            level: self.rows.level,
            p: answer.p,
            q: 1.0,
            basis: answer.basis,
            runs: self.values.values.len(),
            used: used.collect(),
            samples,
            left_out: self.values.left_out.len(),
            is_log: self.values.is_log,
            adjusted_for: Vec::new(),
            not_adjusted_for: Vec::new(),
            laws: Vec::new(),
            bic_of_none: f64::NAN,
            rms_of_none: f64::NAN,
            span: None,
            jump: None,
            reliability: None,
            differs_between_samples: false,
            points: Vec::new(),
            start: 0.0,
        }
    }

    fn add_laws(&self, found: &mut Dependence, table: &Table, x: &[f64], variance: &[f64], null: &Grouped) {
        let covariate = found.covariate;
        let span = Span::of(x);
        let errors: Vec<Option<f64>> = table
            .members
            .iter()
            .map(|members| self.number_error(members, covariate))
            .collect();
        found.reliability = reliability(x, &errors, table);
        let calibrated = calibrated(x, &table.group, found.reliability);
        let levels = levels(x, span);
        let material = Material {
            y: &table.y,
            variance,
            sample: &table.sample,
            nuisance: null,
            x: &calibrated,
            levels: &levels,
            span,
            is_log: self.values.is_log,
            readings: null.freedom() as f64,
        };
        found.laws = fitted::compare(&material, Law::of(covariate));
        found.bic_of_none = fitted::bic_of_none(&material);
        found.rms_of_none = fitted::rms_of_none(&material);
        found.span = Some(span);
        if let Some(law) = found.laws.first_mut()
            && self.rows.level == Level::Within
        {
            found.differs_between_samples = super::samples::widen(&material, law);
        }
        self.add_points(found, table, x, &errors, &material);
    }

    fn add_points(
        &self,
        found: &mut Dependence,
        table: &Table,
        x: &[f64],
        errors: &[Option<f64>],
        material: &Material,
    ) {
        let Some((law, span)) = found.laws.first().copied().zip(found.span) else {
            return;
        };
        let curve: Vec<f64> = material
            .x
            .iter()
            .map(|&x| fitted::value_at(law.law, law.size.value, x, span, law.bend, found.is_log))
            .collect();
        let rest: Vec<f64> = table.y.iter().zip(&curve).map(|(y, curve)| y - curve).collect();
        let left = material.nuisance.residual(&rest);
        found.start = rest.iter().sum::<f64>() / rest.len().max(1) as f64;
        let half_width = |row: usize| NORMAL_95_ROUNDED * table.variance[row].sqrt();
        for row in 0..table.y.len() {
            let y = found.start + curve[row] + left[row] * material.variance[row].sqrt();
            let on_scale = |y: f64| if found.is_log { y.exp() } else { y };
            let sample = &self.facts[table.members[row][0]].sample;
            let direction = self.facts[table.members[row][0]]
                .numbers
                .get(&Covariate::Direction);
            found.points.push(Point {
                sample: found.samples.binary_search(sample).unwrap_or(0),
                x: x[row],
                x_error: errors[row],
                value: on_scale(y),
                low_95: on_scale(y - half_width(row)),
                high_95: on_scale(y + half_width(row)),
                direction: direction.map_or(0, |known| (2.0 * known.value) as i8),
            });
        }
    }
}

/// A variance that can be divided by.
fn floor(variance: f64) -> f64 {
    variance.max(1e-18)
}

/// Distinct levels, rising: values closer than a small part of the span are one.
pub(super) fn levels(x: &[f64], span: Span) -> Vec<f64> {
    let mut sorted = x.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut levels: Vec<f64> = Vec::new();
    for x in sorted {
        if levels
            .last()
            .is_none_or(|last| x - last > ONE_LEVEL * span.length())
        {
            levels.push(x);
        }
    }
    levels
}

/// Part of the variance of `x` beside groups that is not the error of its measurement.
fn reliability(x: &[f64], errors: &[Option<f64>], table: &Table) -> Option<f64> {
    let known: Vec<f64> = errors.iter().copied().flatten().collect();
    if known.is_empty() {
        return None;
    }
    let plain = Grouped::new(&vec![1.0; x.len()], &table.group, &[]);
    let whole: f64 = plain.residual(x).iter().map(|x| x * x).sum::<f64>() / plain.freedom().max(1) as f64;
    let error = known.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64;
    Some((1.0 - error / whole.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0))
}

/// What is expected of the true value where the measured one is known (regression calibration): drawn towards the
/// group's mean, so that slopes are not flattened by the errors of the covariate.
fn calibrated(x: &[f64], group: &[usize], reliability: Option<f64>) -> Vec<f64> {
    let Some(reliability) = reliability.filter(|part| *part >= LEAST_RELIABILITY) else {
        return x.to_vec();
    };
    let means = super::design::group_means(x, group);
    x.iter()
        .zip(group)
        .map(|(x, &g)| means[g] + reliability * (x - means[g]))
        .collect()
}
