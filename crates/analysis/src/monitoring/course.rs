//! The course of a series between its jumps: a trend, a step to another level, both, or neither.
//!
//! One question asks whether anything happens at all. Then laws are compared, a step among them, and where a step is
//! shown beside every smooth trend also each trend with it, by one criterion in which the search for the place is paid.

use super::policy::{FEWEST_FOR_STEP, MOST_PLACES, SHOWN_BELOW};
use super::series::{Change, Series, Study};
use crate::monitoring::chance_of::{Answer, ask};
use crate::monitoring::fitted::{self, Fitted, Interval, Material};
use crate::monitoring::policy::{AS_GOOD, STEP_PAID, STEP_SIDE};
use crate::monitoring::shape::{Bend, Law, progress};
use ieap_numerics::correlation::Autoregression;
use ieap_numerics::grouped::{Grouped, shared_variance};
use ieap_numerics::student::quantile_95;
use ieap_numerics::sums::dot;

/// Laws of a trend, the plainest first.
const TRENDS: [Law; 5] = [
    Law::Linear,
    Law::SquareRoot,
    Law::Exponential,
    Law::Approach,
    Law::Knee,
];

/// The same, and a step.
const COURSES: [Law; 6] = [
    Law::Linear,
    Law::SquareRoot,
    Law::Exponential,
    Law::Approach,
    Law::Step,
    Law::Knee,
];

/// What scatters about a flexible course.
pub(super) struct Scatter {
    /// Variance of each reading, as large as makes the readings count as independent ones.
    pub(super) variance: Vec<f64>,
    /// How it goes on from one reading to the next.
    correlation: f64,
    /// Readings that tell as much as one independent one.
    pub(super) per_independent: f64,
    /// Places at which laws may bend.
    levels: Vec<f64>,
}

/// What is new in each reading, where scatter goes on from one to the next: readings and columns less what the one before
/// foretells (Cochrane and Orcutt 1949). What scatters so can be exchanged, and a level stays a level.
struct Innovations {
    correlation: f64,
    variance: Vec<f64>,
    segment: Vec<usize>,
    /// Readings that have one before them in their segment; all where nothing goes on.
    kept: Vec<usize>,
}

impl Innovations {
    fn of(variance: &[f64], segment: &[usize], correlation: f64) -> Innovations {
        let correlation = correlation.max(0.0);
        let follows = |&k: &usize| correlation == 0.0 || (k > 0 && segment[k] == segment[k - 1]);
        let kept: Vec<usize> = (0..segment.len()).filter(follows).collect();
        let mut numbers: Vec<usize> = kept.iter().map(|&k| segment[k]).collect();
        numbers.dedup();
        let number = |k: usize| numbers.iter().position(|&own| own == segment[k]).unwrap_or(0);
        Innovations {
            correlation,
            variance: kept.iter().map(|&k| variance[k]).collect(),
            segment: kept.iter().map(|&k| number(k)).collect(),
            kept,
        }
    }

    fn column(&self, column: &[f64]) -> Vec<f64> {
        let before = |k: usize| {
            if self.correlation > 0.0 {
                self.correlation * column[k - 1]
            } else {
                0.0
            }
        };
        self.kept.iter().map(|&k| column[k] - before(k)).collect()
    }

    fn model(&self, columns: &[Vec<f64>]) -> Grouped {
        let columns: Vec<Vec<f64>> = columns.iter().map(|column| self.column(column)).collect();
        Grouped::new(&self.variance, &self.segment, &columns)
    }

    fn with_each(&self, base: &[Vec<f64>], columns: &[Vec<f64>]) -> (Grouped, Vec<Grouped>) {
        let null = self.model(base);
        let with = |column: &Vec<f64>| {
            let mut model = null.clone();
            model.take_out(&self.column(column));
            model
        };
        let models = columns.iter().map(with).collect();
        (null, models)
    }

    /// How often chance does as well as the best of `columns`, each beside `base`.
    fn ask(&self, y: &[f64], base: &[Vec<f64>], columns: &[Vec<f64>], seed: u64) -> Option<Answer> {
        let (null, alternatives) = self.with_each(base, columns);
        ask(&self.column(y), &null, &alternatives, &self.segment, seed)
    }

    /// Sums of squares that each of `columns` leaves beside `base`.
    fn squares(&self, y: &[f64], base: &[Vec<f64>], columns: &[Vec<f64>]) -> Vec<f64> {
        let (null, alternatives) = self.with_each(base, columns);
        let left = null.residual(&self.column(y));
        let mut room = Vec::new();
        let square = |model: &Grouped| model.square_left(&left, &mut room);
        alternatives.iter().map(square).collect()
    }
}

/// A step that is shown beside every smooth trend.
struct Beside {
    column: Vec<f64>,
    at: Interval,
    p: f64,
}

impl Series {
    /// Adds what happens over the axis, beside the jumps between segments.
    pub(super) fn add_course(&self, study: &mut Study, segment: &[usize], seed: u64) {
        let mut shapes: Vec<Vec<f64>> = [
            (Law::Exponential, 0.0, 1.0),
            (Law::SquareRoot, 0.0, 1.0),
            (Law::Knee, 0.6, 0.0),
        ]
        .into_iter()
        .map(|(law, at, part)| {
            let along = |&x: &f64| progress(law, x, study.span, Bend { at, part });
            self.x.iter().map(along).collect()
        })
        .collect();
        let places = self.places();
        let mut scatter = self.scatter(segment, &shapes, 0);
        // A step that is there makes neighbours alike: how the scatter goes on is told beside the likeliest one.
        if let Some(step) = self.likeliest(segment, &shapes, &scatter, &places) {
            let beside: Vec<Vec<f64>> = shapes.iter().cloned().chain([step]).collect();
            scatter.correlation = self.scatter(segment, &beside, STEP_PAID - 1).correlation;
        }
        study.p_trend = self.chance_of_any(segment, &shapes, &places, scatter.correlation, seed);
        let beside = study
            .is_shown()
            .then(|| self.beside(segment, &shapes, &scatter, &places, seed))
            .flatten();
        if let Some(beside) = &beside {
            // What the step was is no scatter.
            shapes.push(beside.column.clone());
            scatter = self.scatter(segment, &shapes, STEP_PAID - 1);
        }
        let nuisance = Grouped::new(&scatter.variance, segment, &[]);
        let material = self.material(study, &scatter, &nuisance);
        study.trends = fitted::compare(&material, &COURSES);
        if let Some(beside) = beside {
            self.add_both(study, &material, segment, beside);
        }
        study.start = self.start(study, segment);
    }

    /// First readings after each place at which a step is looked for.
    fn places(&self) -> Vec<usize> {
        let n = self.x.len();
        if n < FEWEST_FOR_STEP {
            return Vec::new();
        }
        let every = n.div_ceil(MOST_PLACES);
        (STEP_SIDE..=n - STEP_SIDE)
            .step_by(every)
            .filter(|&at| self.x[at] > self.x[at - 1])
            .collect()
    }

    pub(super) fn column(&self, at: usize) -> Vec<f64> {
        (0..self.x.len()).map(|k| f64::from(k >= at)).collect()
    }

    /// How often chance alone brings a trend or a step as clear as the clearest.
    fn chance_of_any(
        &self,
        segment: &[usize],
        shapes: &[Vec<f64>],
        places: &[usize],
        correlation: f64,
        seed: u64,
    ) -> Option<f64> {
        let variance = self.with(shared_variance(&self.y, &self.variance, segment, &[]));
        let steps = places.iter().map(|&at| self.column(at));
        let columns: Vec<Vec<f64>> = shapes.iter().cloned().chain(steps).collect();
        let innovations = Innovations::of(&variance, segment, correlation);
        Some(innovations.ask(&self.y, &[], &columns, seed)?.p)
    }

    /// What scatters about a course of the `flexible` columns, for which a search of places is paid with `searched`
    /// parameters more; without memory where there are too few readings to tell.
    pub(super) fn scatter(&self, segment: &[usize], flexible: &[Vec<f64>], searched: usize) -> Scatter {
        let n = self.y.len();
        let variance = self.with(shared_variance(&self.y, &self.variance, segment, flexible));
        let mut scatter = Scatter {
            variance,
            correlation: 0.0,
            per_independent: 1.0,
            levels: levels(&self.x),
        };
        if n < FEWEST_FOR_STEP {
            return scatter;
        }
        let model = Grouped::new(&scatter.variance, segment, flexible);
        let left = model.residual(&self.y);
        let goes_on = (1..n).filter(|&k| segment[k] == segment[k - 1]);
        let product: f64 = goes_on.map(|k| left[k] * left[k - 1]).sum();
        let terms = (n - model.freedom() + searched) as f64;
        let own = Autoregression::from_sums(dot(&left, &left), product, n as f64, terms);
        scatter.correlation = own.correlation;
        scatter.per_independent = n as f64 / own.effective_readings(n as f64);
        let inflation = scatter.per_independent;
        scatter.variance.iter_mut().for_each(|v| *v *= inflation);
        scatter
    }

    /// What laws are fitted to, with `nuisance` taken out.
    fn material<'a>(&'a self, study: &Study, scatter: &'a Scatter, nuisance: &'a Grouped) -> Material<'a> {
        Material {
            y: &self.y,
            variance: &scatter.variance,
            nuisance,
            x: &self.x,
            levels: &scatter.levels,
            span: study.span,
            is_log: self.is_log,
            readings: nuisance.freedom() as f64 / scatter.per_independent,
        }
    }

    fn with(&self, shared: f64) -> Vec<f64> {
        self.variance.iter().map(|v| (v + shared).max(1e-18)).collect()
    }

    /// The step that leaves the least beside a flexible trend, whatever the scatter is like.
    fn likeliest(
        &self,
        segment: &[usize],
        shapes: &[Vec<f64>],
        scatter: &Scatter,
        places: &[usize],
    ) -> Option<Vec<f64>> {
        let columns: Vec<Vec<f64>> = places.iter().map(|&at| self.column(at)).collect();
        let squares = Innovations::of(&scatter.variance, segment, 0.0).squares(&self.y, shapes, &columns);
        let best = (0..columns.len()).min_by(|&a, &b| squares[a].total_cmp(&squares[b]))?;
        columns.into_iter().nth(best)
    }

    /// The best place of a step beside a flexible trend, where chance does not bring it.
    fn beside(
        &self,
        segment: &[usize],
        shapes: &[Vec<f64>],
        scatter: &Scatter,
        places: &[usize],
        seed: u64,
    ) -> Option<Beside> {
        let columns: Vec<Vec<f64>> = places.iter().map(|&at| self.column(at)).collect();
        let innovations = Innovations::of(&scatter.variance, segment, scatter.correlation);
        let answer = innovations.ask(&self.y, shapes, &columns, seed.wrapping_add(1))?;
        let p = answer.p;
        if p > SHOWN_BELOW {
            return None;
        }
        let squares = innovations.squares(&self.y, shapes, &columns);
        let best = (0..places.len()).min_by(|&a, &b| squares[a].total_cmp(&squares[b]))?;
        let freedom = answer.freedom as f64;
        let allowed = squares[best] * (1.0 + quantile_95(freedom).powi(2) / freedom);
        let held: Vec<usize> = (0..places.len()).filter(|&k| squares[k] <= allowed).collect();
        let between = |at: usize| 0.5 * (self.x[at - 1] + self.x[at]);
        // What lies between places that were tried is held too.
        let end = |k: Option<usize>| k.and_then(|k| places.get(k)).map(|&at| between(at));
        let last = held.last().copied().unwrap_or(best);
        Some(Beside {
            column: self.column(places[best]),
            at: Interval {
                value: between(places[best]),
                low_95: end(held.first().copied().unwrap_or(best).checked_sub(1)),
                high_95: end(Some(last + 1)),
            },
            p,
        })
    }

    /// Takes a trend with the step beside it where that is better than either alone.
    fn add_both(&self, study: &mut Study, material: &Material, segment: &[usize], beside: Beside) {
        let nuisance = Grouped::new(material.variance, segment, std::slice::from_ref(&beside.column));
        let with_step = Material {
            nuisance: &nuisance,
            ..material.clone()
        };
        let mut both = fitted::compare(&with_step, &TRENDS);
        let paid = STEP_PAID as f64 * material.readings.max(1.0).ln();
        both.iter_mut().for_each(|law| law.bic += paid);
        if best(&both) >= best(&study.trends) - AS_GOOD {
            return;
        }
        let law = both[0];
        let rest: Vec<f64> = (0..self.y.len())
            .map(|k| self.y[k] - self.law_at(&law, law.size.value, self.x[k], study))
            .collect();
        let (own, left) = (
            material.nuisance.residual(&beside.column),
            material.nuisance.residual(&rest),
        );
        study.change = Some(Change {
            at: beside.at,
            size: dot(&own, &left) / dot(&own, &own),
            error: dot(&own, &own).sqrt().recip(),
            p: beside.p,
        });
        study.trends = both;
    }

    fn law_at(&self, law: &Fitted, size: f64, x: f64, study: &Study) -> f64 {
        fitted::value_at(law.law, size, x, study.span, law.bend, self.is_log)
    }

    /// The course over the axis in the last segment, on the series' scale, by a law of that size.
    pub fn course<'a>(&'a self, study: &'a Study, law: &'a Fitted, size: f64) -> impl Fn(f64) -> f64 + 'a {
        // The level is known best in the middle of the readings: sizes turn about it.
        let mean = |size: f64| {
            let all = self.x.iter().map(|&x| self.law_at(law, size, x, study));
            all.sum::<f64>() / self.x.len() as f64
        };
        let level = study.start + mean(law.size.value) - mean(size);
        move |x| level + self.law_at(law, size, x, study) + step_at(study, x)
    }

    /// Level at the start of the axis, by the readings of the last segment.
    fn start(&self, study: &Study, segment: &[usize]) -> f64 {
        let Some(law) = study.trends.first() else {
            return 0.0;
        };
        let last = segment.last().copied().unwrap_or(0);
        let own: Vec<f64> = (0..self.y.len())
            .filter(|&k| segment[k] == last)
            .map(|k| {
                let x = self.x[k];
                self.y[k] - self.law_at(law, law.size.value, x, study) - step_at(study, x)
            })
            .collect();
        own.iter().sum::<f64>() / own.len().max(1) as f64
    }
}

/// What the step beside the trend adds at `x`.
fn step_at(study: &Study, x: f64) -> f64 {
    let after = study.change.as_ref().filter(|change| x >= change.at.value);
    after.map_or(0.0, |change| change.size)
}

fn best(laws: &[Fitted]) -> f64 {
    laws.iter().map(|law| law.bic).fold(f64::INFINITY, f64::min)
}

fn levels(x: &[f64]) -> Vec<f64> {
    let every = x.len().div_ceil(MOST_PLACES);
    let mut levels: Vec<f64> = x.iter().copied().step_by(every).collect();
    levels.dedup();
    levels
}
