//! Fits of several runs at once: parameters that all runs share, others free in every run.

mod intervals;
mod search;

use crate::domain::{Fit, Issue, Parameter};
use crate::model::FitModel;

use super::joint::feature::Feature;
use super::joint::problem::{Layout, Over, Problem};
use super::joint::readings::RunReadings;
use super::joint::start::Start;
use super::outcome;
use super::{FitError, FitInput, FitOptions, Readings, identify, needed};

pub(super) use intervals::Found;
use intervals::{JudgedGroup, judge};
use search::search;

/// How to fit a group.
#[derive(Debug, Clone)]
pub struct GroupOptions {
    /// The model.
    pub model: &'static FitModel,
    /// Keys of the parameters that all runs share, as in [`shareable`]; the others are free in every run.
    pub shared: Vec<String>,
    /// How intervals are found.
    pub intervals: Intervals,
    /// Bootstrap as a further opinion; none to do without.
    pub bootstrap: Option<Bootstrap>,
}

/// How intervals are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Intervals {
    /// From the covariance where it is narrow, else by profile likelihood.
    #[default]
    Automatic,
    /// By profile likelihood always.
    Profile,
}

/// A block bootstrap of the residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bootstrap {
    /// Seed of the generator.
    pub seed: u64,
    /// Number of refits; 200 tell a standard error to 5 %.
    pub replicates: usize,
}

impl Default for GroupOptions {
    /// Two branches, everything shared.
    fn default() -> GroupOptions {
        GroupOptions::sharing_all(FitOptions::default().model)
    }
}

impl GroupOptions {
    /// Every parameter shared: the runs are repeats of one sample in one condition.
    pub fn sharing_all(model: &'static FitModel) -> GroupOptions {
        GroupOptions {
            model,
            shared: shareable(model).into_iter().map(str::to_owned).collect(),
            intervals: Intervals::default(),
            bootstrap: None,
        }
    }
}

/// Keys of the parameters that a group may share: those of the model that are not derived.
pub fn shareable(model: &FitModel) -> Vec<&'static str> {
    let own = model.parameters.iter().filter(|parameter| !parameter.derived);
    own.map(|parameter| parameter.key).collect()
}

/// A fit of several runs.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupFit {
    /// Keys of the shared parameters.
    pub shared: Vec<String>,
    /// Every run with its parameters (the shared ones the same in all), noise and curves.
    pub runs: Vec<Fit>,
    /// Weighted sum of squared residuals over all runs: minus twice the log likelihood but for a constant.
    pub chi_square: f64,
    /// Readings minus parameters.
    pub degrees_of_freedom: f64,
    /// Standard deviations and 95 % ranges of the bootstrap, per run, where asked for.
    pub bootstrap: Vec<Vec<Resampled>>,
    /// Whether the search converged.
    pub converged: bool,
    /// Why it stopped.
    pub why_stopped: String,
    /// Evaluations.
    pub evaluations: u64,
}

/// What the bootstrap says of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Resampled {
    /// Key of the parameter.
    pub key: String,
    /// Standard deviation of the refits, unit of the parameter.
    pub standard_deviation: f64,
    /// 2.5 % point of the refits.
    pub low_95: f64,
    /// 97.5 % point.
    pub high_95: f64,
    /// Refits that counted.
    pub replicates: usize,
}

/// Evaluations of one search over the condensed readings.
const LIMIT: u64 = 150;

/// Fits all runs at once, current and curvature weighted by their noise.
///
/// # Errors
/// [`FitError`] where there is no run, a key cannot be shared, or a run gives nothing to start from.
pub fn fit_group(inputs: &[FitInput], options: &GroupOptions) -> Result<GroupFit, FitError> {
    let layout = Layout {
        branches: options.model.branches,
    };
    let shared = shared_places(layout, options)?;
    if inputs.is_empty() {
        return Err(FitError::EmptyGroup);
    }
    let mut runs = Vec::with_capacity(inputs.len());
    let mut starts = Vec::with_capacity(inputs.len());
    for (index, input) in inputs.iter().enumerate() {
        let (run, start) = prepare(index, input, options)?;
        runs.push(run);
        starts.push(start);
    }
    let (problem, bottom, evaluations) = search(runs, &starts, &shared);
    let judged = judge(&problem, bottom, options, evaluations);
    Ok(assemble(inputs, options, &problem, judged))
}

/// Local places of the shared keys.
fn shared_places(layout: Layout, options: &GroupOptions) -> Result<Vec<usize>, FitError> {
    let known = shareable(options.model);
    let place = |key: &String| {
        let feature = known
            .contains(&key.as_str())
            .then(|| Feature::of_key(key, layout.branches))
            .flatten();
        let local = match feature {
            Some(Feature::Resistance(k)) => Some(layout.resistance(k)),
            Some(Feature::Capacitance(k)) => Some(layout.capacitance(k)),
            Some(Feature::Steady) => Some(layout.steady()),
            Some(Feature::Coupling) => Some(layout.coupling()),
            Some(Feature::Rate) => Some(layout.rate()),
            _ => None,
        };
        local.ok_or_else(|| FitError::SharedParameter {
            found: key.clone(),
            known: known.join(", "),
        })
    };
    options.shared.iter().map(place).collect()
}

/// Readings of a run with their noise, and where its own two-step fit puts it.
fn prepare<'a>(
    index: usize,
    input: &FitInput<'a>,
    options: &GroupOptions,
) -> Result<(RunReadings<'a>, Start), FitError> {
    let own = FitOptions {
        model: options.model,
        ..FitOptions::default()
    };
    let readings = Readings::new(input)?;
    readings.check(input, &own)?;
    let identified = identify(input, &own, readings);
    let (_, electrical) = identified.current.as_ref().map_err(|reason| FitError::GroupRun {
        index,
        reason: reason.clone(),
    })?;
    let mut start = Start::of(electrical, options.model.branches);
    let mut run = RunReadings::new(input.channels, input.drive, input.area_cm2, needed(options.model));
    match &identified.curvature {
        Ok((_, bending)) => start = start.with_bending(bending),
        Err(_) => run.curvature = None,
    }
    Ok((run, start))
}

fn assemble(inputs: &[FitInput], options: &GroupOptions, problem: &Problem, judged: JudgedGroup) -> GroupFit {
    let readings: usize = problem.runs.iter().map(RunReadings::len).sum();
    let stop = judged.bottom.stop;
    let mut runs = Vec::with_capacity(inputs.len());
    for (run, input) in inputs.iter().enumerate() {
        let local = problem.local(run, &judged.bottom.at);
        let fitted = problem.runs[run].fitted(&problem.model(&local), problem.offsets(&local));
        let features = judged.features.get(run).map_or(&[][..], Vec::as_slice);
        let parameters = outcome::joint_parameters(options.model, features, input.drive);
        runs.push(outcome::joint_fit(
            input,
            options.model,
            &problem.runs[run],
            fitted,
            parameters,
            (stop, judged.evaluations),
        ));
    }
    GroupFit {
        shared: options.shared.clone(),
        chi_square: problem.square(&judged.bottom.at, Over::Whole),
        degrees_of_freedom: readings as f64 - judged.bottom.at.len() as f64,
        bootstrap: judged.resampled,
        converged: stop.converged(),
        why_stopped: stop.words().to_owned(),
        evaluations: judged.evaluations,
        runs,
    }
}

impl GroupFit {
    /// The shared parameters, as every run has them.
    pub fn shared_parameters(&self) -> Vec<&Parameter> {
        let first = self.runs.first().map_or(&[][..], |fit| fit.parameters.as_slice());
        first
            .iter()
            .filter(|parameter| self.shared.contains(&parameter.key))
            .collect()
    }

    /// Issues of all runs, each with the position of its run.
    pub fn issues(&self) -> Vec<(usize, &Issue)> {
        let of_run = |(run, fit): (usize, &'_ Fit)| -> Vec<(usize, usize)> {
            (0..fit.issues.len()).map(|issue| (run, issue)).collect()
        };
        let places = self.runs.iter().enumerate().flat_map(of_run);
        places
            .map(|(run, issue)| (run, &self.runs[run].issues[issue]))
            .collect()
    }
}
