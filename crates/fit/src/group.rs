//! Fits of several runs at once: parameters that all runs share, others free in every run.

mod intervals;
pub(super) mod known;
mod open_edges;
mod options;
mod policy;
pub(super) mod reductions;
mod search;
pub(super) mod step_and_spectrum;

use ieap_domain::{Drive, Fit, Issue, Parameter};
use ieap_model::{FitModel, ParameterDescription};
use ieap_numerics::chance::chi_square_chance;

use super::joint::feature::Feature;
use super::joint::layout::Layout;
use super::joint::minimum::excess;
use super::joint::problem::JointProblem;
use super::joint::readings::{Response, RunReadings};
use super::joint::start::Start;
use super::outcome;
use super::sampled::Sampled;
use crate::edges::EdgeTimes;
use crate::edges::Settled;
use crate::error::FitError;
use crate::nuisances;
use crate::options::{FitInput, FitOptions};
use crate::outliers::Cleaned;
use crate::two_steps::{Identified, Readings, identify, needed};
use crate::widened::{self, widen_by};

pub(super) use intervals::Found;
use intervals::{JudgedGroup, judge};
pub use options::{Bootstrap, GroupOptions, Intervals, Resampled, shareable};
use search::search;

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
    /// What sharing costs; none for a single run.
    pub sharing: Option<Sharing>,
    /// Standard deviations and 95 % ranges of the bootstrap, per run, where asked for.
    pub bootstrap: Vec<Vec<Resampled>>,
    /// Whether the search converged.
    pub converged: bool,
    /// Why it stopped.
    pub why_stopped: String,
    /// Evaluations.
    pub evaluations: u64,
}

/// Likelihood ratio of the shared parameters against the same ones free in every run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sharing {
    /// Rise of the weighted sum of squares.
    pub chi_square_rise: f64,
    /// Parameters saved.
    pub parameters_saved: usize,
    /// Chance of such a rise where the runs have them in common.
    pub p: f64,
}

/// Fits all runs at once, current and curvature weighted by their noise; edges that only readings tell of are sought between
/// these with all that the runs share, and what is left open of them widens the intervals.
pub(crate) fn fit_on_one_clock(inputs: &[FitInput], options: &GroupOptions) -> Result<GroupFit, FitError> {
    let edges: Vec<EdgeTimes> = inputs.iter().map(|input| EdgeTimes::of(input.drive)).collect();
    if !edges.iter().any(EdgeTimes::is_open) {
        return fit_placed(inputs, options);
    }
    let middle = with_drives(inputs, edges.iter().map(EdgeTimes::drive));
    let (runs, starts) = prepared(&middle, options)?;
    let (problem, bottom, _) = search(runs, &starts, &shared_places(options)?);
    let Some(placed) = open_edges::placed(&problem, &bottom.at, &edges) else {
        let mut group = fit_placed(&middle, options)?;
        for (fit, input) in group.runs.iter_mut().zip(inputs) {
            let settled = Settled::in_the_middle(input.drive);
            fit.nuisances.extend(nuisances::edges(&settled, input.drive));
        }
        return Ok(group);
    };
    let drives = placed.iter().map(|placed| placed.settled.edges.drive());
    let mut group = fit_placed(&with_drives(inputs, drives), options)?;
    for (run, (fit, placed)) in group.runs.iter_mut().zip(&placed).enumerate() {
        let found = nuisances::edges(&placed.settled, inputs[run].drive);
        fit.nuisances.extend(found);
        let before = fit.clone();
        if widen_by(&mut fit.parameters, &placed.here, &placed.ends) {
            fit.issues.push(widened::issue(&placed.settled));
            // Refits have the edges where they are taken to be, too.
            let resampled = group.bootstrap.get_mut(run).into_iter().flatten();
            resampled.for_each(|own| own.widen(&before, fit));
        }
    }
    Ok(group)
}

/// The edges of one run, searched with the parameters of both its responses from what was `identified` of it with the drive of
/// `edges`; none where its current tells of no circuit.
pub(crate) fn settled(
    input: &FitInput,
    options: &FitOptions,
    edges: &EdgeTimes,
    identified: &Identified,
) -> Option<Settled> {
    let options = GroupOptions::sharing_all(options.model);
    let drive = edges.drive();
    let (run, start) = readings_and_start(&FitInput { drive, ..*input }, options.model, identified).ok()?;
    let (problem, bottom, _) = search(vec![run], &[start], &shared_places(&options).ok()?);
    let placed = open_edges::placed(&problem, &bottom.at, std::slice::from_ref(edges))?;
    placed.into_iter().next().map(|placed| placed.settled)
}

/// The runs with other drives.
fn with_drives<'a>(inputs: &[FitInput<'a>], drives: impl Iterator<Item = &'a Drive>) -> Vec<FitInput<'a>> {
    let with = |(input, drive): (&FitInput<'a>, &'a Drive)| FitInput { drive, ..*input };
    inputs.iter().zip(drives).map(with).collect()
}

/// The same of runs whose edges are where their drives have them.
pub(super) fn fit_placed(inputs: &[FitInput], options: &GroupOptions) -> Result<GroupFit, FitError> {
    let shared = shared_places(options)?;
    let (runs, starts) = prepared(inputs, options)?;
    let (problem, bottom, evaluations) = search(runs, &starts, &shared);
    let mut judged = judge(&problem, bottom, options, evaluations);
    let sharing = (inputs.len() > 1).then(|| weigh_sharing(&problem, &starts, &mut judged));
    let fit = assemble(inputs, options, &problem, judged);
    Ok(GroupFit { sharing, ..fit })
}

/// Readings of every run, and where its own fit puts it.
fn prepared<'a>(
    inputs: &[FitInput<'a>],
    options: &GroupOptions,
) -> Result<(Vec<RunReadings<'a>>, Vec<Start>), FitError> {
    if inputs.is_empty() {
        return Err(FitError::EmptyGroup);
    }
    let each = inputs.iter().enumerate();
    each.map(|(index, input)| prepare(index, input, options))
        .collect()
}

/// Whether a run can be part of a group: it needs a current with enough readings.
///
/// # Errors
/// [`FitError`] says why it cannot.
pub fn can_join_group(input: &FitInput, model: &'static FitModel) -> Result<(), FitError> {
    let own = FitOptions {
        model,
        ..FitOptions::default()
    };
    if input.drive.moves() {
        let reason = "its voltage moves all the time; it is fitted by itself".to_owned();
        return Err(FitError::OutsideGroup { reason });
    }
    let cleaned = Cleaned::of(input);
    let readings = Readings::new(&cleaned.input(input))?;
    readings.check(input, &own)?;
    let found = readings.current.as_ref().map(Sampled::after_step);
    let needed = needed(model);
    let reason = match found {
        None => "it has no current channel, from which the electrical parameters start".to_owned(),
        Some(found) if found < needed => {
            format!("its current has {found} usable readings after the step, {needed} are needed")
        }
        Some(_) => return Ok(()),
    };
    Err(FitError::OutsideGroup { reason })
}

/// Fits every run by itself and weighs what sharing costs.
fn weigh_sharing(problem: &JointProblem, starts: &[Start], judged: &mut JudgedGroup) -> Sharing {
    let (mut square, mut parameters, mut misfit) = (0.0, 0, 1.0_f64);
    for (run, start) in problem.runs.iter().zip(starts) {
        let (own, bottom, evaluations) = search(vec![run.clone()], std::slice::from_ref(start), &[]);
        square += own.square(&bottom.at);
        parameters += own.bounds.count();
        judged.evaluations += evaluations;
        misfit = misfit.max(excess(&own, &bottom).powi(2));
    }
    let shared = problem.square(&judged.bottom.at);
    let parameters_saved = parameters.saturating_sub(judged.bottom.at.len());
    // A group's place is one that its runs may take: what falls below is what the searches leave.
    let chi_square_rise = (shared - square).max(0.0);
    Sharing {
        chi_square_rise,
        parameters_saved,
        // Where the model leaves more than noise by itself, sharing must cost more than that to mean something.
        p: chi_square_chance(chi_square_rise / misfit, parameters_saved),
    }
}

/// Local places of the shared keys.
fn shared_places(options: &GroupOptions) -> Result<Vec<usize>, FitError> {
    let layout = Layout {
        branches: options.model.branches,
    };
    let known = shareable(options.model);
    let place = |key: &String| {
        let feature = known
            .contains(&key.as_str())
            .then(|| Feature::of_key(key, layout.branches))
            .flatten();
        let local = feature.and_then(|feature| feature.place(layout));
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
    let identified = identify(input, &own, readings, None);
    readings_and_start(input, options.model, &identified)
        .map_err(|reason| FitError::GroupRun { index, reason })
}

/// Readings of a run with their noise, and where what was `identified` of it puts it.
fn readings_and_start<'a>(
    input: &FitInput<'a>,
    model: &FitModel,
    identified: &Identified,
) -> Result<(RunReadings<'a>, Start), String> {
    let (current, electrical) = identified.current.as_ref().map_err(String::clone)?;
    let mut start = Start::of(electrical, model.branches);
    if let Ok((_, bending)) = &identified.curvature {
        start = start.with_bending(bending);
    }
    let run = RunReadings {
        drive: input.drive,
        area_cm2: input.area_cm2,
        current: Some(Response::new(current.clone())),
        curvature: identified
            .curvature
            .as_ref()
            .ok()
            .map(|(own, _)| Response::new(own.clone())),
    };
    Ok((run, start))
}

fn assemble(
    inputs: &[FitInput],
    options: &GroupOptions,
    problem: &JointProblem,
    judged: JudgedGroup,
) -> GroupFit {
    let readings: usize = problem.runs.iter().map(RunReadings::len).sum();
    let stop = judged.bottom.stop;
    let mut runs = Vec::with_capacity(inputs.len());
    for (run, input) in inputs.iter().enumerate() {
        let local = problem.of_run(run, &judged.bottom.at);
        let fitted = problem.runs[run].fitted(&problem.model(&local), problem.offsets(&local));
        let features = judged.features.get(run).map_or(&[][..], Vec::as_slice);
        let parameters = outcome::joint_parameters(options.model, features, input.drive);
        runs.push(outcome::joint_fit(
            input,
            options.model,
            &problem.runs[run],
            fitted,
            (parameters, problem.zeros(run, &judged.bottom)),
            (stop, judged.evaluations),
        ));
    }
    GroupFit {
        shared: options.shared.clone(),
        chi_square: problem.square(&judged.bottom.at),
        degrees_of_freedom: readings as f64 - judged.bottom.at.len() as f64,
        sharing: None,
        bootstrap: judged.resampled,
        converged: stop.converged(),
        why_stopped: stop.words().to_owned(),
        evaluations: judged.evaluations,
        runs,
    }
}

impl GroupFit {
    /// Parameters that are the same in every run: the shared ones, and what follows from them alone.
    pub fn common_parameters(&self, model: &FitModel) -> Vec<&Parameter> {
        let is_shared = |key: &str| self.shared.iter().any(|shared| shared == key);
        let branches_are_shared = model
            .parameters
            .iter()
            .filter(|of| !of.derived && (of.key.starts_with('r') || of.key.starts_with('c')))
            .filter(|of| of.key != "rss_ohm_cm2")
            .all(|of| is_shared(of.key));
        let common = |of: &&ParameterDescription| is_shared(of.key) || of.derived && branches_are_shared;
        let best = |of: &ParameterDescription| {
            // A run without curvature tells nothing of what others do.
            let found = || {
                self.runs
                    .iter()
                    .flat_map(|fit| &fit.parameters)
                    .filter(|p| p.key == of.key)
            };
            found()
                .find(|p| p.estimate.value.is_some())
                .or_else(|| found().next())
        };
        model.parameters.iter().filter(common).filter_map(best).collect()
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
