//! Intervals of the parameters of a group: covariance where it is narrow, else profile likelihood, and a bootstrap.

use crate::joint::bootstrap::{replicate, spread};
use crate::joint::feature::Feature;
use crate::joint::minimum::excess;
use crate::joint::policy::FOLLOWED_LOG;
use crate::joint::problem::JointProblem;
use crate::joint::profile::{Deeper, Interval, Solved};
use crate::joint::single::{partner, reach};
use crate::policy::NARROW_PART;
use ieap_numerics::least_squares::Minimum;
use ieap_numerics::student::quantile_95;

use super::options::{Bootstrap, GroupOptions, Intervals, LIMIT, Resampled};

/// Deeper minima met on the way that are followed.
const RESTARTS: usize = 3;

/// A feature with its interval and, where it was profiled, what it trades off against.
pub(crate) type Found = (Feature, Interval, Option<(Feature, f64)>);

/// Intervals of every parameter of every run.
pub(super) struct JudgedGroup {
    pub(super) bottom: Minimum,
    pub(super) features: Vec<Vec<Found>>,
    pub(super) resampled: Vec<Vec<Resampled>>,
    pub(super) evaluations: u64,
}

fn features(problem: &JointProblem, run: usize) -> impl Iterator<Item = Feature> {
    let bends = problem.runs[run].curvature.is_some();
    Feature::all(problem.layout.branches).filter(move |feature| feature.is_electrical() || bends)
}

pub(super) fn judge(
    problem: &JointProblem,
    mut bottom: Minimum,
    options: &GroupOptions,
    mut evaluations: u64,
) -> JudgedGroup {
    let mut restarts = 0;
    let features_of = loop {
        match try_intervals(problem, &bottom, options, &mut evaluations) {
            Err(Deeper(at)) if restarts < RESTARTS => {
                restarts += 1;
                bottom = problem.search(&at, LIMIT, 1e-4);
            }
            Ok(found) => break found,
            Err(_) => break Vec::new(),
        }
    };
    let resampled = options
        .bootstrap
        .map_or_else(Vec::new, |bootstrap| resample(problem, &bottom, bootstrap));
    JudgedGroup {
        bottom,
        features: features_of,
        resampled,
        evaluations,
    }
}

fn try_intervals(
    problem: &JointProblem,
    bottom: &Minimum,
    options: &GroupOptions,
    evaluations: &mut u64,
) -> Result<Vec<Vec<Found>>, Deeper> {
    let freedom: f64 = problem
        .runs
        .iter()
        .flat_map(|run| [&run.current, &run.curvature])
        .flatten()
        .map(|response| response.noise.freedom)
        .sum();
    // What the circuit leaves beyond noise widens standard errors and intervals alike.
    let wider = excess(problem, bottom);
    let quantile = quantile_95(freedom.max(2.0)) * wider;
    let widened = |interval: Interval| Interval {
        standard_error: wider * interval.standard_error,
        ..interval
    };
    let mut solved = Solved::new(problem, bottom.clone());
    let mut found = Vec::with_capacity(problem.runs.len());
    for run in 0..problem.runs.len() {
        let mut own = Vec::new();
        for feature in features(problem, run) {
            let linear = solved.linear(feature, run, quantile);
            let scale = if feature.is_logarithm() {
                1.0
            } else {
                linear.value.abs()
            };
            let narrow = quantile * linear.standard_error <= NARROW_PART * scale;
            if narrow && options.intervals == Intervals::Automatic {
                own.push((feature, widened(linear), None));
                continue;
            }
            let reach = if feature.is_logarithm() {
                FOLLOWED_LOG
            } else {
                reach(&solved, feature, run, quantile)
            };
            let interval = solved.profile(feature, run, quantile, reach)?;
            own.push((feature, widened(interval), partner(&solved, feature, run)));
        }
        found.push(own);
    }
    *evaluations += solved.evaluations;
    Ok(found)
}

fn resample(problem: &JointProblem, bottom: &Minimum, bootstrap: Bootstrap) -> Vec<Vec<Resampled>> {
    let own = |run: usize| features(problem, run).map(move |feature| (run, feature));
    let wanted: Vec<(usize, Feature)> = (0..problem.runs.len()).flat_map(own).collect();
    let refits = replicate(problem, &bottom.at, &wanted, bootstrap.seed, bootstrap.replicates);
    let mut found: Vec<Vec<Resampled>> = vec![Vec::new(); problem.runs.len()];
    for (column, (run, feature)) in wanted.into_iter().enumerate() {
        let mut values: Vec<f64> = refits.iter().map(|refit| feature.stated(refit[column])).collect();
        let replicates = values.len();
        let Some(key) = feature.key() else { continue };
        if let Some((low_95, high_95, standard_deviation)) = spread(&mut values) {
            found[run].push(Resampled {
                key: key.to_owned(),
                standard_deviation,
                low_95,
                high_95,
                replicates,
            });
        }
    }
    found
}
