//! Proof on readings that took no part in a fit: a drive left out with all its repeats, or for a single run a stretch of
//! its time.

use rayon::prelude::*;

use ieap_domain::ResidualCurve;
use ieap_domain::number::seconds::span;
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_numerics::least_squares::Minimum;

use crate::cause::policy::{EARLIER_PART, HELD_OUT_OF_LOG};
use crate::cause::proof::beyond_doubt::BeyondDoubt;
use crate::cause::proof::block_error::BlockError;
use crate::cause::proof::doubt::Doubt;
use crate::cause::proof::predictive::Predictive;
use crate::fitting::fitted::{Fitted, HELD};
use crate::fitting::problem::ExtendedProblem;
use crate::readings::drawn::drawn;
use crate::readings::group::{Block, RunGroup};
use crate::readings::quantities::{Predicted, predicted};

/// Evaluations of a refit without the held-out part, along the slopes at the fit to everything, from which it starts.
pub(crate) const REFIT: u64 = HELD;
pub(crate) const SETTLE: f64 = 0.05;
/// Parts of a single run's time that are held out in turn: the middle of its logarithm by what surrounds it, for what
/// happens after a step happens there, and the end by the rest.
pub(super) const OF_TIME: [HeldOutTime; 2] = [
    HeldOutTime::OfLogarithm(HELD_OUT_OF_LOG.0, HELD_OUT_OF_LOG.1),
    HeldOutTime::OfTime(EARLIER_PART, 1.0),
];

/// A stretch of a run's time, as parts of it or of its logarithm.
#[derive(Debug, Clone, Copy)]
pub(super) enum HeldOutTime {
    OfLogarithm(f64, f64),
    OfTime(f64, f64),
}

impl HeldOutTime {
    /// First and last time, s after the start of a run of that length whose readings follow each other that closely.
    fn ends_s(self, shortest_s: f64, duration_s: f64) -> (f64, f64) {
        match self {
            HeldOutTime::OfTime(from, to) => (from * duration_s, to * duration_s),
            HeldOutTime::OfLogarithm(from, to) => {
                let span = (duration_s / shortest_s).max(1.0).ln();
                let at = |part: f64| shortest_s * (part * span).exp();
                (at(from), at(to))
            }
        }
    }
}

/// One held-out part and how well it was predicted.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    pub(crate) name: String,
    /// How far it lies from the prediction, the prediction's own uncertainty allowed for.
    pub(crate) deviance: f64,
    /// Current and curvature beside the prediction.
    pub(crate) deviations: [Deviations; 2],
    /// The same run by run and channel by channel, in units of the noise.
    pub(crate) errors: Vec<BlockError>,
    /// The same beyond the doubt of the prediction; none where that is not known.
    pub(crate) beyond_doubt: Option<BeyondDoubt>,
    /// What a user predicts of each run; none where times of a run are held out.
    pub(crate) predicted: Vec<Predicted>,
    /// What is left of it, drawn.
    pub(crate) curves: Vec<ResidualCurve>,
}

impl Part {
    /// A part of which nothing is compared yet.
    pub(crate) fn new(name: String, deviance: f64) -> Part {
        Part {
            name,
            deviance,
            deviations: <[Deviations; 2]>::default(),
            errors: Vec::new(),
            beyond_doubt: None,
            predicted: Vec::new(),
            curves: Vec::new(),
        }
    }
}

/// Held-out readings of one channel beside what was predicted of them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Deviations {
    /// Sum of the squares of measured minus predicted, in the channel's unit squared.
    pub(crate) square: f64,
    pub(crate) readings: usize,
    /// Readings within the 95 % interval of the prediction: by the noise, the parameters and the error that the model leaves.
    pub(crate) covered: usize,
}

impl Deviations {
    pub(crate) fn add(&mut self, other: Deviations) {
        self.square += other.square;
        self.readings += other.readings;
        self.covered += other.covered;
    }
}

/// Held-out parts by two models.
pub(crate) struct HeldOut {
    pub(crate) before: Vec<Part>,
    pub(crate) after: Vec<Part>,
}

impl HeldOut {
    /// Fall of the deviance on every part.
    pub(crate) fn falls(&self) -> Vec<f64> {
        let pairs = self.before.iter().zip(&self.after);
        pairs
            .map(|(before, after)| before.deviance - after.deviance)
            .collect()
    }

    /// Parts that come out better, of how many.
    pub(crate) fn better(&self) -> (usize, usize) {
        let falls = self.falls();
        (falls.iter().filter(|fall| **fall > 0.0).count(), falls.len())
    }
}

/// Runs or times that are held out.
pub(crate) fn kind(group: &RunGroup) -> &'static str {
    if group.runs.len() > 1 { "run" } else { "time" }
}

/// Every part predicted by the model refitted without it.
pub(crate) fn parts(fitted: &Fitted, group: &RunGroup) -> Vec<Part> {
    let predictive = Predictive::of(fitted);
    if group.runs.len() > 1 {
        drives(group)
            .par_iter()
            .map(|runs| left_out(fitted, &predictive, group, runs))
            .collect()
    } else {
        OF_TIME
            .par_iter()
            .map(|&held_out_time| out_of_time(fitted, &predictive, group, held_out_time))
            .collect()
    }
}

/// The runs of each drive: left in, a repeat would tell what a left-out run is like whatever the model. Every run by
/// itself where all are of one drive.
pub(crate) fn drives(group: &RunGroup) -> Vec<Vec<usize>> {
    let drives = group.drives();
    match drives.len() {
        1 => (0..group.runs.len()).map(|run| vec![run]).collect(),
        _ => drives,
    }
}

fn rows_of_runs(group: &RunGroup, runs: &[usize]) -> Vec<bool> {
    let mut out = vec![false; group.rows()];
    for block in group.blocks.iter().filter(|block| runs.contains(&block.run)) {
        out[block.first..block.end].fill(true);
    }
    out
}

/// The rows of the later part of those runs.
pub(crate) fn later_rows(group: &RunGroup, runs: &[usize]) -> Vec<bool> {
    let mut out = vec![false; group.rows()];
    for &run in runs {
        let (rows, _) = rows_of_time(group, run, HeldOutTime::OfTime(EARLIER_PART, 1.0));
        out.iter_mut().zip(rows).for_each(|(out, is_out)| *out |= is_out);
    }
    out
}

/// The rows of a stretch of a run, and its ends, s after the start of the drive.
fn rows_of_time(group: &RunGroup, run: usize, held_out_time: HeldOutTime) -> (Vec<bool>, (f64, f64)) {
    let group_run = &group.runs[run];
    let start_s = group_run.context(run, None).start_s();
    let times = |channel: usize| group_run.times(channel).iter().map(|t| t - start_s);
    let shortest_s = (0..2)
        .flat_map(|channel| times(channel).find(|t| *t > 0.0))
        .fold(f64::INFINITY, f64::min);
    let (from_s, to_s) = held_out_time.ends_s(shortest_s, group_run.duration_s - start_s);
    let mut out = vec![false; group.rows()];
    for block in group.blocks.iter().filter(|block| block.run == run) {
        for (k, t) in times(block.channel).enumerate() {
            out[block.first + k] = t >= from_s && t <= to_s;
        }
    }
    (out, (from_s, to_s))
}

fn left_out(fitted: &Fitted, predictive: &Predictive, group: &RunGroup, runs: &[usize]) -> Part {
    let out = rows_of_runs(group, runs);
    let bottom = without(fitted, predictive, &out);
    let doubt = Doubt::of(&fitted.problem, predictive, &bottom.at, &out);
    Part {
        deviance: predictive.deviance(&out, bottom.local.square),
        beyond_doubt: Some(beyond_doubt(fitted, predictive, &bottom.at, (&out, &out))),
        ..predicted_part(&fitted.problem, &bottom.at, group, runs, Some(&doubt))
    }
}

/// The rows that are `own` beyond the doubt of a prediction by the model at a place that was found without those that are `out`.
pub(super) fn beyond_doubt(
    fitted: &Fitted,
    predictive: &Predictive,
    at: &[f64],
    rows: (&[bool], &[bool]),
) -> BeyondDoubt {
    let mut residuals = Vec::new();
    fitted.problem.residuals(at, &mut residuals);
    BeyondDoubt::of(fitted.problem.group, predictive, &residuals, rows)
}

/// Runs predicted by a model that was fitted without them, counted by their error as [`predicted_part`] counts.
pub(crate) fn left_out_by(fitted: &Fitted, group: &RunGroup, runs: &[usize]) -> Part {
    let bottom = without(fitted, &Predictive::of(fitted), &rows_of_runs(group, runs));
    predicted_part(&fitted.problem, &bottom.at, group, runs, None)
}

/// Runs beside the model at a place that was found without them. What is counted is the mean squared error of each channel in
/// percent of its range: in standard deviations of the noise the quietest runs would decide alone.
pub(crate) fn predicted_part(
    problem: &ExtendedProblem,
    at: &[f64],
    group: &RunGroup,
    runs: &[usize],
    doubt: Option<&Doubt>,
) -> Part {
    let model = problem.model(at);
    let mut part = Part::new(name(group, runs), 0.0);
    for &run in runs {
        let group_run = &group.runs[run];
        let context = group_run.context(run, None);
        let found = group_run.fitted(&model, &context);
        let variances = doubt.map(|doubt| doubt.variances(problem, at, run));
        compare(&mut part, group, run, (&found, variances.as_ref()), &|_| true);
        part.predicted
            .push(predicted(group_run, found.each_ref().map(Vec::as_slice)));
    }
    let own = std::slice::from_ref(&part);
    let errors = (0..2).filter_map(|channel| nrmse(group, own, channel));
    part.deviance = errors.map(|error| (100.0 * error).powi(2)).sum();
    part
}

/// Where the model lies without the rows that are `out`.
fn without(fitted: &Fitted, predictive: &Predictive, out: &[bool]) -> Minimum {
    let columns = predictive.columns_without(out);
    let problem = fitted.problem.without(out);
    problem.search(&fitted.at, REFIT, SETTLE, &columns)
}

/// Root mean square deviation of a channel's held-out readings over its range.
pub(crate) fn nrmse(group: &RunGroup, parts: &[Part], channel: usize) -> Option<f64> {
    let all = sum(parts.iter().map(|part| part.deviations[channel]));
    let range = range(group, channel)?;
    (all.readings > 0).then(|| (all.square / all.readings as f64).sqrt() / range)
}

pub(crate) fn sum(deviations: impl Iterator<Item = Deviations>) -> Deviations {
    let mut all = Deviations::default();
    deviations.for_each(|part| all.add(part));
    all
}

/// Range of all readings of a channel.
fn range(group: &RunGroup, channel: usize) -> Option<f64> {
    let readings = group.runs.iter().filter_map(|run| run.channels[channel].as_ref());
    let (low, high) = readings.flat_map(|readings| readings.values().to_vec()).fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(low, high): (f64, f64), v| (low.min(v), high.max(v)),
    );
    (high > low).then_some(high - low)
}

/// What a part is called: its run, or the first of several.
fn name(group: &RunGroup, runs: &[usize]) -> String {
    let first = group.runs[runs[0]].given.name;
    match runs.len() {
        1 => first.to_owned(),
        2 => format!("{first} and its repeat"),
        n => format!("{first} and its {} repeats", n - 1),
    }
}

/// Adds to the part the wanted readings of a run beside what was predicted of them, with the variance of what was, where it is
/// known.
pub(crate) fn compare(
    part: &mut Part,
    group: &RunGroup,
    run: usize,
    (fitted, variances): (&[Vec<f64>; 2], Option<&[Vec<f64>; 2]>),
    wanted: &dyn Fn(usize) -> bool,
) {
    for block in group.blocks.iter().filter(|block| block.run == run) {
        let fitted = &fitted[block.channel];
        let variances = variances.map_or(&[][..], |of| &of[block.channel]);
        part.deviations[block.channel].add(deviations(group, block, (fitted, variances), wanted));
        part.errors.extend(BlockError::of(group, block, fitted, wanted));
        part.curves.extend(drawn(group, block, fitted, wanted));
    }
}

fn deviations(
    group: &RunGroup,
    block: &Block,
    (fitted, variances): (&[f64], &[f64]),
    wanted: &dyn Fn(usize) -> bool,
) -> Deviations {
    let mut sum = Deviations::default();
    let Some(channel) = group.channel(block) else {
        return sum;
    };
    let readings = channel.values().iter().zip(channel.standard_deviation());
    for (k, ((y, sd), f)) in readings.zip(fitted).enumerate() {
        if wanted(block.first + k) {
            sum.square += (y - f) * (y - f);
            sum.readings += 1;
            let sd = (sd * sd + variances.get(k).unwrap_or(&0.0)).sqrt();
            sum.covered += usize::from((y - f).abs() <= NORMAL_95_ROUNDED * sd);
        }
    }
    sum
}

fn out_of_time(
    fitted: &Fitted,
    predictive: &Predictive,
    group: &RunGroup,
    held_out_time: HeldOutTime,
) -> Part {
    let run = &group.runs[0];
    let (out, (from_s, to_s)) = rows_of_time(group, 0, held_out_time);
    let bottom = without(fitted, predictive, &out);
    let model = fitted.problem.model(&bottom.at);
    let found = run.fitted(&model, &run.context(0, None));
    let deviance = predictive.deviance(&out, bottom.local.square);
    let mut part = Part::new(span(from_s, to_s), deviance);
    part.beyond_doubt = Some(beyond_doubt(fitted, predictive, &bottom.at, (&out, &out)));
    let variances = Doubt::of(&fitted.problem, predictive, &bottom.at, &out);
    let variances = variances.variances(&fitted.problem, &bottom.at, 0);
    compare(&mut part, group, 0, (&found, Some(&variances)), &|row| out[row]);
    part
}
