//! A model fitted to a group: where its minimum lies and what it leaves.

use ieap_domain::{Estimate, Parameter};
use ieap_model::LumpedModel;
use ieap_numerics::least_squares::{Local, Minimum, Stop};
use ieap_numerics::student::quantile_95;

use crate::fitting::policy::WIDEST_HALF_LOG;
use crate::fitting::problem::{ExtendedProblem, FreeEffect};
use crate::fitting::tangent::Tangent;
use crate::readings::group::RunGroup;
use ieap_model::effects::Limits;

/// A fall of the sum of squares by less than this ends a search ...
const SETTLE: f64 = 1e-2;
/// ... and so does one by less than this part of what is beyond the noise.
const SETTLE_PART: f64 = 1e-4;
/// Evaluations of a search from a start that is near.
pub(crate) const SHORT: u64 = 10;
/// Evaluations of a search that must arrive.
pub(crate) const LONG: u64 = 30;

/// Evaluations along slopes that are held, and of slopes anew, with what ends such a search as above.
pub(crate) const HELD: u64 = 14;
const ANEW: u64 = 4;
const HELD_SETTLE: f64 = 0.05;
const HELD_SETTLE_PART: f64 = 1e-3;

/// Searches after which a minimum counts as reached.
const SEARCHES: usize = 10;

/// A model at its minimum.
#[derive(Clone)]
pub(crate) struct Fitted<'g> {
    pub(crate) problem: ExtendedProblem<'g>,
    pub(crate) at: Vec<f64>,
    pub(crate) square: f64,
    /// Evaluations of all searches that led here.
    pub(crate) evaluations: u64,
    /// How the last of them ended.
    pub(crate) stop: Stop,
}

impl<'g> Fitted<'g> {
    /// The lowest place from several starts, each followed shortly; columns of the Jacobian that are `known` are held.
    pub(crate) fn search(
        problem: ExtendedProblem<'g>,
        starts: &[Vec<f64>],
        known: &[Vec<f64>],
    ) -> Option<Fitted<'g>> {
        let settle = settle(&problem, problem.square(starts.first()?));
        let mut evaluations = 0;
        let short = starts
            .iter()
            .map(|start| problem.search(start, SHORT, settle, known));
        let best = Minimum::lowest(short.inspect(|bottom| evaluations += bottom.evaluations))?;
        Some(Fitted::at_bottom(problem, best, evaluations))
    }

    /// Where a search ended.
    fn at_bottom(problem: ExtendedProblem<'g>, bottom: Minimum, evaluations: u64) -> Fitted<'g> {
        Fitted {
            square: bottom.local.square - problem.penalty(&bottom.at),
            at: bottom.at,
            evaluations,
            stop: bottom.stop,
            problem,
        }
    }

    /// The sum of squares with what is known before any reading.
    pub(crate) fn penalised(&self) -> f64 {
        self.square + self.problem.penalty(&self.at)
    }

    /// A place of which nothing was searched yet; none where the model has no finite residuals there.
    pub(crate) fn unsearched(problem: ExtendedProblem<'g>, at: Vec<f64>) -> Option<Fitted<'g>> {
        let square = problem.square(&at);
        square.is_finite().then_some(Fitted {
            problem,
            at,
            square,
            evaluations: 1,
            stop: Stop::EvaluationLimit,
        })
    }

    /// Goes on to the end.
    pub(crate) fn polished(self) -> Fitted<'g> {
        let settle = settle(&self.problem, self.square);
        let bottom = self.problem.search(&self.at, LONG, settle, &[]);
        let evaluations = self.evaluations + bottom.evaluations;
        Fitted::at_bottom(self.problem, bottom, evaluations)
    }

    /// From a place with the slopes about it: along these, then along slopes taken anew.
    pub(crate) fn along(
        problem: ExtendedProblem<'g>,
        start: &[f64],
        columns: &[Vec<f64>],
    ) -> Option<Fitted<'g>> {
        let settle =
            HELD_SETTLE + HELD_SETTLE_PART * (problem.square(start) - problem.group.rows() as f64).max(0.0);
        let held = problem.search(start, HELD, settle, columns);
        let mut anew = problem.search(&held.at, ANEW, settle, &[]);
        // Where the slopes at the start led nowhere they are no guide: all anew.
        let before = problem.square(start) + problem.penalty(start);
        if before - anew.local.square <= settle {
            anew = problem.search(start, LONG, settle, &[]);
        }
        let evaluations = held.evaluations + anew.evaluations;
        let found = Fitted::at_bottom(problem, anew, evaluations);
        found.square.is_finite().then_some(found)
    }

    /// Goes on to the end, however many steps a curved valley takes.
    pub(crate) fn converged(self) -> Fitted<'g> {
        let mut best = self.polished();
        for _ in 1..SEARCHES {
            if best.stop != Stop::EvaluationLimit {
                break;
            }
            best = best.polished();
        }
        best
    }

    /// Goes on until a whole search no longer lowers the sum of squares noticeably.
    pub(crate) fn exhausted(self) -> Fitted<'g> {
        let mut best = self.polished();
        for _ in 0..SEARCHES {
            let before = best.square;
            best = best.polished();
            if before - best.square <= SETTLE.max(SETTLE_PART * before) {
                best.stop = Stop::Converged;
                return best;
            }
        }
        best.stop = Stop::EvaluationLimit;
        best
    }

    /// Whitened residuals.
    pub(crate) fn residuals(&self) -> Vec<f64> {
        let mut out = Vec::new();
        self.problem.residuals(&self.at, &mut out);
        out
    }

    /// Sum of squares with its slope, and what a refit of all parameters absorbs.
    pub(crate) fn tangent(&self) -> (Local, Tangent) {
        let (slope, jacobian) = self.problem.slope(&self.at);
        (slope, Tangent::of(&jacobian))
    }

    /// The base model in it.
    pub(crate) fn base(&self) -> LumpedModel {
        self.problem.model(&self.at).base
    }

    /// Parameters of the effects, effect by effect.
    pub(crate) fn effect_values(&self) -> Vec<Vec<f64>> {
        self.problem
            .model(&self.at)
            .effects
            .into_iter()
            .map(|applied| applied.parameters)
            .collect()
    }

    /// Number of searched parameters beyond the base.
    pub(crate) fn extra(&self) -> usize {
        self.problem.effects.iter().map(FreeEffect::free).sum()
    }

    /// Parameters of every effect with their uncertainty: from the covariance, with the noise's own allowed for.
    pub(crate) fn effect_parameters(&self, group: &RunGroup) -> Vec<Vec<Parameter>> {
        self.effect_parameters_widened(group, 1.0)
    }

    /// The same with all standard errors `wider`.
    pub(crate) fn effect_parameters_widened(&self, group: &RunGroup, wider: f64) -> Vec<Vec<Parameter>> {
        let (slope, _) = self.problem.slope(&self.at);
        let inverse = slope.normal.inverse(1e-12);
        let quantile = quantile_95(freedom(group));
        let mut first = self.problem.base_len();
        let values = self.effect_values();
        let of_effect = |(free_effect, values): (&FreeEffect, &Vec<f64>)| {
            let described = free_effect.effect.about().parameters;
            let mut parameters = Vec::new();
            for (k, (&value, described)) in values.iter().zip(described).enumerate() {
                let limits = free_effect.limits[k];
                let estimate = if limits.held {
                    Estimate {
                        value: Some(value),
                        ..Estimate::not_determined("held: no free parameter")
                    }
                } else {
                    let place = first;
                    first += 1;
                    let sd = wider * inverse.error(place);
                    Estimate {
                        at_bound: self.problem.at_limit(place, self.at[place]),
                        ..estimate(value, sd, quantile, free_effect.slope(k, value), limits)
                    }
                };
                parameters.push(Parameter {
                    key: described.key.to_owned(),
                    estimate,
                });
            }
            parameters
        };
        self.problem.effects.iter().zip(&values).map(of_effect).collect()
    }

    /// Branches in the order of their time constants, as keys count them.
    pub(crate) fn branch_order(&self) -> Vec<usize> {
        let base = self.base();
        let mut order: Vec<usize> = (0..base.branches.len()).collect();
        order.sort_by(|&a, &b| {
            base.branches[a]
                .time_constant_s()
                .total_cmp(&base.branches[b].time_constant_s())
        });
        order
    }

    /// Stored key of the base parameter whose coordinate is `k`.
    pub(crate) fn base_key(&self, k: usize) -> String {
        let order = self.branch_order();
        let n = order.len();
        let number = |branch: usize| 1 + order.iter().position(|own| *own == branch).unwrap_or(0);
        match k {
            k if k < n => format!("r{}_ohm_cm2", number(k)),
            k if k < 2 * n => format!("c{}_f_per_cm2", number(k - n)),
            k if k == 2 * n => "rss_ohm_cm2".to_owned(),
            k if k == 2 * n + 1 => "alpha_per_c_cm".to_owned(),
            _ => "lambda_per_s".to_owned(),
        }
    }

    /// Value and standard error of the base parameter whose coordinate `k` is at `at`, known to `sd`; none of an endless one.
    pub(crate) fn base_value(&self, k: usize, at: f64, sd: f64) -> Option<(f64, f64)> {
        let n = self.base().branches.len();
        let units = self.problem.units();
        let found = match k {
            k if k < 2 * n => (at.exp(), at.exp() * sd),
            k if k == 2 * n => {
                let rss = (at * units[0]).recip();
                (rss, rss * sd / at)
            }
            k => (at * units[k - 2 * n], sd * units[k - 2 * n].abs()),
        };
        (found.0.is_finite() && found.1.is_finite()).then_some(found)
    }

    /// Base parameters by their stored keys with their standard errors.
    pub(crate) fn base_parameters(&self) -> Vec<(String, f64, f64)> {
        let (slope, _) = self.problem.slope(&self.at);
        let inverse = slope.normal.inverse(1e-12);
        let order = self.branch_order();
        let n = order.len();
        let branches = order.iter().flat_map(|&k| [k, n + k]);
        let found = |k: usize| {
            let (value, error) = self.base_value(k, self.at[k], inverse.error(k))?;
            let is_there = k < 2 * n + 2 || value > 0.0;
            is_there.then(|| (self.base_key(k), value, error))
        };
        branches
            .chain(2 * n..self.problem.base_len())
            .filter_map(found)
            .collect()
    }
}

/// Fall of the sum of squares that ends a search which stands at `square`.
fn settle(problem: &ExtendedProblem, square: f64) -> f64 {
    SETTLE + SETTLE_PART * (square - problem.group.rows() as f64).max(0.0)
}

/// Degrees of freedom with which the noise of the group is known.
fn freedom(group: &RunGroup) -> f64 {
    group
        .blocks
        .iter()
        .filter_map(|block| group.channel(block))
        .map(|channel| channel.freedom())
        .sum()
}

/// An estimate whose coordinate has that standard deviation.
fn estimate(value: f64, sd: f64, quantile: f64, slope: f64, limits: Limits) -> Estimate {
    let half = quantile * sd;
    if limits.logarithmic {
        if half > WIDEST_HALF_LOG {
            return Estimate::not_determined("the readings fit as well with values ten times apart");
        }
        return Estimate::determined(value, value * sd, value * (-half).exp(), value * half.exp());
    }
    let half = half * slope.abs();
    if half > limits.high - limits.low {
        return Estimate::not_determined("its 95 % interval would be wider than all values that make sense");
    }
    Estimate::determined(value, sd * slope.abs(), value - half, value + half)
}
