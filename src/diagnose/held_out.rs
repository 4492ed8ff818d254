//! Proof on readings that took no part in a fit: a run left out, or for a single run a stretch of its time.

use rayon::prelude::*;

use crate::domain::ResidualCurve;
use crate::model::extended::Responses;

use super::drawn::drawn;
use super::fitted::Fitted;
use super::group::Group;
use super::predictive::Predictive;
use super::quantities::{Predicted, predicted};

/// Evaluations of a refit without the held-out part; it starts from the fit to everything.
const REFIT: u64 = 6;
const SETTLE: f64 = 0.05;
/// Parts of a single run's time that are held out in turn: the middle of its logarithm by what surrounds it, for what
/// happens after a step happens there, and the end by the rest.
const OF_TIME: [Stretch; 2] = [Stretch::OfLogarithm(0.5, 0.75), Stretch::OfTime(0.6, 1.0)];

/// A stretch of a run's time, as parts of it or of its logarithm.
#[derive(Debug, Clone, Copy)]
enum Stretch {
    OfLogarithm(f64, f64),
    OfTime(f64, f64),
}

impl Stretch {
    /// First and last time, s after the start of a run of that length whose readings follow each other that closely.
    fn ends_s(self, shortest_s: f64, duration_s: f64) -> (f64, f64) {
        match self {
            Stretch::OfTime(from, to) => (from * duration_s, to * duration_s),
            Stretch::OfLogarithm(from, to) => {
                let span = (duration_s / shortest_s).max(1.0).ln();
                let at = |part: f64| shortest_s * (part * span).exp();
                (at(from), at(to))
            }
        }
    }
}

/// One held-out part and how well it was predicted.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Part {
    pub(super) name: String,
    /// How far it lies from the prediction, the prediction's own uncertainty allowed for.
    pub(super) deviance: f64,
    /// Squares of the deviations, and readings, of current and curvature.
    pub(super) deviations: [(f64, usize); 2],
    /// What a user predicts of a run; none where times of a run are held out.
    pub(super) predicted: Option<Predicted>,
    /// What is left of it, drawn.
    pub(super) curves: Vec<ResidualCurve>,
}

/// Runs or times that are held out.
pub(super) fn kind(group: &Group) -> &'static str {
    if group.runs.len() > 1 { "run" } else { "time" }
}

/// Every part predicted by the model refitted without it.
pub(super) fn parts(fitted: &Fitted, group: &Group) -> Vec<Part> {
    let predictive = Predictive::of(fitted);
    if group.runs.len() > 1 {
        (0..group.runs.len())
            .into_par_iter()
            .map(|run| left_out(fitted, &predictive, group, run))
            .collect()
    } else {
        OF_TIME
            .par_iter()
            .map(|&stretch| out_of_time(fitted, &predictive, group, stretch))
            .collect()
    }
}

/// Rows that each part leaves out, in the order of [`parts`].
pub(super) fn rows(group: &Group) -> Vec<Vec<bool>> {
    if group.runs.len() > 1 {
        (0..group.runs.len()).map(|run| rows_of_run(group, run)).collect()
    } else {
        OF_TIME
            .iter()
            .map(|&stretch| rows_of_time(group, stretch).0)
            .collect()
    }
}

fn rows_of_run(group: &Group, run: usize) -> Vec<bool> {
    let mut out = vec![false; group.rows()];
    for block in group.blocks.iter().filter(|block| block.run == run) {
        out[block.first..block.end].fill(true);
    }
    out
}

/// The rows of a stretch of the only run, and its ends, s after the start of the drive.
fn rows_of_time(group: &Group, stretch: Stretch) -> (Vec<bool>, (f64, f64)) {
    let run = &group.runs[0];
    let start_s = run.context(0, None).start_s();
    let times = |channel: usize| run.times(channel).iter().map(|t| t - start_s);
    let shortest_s = (0..2)
        .flat_map(|channel| times(channel).find(|t| *t > 0.0))
        .fold(f64::INFINITY, f64::min);
    let (from_s, to_s) = stretch.ends_s(shortest_s, run.duration_s - start_s);
    let mut out = vec![false; group.rows()];
    for block in &group.blocks {
        for (k, t) in times(block.channel).enumerate() {
            out[block.first + k] = t >= from_s && t <= to_s;
        }
    }
    (out, (from_s, to_s))
}

fn left_out(fitted: &Fitted, predictive: &Predictive, group: &Group, run: usize) -> Part {
    let others: Vec<usize> = (0..group.runs.len()).filter(|&other| other != run).collect();
    let bottom = fitted
        .problem
        .over(others)
        .descend(&fitted.at, REFIT, SETTLE, &[]);
    let model = fitted.problem.model(&bottom.at);
    let group_run = &group.runs[run];
    let context = group_run.context(run, None);
    let found = model.responses(&context, group_run.times(0), group_run.times(1));
    let of = |k: usize, values: &[f64]| {
        let measured = group_run.channels[k]
            .as_ref()
            .map(|channel| channel.values().clone());
        let pairs = measured.iter().flat_map(|measured| measured.iter().zip(values));
        (pairs.map(|(y, f)| (y - f) * (y - f)).sum::<f64>(), values.len())
    };
    Part {
        name: group_run.given.name.to_owned(),
        deviance: predictive.deviance(&rows_of_run(group, run), bottom.slope.square),
        deviations: [of(0, &found.current_a), of(1, &found.curvature_per_cm)],
        predicted: Some(predicted(group_run, [&found.current_a, &found.curvature_per_cm])),
        curves: curves(group, run, &found, &|_| true),
    }
}

/// Drawn residuals of the run's channels.
fn curves(
    group: &Group,
    run: usize,
    found: &Responses,
    wanted: &dyn Fn(usize) -> bool,
) -> Vec<ResidualCurve> {
    let of_run = group.blocks.iter().filter(|block| block.run == run);
    let fitted = [&found.current_a, &found.curvature_per_cm];
    of_run
        .filter_map(|block| drawn(group, block, fitted[block.channel], wanted))
        .collect()
}

fn out_of_time(fitted: &Fitted, predictive: &Predictive, group: &Group, stretch: Stretch) -> Part {
    let run = &group.runs[0];
    let (out, (from_s, to_s)) = rows_of_time(group, stretch);
    let bottom = fitted
        .problem
        .without(&out)
        .descend(&fitted.at, REFIT, SETTLE, &[]);
    let model = fitted.problem.model(&bottom.at);
    let found = model.responses(&run.context(0, None), run.times(0), run.times(1));
    let mut deviations = [(0.0, 0); 2];
    for block in &group.blocks {
        let values = [&found.current_a, &found.curvature_per_cm][block.channel];
        let measured = run.channels[block.channel]
            .as_ref()
            .map(|channel| channel.values().clone());
        for (k, (y, f)) in measured.iter().flat_map(|m| m.iter().zip(values)).enumerate() {
            if out[block.first + k] {
                deviations[block.channel].0 += (y - f) * (y - f);
                deviations[block.channel].1 += 1;
            }
        }
    }
    Part {
        name: format!("{from_s:.3} to {to_s:.3} s"),
        deviance: predictive.deviance(&out, bottom.slope.square),
        deviations,
        predicted: None,
        curves: curves(group, 0, &found, &|row| out[row]),
    }
}
