//! Intervals: from the covariance where the sum of squares is a parabola, else from the profile likelihood.

use ieap_numerics::least_squares::{Bounds, Levenberg, Local, Minimum, Problem};
use ieap_numerics::symmetric::Symmetric;

use super::feature::Feature;
use super::problem::JointProblem;
use super::spring::{Spring, gradient};
use crate::joint::policy::DEEPER_BY;

/// Evaluations allowed to one constrained search.
const LIMIT: u64 = 40;
/// Fall of the sum of squares at which a constrained search settles.
const SETTLE: f64 = 1e-3;
/// Stiffness of the constraint, per standard error of the feature.
const STIFFNESS: f64 = 20.0;

/// What is known of one feature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval {
    pub(crate) value: f64,
    /// From the covariance.
    pub(crate) standard_error: f64,
    /// Lower end; none where the sum of squares does not rise far enough within reach.
    pub(crate) low: Option<f64>,
    /// Upper end.
    pub(crate) high: Option<f64>,
}

impl Interval {
    /// That of a covariance: so many standard errors to either side.
    pub(crate) fn linear(value: f64, standard_error: f64, quantile: f64) -> Interval {
        Interval {
            value,
            standard_error,
            low: Some(value - quantile * standard_error),
            high: Some(value + quantile * standard_error),
        }
    }
}

/// A minimum with its covariance, ready to be asked for intervals.
pub(crate) struct Solved<'p, 'a> {
    pub(crate) problem: &'p JointProblem<'a>,
    pub(crate) bottom: Minimum,
    pub(crate) inverse: Symmetric,
    /// Evaluations of all searches.
    pub(crate) evaluations: u64,
}

/// A search along a feature met a deeper minimum.
pub(crate) struct Deeper(pub(crate) Vec<f64>);

impl<'p, 'a> Solved<'p, 'a> {
    pub(crate) fn new(problem: &'p JointProblem<'a>, bottom: Minimum) -> Solved<'p, 'a> {
        let inverse = bottom.local.normal.inverse(1e-13);
        Solved {
            problem,
            evaluations: bottom.evaluations,
            bottom,
            inverse,
        }
    }

    fn feature(&self, feature: Feature, run: usize, at: &[f64]) -> f64 {
        feature.of(self.problem.layout, &self.problem.of_run(run, at))
    }

    pub(crate) fn gradient(&self, feature: Feature, run: usize, at: &[f64]) -> Vec<f64> {
        gradient(self.problem, feature, run, at)
    }

    /// Correlation of two features under the covariance.
    pub(crate) fn correlation(&self, run: usize, a: Feature, b: Feature) -> f64 {
        let (a, b) = (
            self.gradient(a, run, &self.bottom.at),
            self.gradient(b, run, &self.bottom.at),
        );
        let form = |x: &[f64], y: &[f64]| self.inverse.form(x, y);
        form(&a, &b) / (form(&a, &a) * form(&b, &b)).max(f64::MIN_POSITIVE).sqrt()
    }

    /// The interval of the covariance; `quantile` standard errors to either side.
    pub(crate) fn linear(&self, feature: Feature, run: usize, quantile: f64) -> Interval {
        let gradient = self.gradient(feature, run, &self.bottom.at);
        let value = self.feature(feature, run, &self.bottom.at);
        Interval::linear(value, self.inverse.error_along(&gradient), quantile)
    }

    /// The interval within which the sum of squares, all else fitted anew, rises by less than `quantile` squared;
    /// looked for up to `reach` to either side.
    pub(crate) fn profile(
        &mut self,
        feature: Feature,
        run: usize,
        quantile: f64,
        reach: f64,
    ) -> Result<Interval, Deeper> {
        let mut interval = self.linear(feature, run, quantile);
        interval.low = self.side(feature, run, quantile, reach, &interval, -1.0)?;
        interval.high = self.side(feature, run, quantile, reach, &interval, 1.0)?;
        Ok(interval)
    }

    fn side(
        &mut self,
        feature: Feature,
        run: usize,
        quantile: f64,
        reach: f64,
        centre: &Interval,
        sign: f64,
    ) -> Result<Option<f64>, Deeper> {
        let least = self.bottom.local.square;
        let error = centre.standard_error.min(reach / quantile).max(1e-12 * reach);
        let stiffness = STIFFNESS / error;
        let mut at = self.bottom.at.clone();
        let (mut inner, mut outer) = ((0.0, 0.0), None::<(f64, f64)>);
        let mut wanted = quantile * error;
        for _ in 0..16 {
            let target = centre.value + sign * wanted;
            let found = self.held_near(feature, run, &at, target, stiffness);
            let distance = sign * (self.feature(feature, run, &found.at) - centre.value);
            let square = self.problem.condensed_square(&found.at);
            self.evaluations += found.evaluations;
            if square < least - DEEPER_BY {
                return Err(Deeper(found.at));
            }
            let rise = (square - least).max(0.0).sqrt();
            if (rise - quantile).abs() < 0.02 * quantile {
                let end = distance * (quantile / rise).clamp(0.97, 1.03);
                return Ok(Some(centre.value + sign * end));
            }
            if rise < quantile {
                if distance >= 0.999 * reach
                    || distance < inner.0 + 1e-9 * reach && outer.is_none() && inner.0 > 0.0
                {
                    // The end of what is looked at, or a limit of the search, without a rise.
                    return Ok(None);
                }
                inner = (distance.max(inner.0), rise);
                at = found.at;
            } else {
                outer = Some((distance, rise));
            }
            wanted = match outer {
                Some((far, rise)) if far > inner.0 + 1e-9 * reach => {
                    let share = (quantile - inner.1) / (rise - inner.1).max(1e-12);
                    inner.0 + (far - inner.0) * share.clamp(0.05, 0.95)
                }
                Some((far, _)) => return Ok(Some(centre.value + sign * far)),
                None => {
                    let stretch = (quantile / inner.1.max(0.1)).clamp(1.2, 3.0);
                    (wanted.max(distance) * stretch).min(reach * 1.02)
                }
            };
        }
        let end = outer.map(|(far, _)| centre.value + sign * far);
        Ok(end)
    }

    /// The best place where the feature lies near `target`: the sum of squares with a stiff spring on the
    /// feature. Wherever it ends, it is the best place for the feature's value there.
    fn held_near(&self, feature: Feature, run: usize, from: &[f64], target: f64, stiffness: f64) -> Minimum {
        let held = HeldNear {
            problem: self.problem,
            spring: Spring {
                run,
                feature,
                target,
                stiffness,
            },
        };
        Levenberg::by_diagonal(LIMIT, SETTLE).search(&held, from)
    }
}

/// The condensed problem with a spring on a feature.
struct HeldNear<'p, 'a> {
    problem: &'p JointProblem<'a>,
    spring: Spring,
}

impl Problem for HeldNear<'_, '_> {
    fn bounds(&self) -> Bounds {
        self.problem.bounds.clone()
    }

    fn local(&self, at: &[f64], most: f64) -> Local {
        let gap = self.spring.gap(self.problem, at);
        // Rounding of the difference must not refuse what is taken.
        let without = most - gap * gap + 1e-12 * most.abs();
        let mut local = self.problem.local(at, without);
        self.spring.add(self.problem, at, &mut local);
        local
    }
}
