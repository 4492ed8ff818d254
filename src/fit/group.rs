//! Fits of several runs at once: parameters that all runs share, others free in every run.

use crate::domain::{Fit, Issue, Parameter};
use crate::model::FitModel;
use crate::numerics::levenberg::Stop;
use crate::numerics::student::quantile_95;

use super::joint::bootstrap::{replicate, spread};
use super::joint::dense::{Bottom, descend};
use super::joint::feature::Feature;
use super::joint::minimum::excess;
use super::joint::problem::{Layout, Over, Problem};
use super::joint::profile::{Deeper, Interval, Solved};
use super::joint::readings::RunReadings;
use super::joint::single::{REACH, partner, reach};
use super::joint::start::{Start, problem};
use super::outcome;
use super::{FitError, FitInput, FitOptions, Readings, identify, needed};

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

/// Part of a logarithm, or of a coupling, beyond which an interval is looked at by profile.
const NARROW: f64 = 0.1;
/// Evaluations over the condensed readings and over all of them.
const LIMIT: u64 = 150;
const POLISH_LIMIT: u64 = 12;
/// Starts that are tried.
const STARTS: usize = 4;
const RESTARTS: usize = 3;

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

/// The deepest minimum over the condensed readings, polished over all of them.
fn search<'a>(runs: Vec<RunReadings<'a>>, starts: &[Start], shared: &[usize]) -> (Problem<'a>, Bottom, u64) {
    let (problem, first) = problem(runs, starts, shared);
    let mut evaluations = 0;
    let mut best: Option<Bottom> = None;
    for at in start_places(&problem, starts, first).iter().take(STARTS) {
        let found = problem.descend(at, LIMIT, 1e-4);
        evaluations += found.evaluations;
        if best
            .as_ref()
            .is_none_or(|best| found.slope.square < best.slope.square)
        {
            best = Some(found);
        }
    }
    let at = best.map(|best| best.at).unwrap_or_default();
    let mut bottom = descend(&at, &problem.low, &problem.high, POLISH_LIMIT, 1e-6, |at| {
        problem.slope(at, Over::Whole)
    });
    evaluations += bottom.evaluations;
    if bottom.stop == Stop::EvaluationLimit {
        // What is left is below the accuracy of the condensed search, which converged.
        let further = descend(&bottom.at, &problem.low, &problem.high, LIMIT, 1e-4, |at| {
            problem.slope(at, Over::Whole)
        });
        evaluations += further.evaluations;
        bottom = further;
    }
    (problem, bottom, evaluations)
}

/// Places to start from: the shared parameters as each of the runs has them, and their mean.
fn start_places(problem: &Problem, starts: &[Start], first: Vec<f64>) -> Vec<Vec<f64>> {
    use super::joint::problem::Slot;
    let value = |run: usize, local: usize| starts[run].local[local] / problem.units[local];
    let with = |base: &[f64], run: usize| {
        let mut at = base.to_vec();
        for (local, slot) in problem.slots[run].iter().enumerate() {
            if let Slot::Searched(k) = *slot {
                at[k] = value(run, local);
            }
        }
        at
    };
    let places: Vec<Vec<f64>> = (0..starts.len()).map(|run| with(&first, run)).collect();
    let mut sums = vec![(0.0, 0.0); first.len()];
    for (run, slots) in problem.slots.iter().enumerate() {
        for (local, slot) in slots.iter().enumerate() {
            if let Slot::Searched(k) = *slot
                && starts[run].searched[local]
            {
                sums[k].0 += value(run, local);
                sums[k].1 += 1.0;
            }
        }
    }
    let mean = sums
        .iter()
        .zip(&first)
        .map(|((sum, count), v)| if *count > 0.0 { sum / count } else { *v });
    let mut all = vec![mean.collect::<Vec<f64>>()];
    all.extend(places);
    all.dedup();
    all
}

/// A feature with its interval and, where it was profiled, what it trades off against.
pub(super) type Found = (Feature, Interval, Option<(Feature, f64)>);

/// Intervals of every parameter of every run.
struct JudgedGroup {
    bottom: Bottom,
    features: Vec<Vec<Found>>,
    resampled: Vec<Vec<Resampled>>,
    evaluations: u64,
}

fn features(layout: Layout, problem: &Problem, run: usize) -> Vec<Feature> {
    let mut found = Vec::new();
    for k in 0..layout.branches {
        found.extend([
            Feature::Resistance(k),
            Feature::Capacitance(k),
            Feature::TimeConstant(k),
        ]);
    }
    found.extend([
        Feature::Steady,
        Feature::TotalCapacitance,
        Feature::ParallelResistance,
    ]);
    if problem.runs[run].curvature.is_some() {
        found.extend([Feature::Coupling, Feature::Rate]);
    }
    found
}

fn judge(problem: &Problem, mut bottom: Bottom, options: &GroupOptions, mut evaluations: u64) -> JudgedGroup {
    let mut restarts = 0;
    let features_of = loop {
        match try_intervals(problem, &bottom, options, &mut evaluations) {
            Err(Deeper(at)) if restarts < RESTARTS => {
                restarts += 1;
                bottom = problem.descend(&at, LIMIT, 1e-4);
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
    problem: &Problem,
    bottom: &Bottom,
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
    let condensed = Bottom {
        slope: problem.slope(&bottom.at, Over::Condensed),
        ..bottom.clone()
    };
    let quantile = quantile_95(freedom.max(2.0)) * excess(problem, &condensed);
    let whole = Solved::new(problem, bottom.clone());
    let mut along: Option<Solved> = None;
    let mut found = Vec::with_capacity(problem.runs.len());
    for run in 0..problem.runs.len() {
        let mut own = Vec::new();
        for feature in features(problem.layout, problem, run) {
            let linear = whole.linear(feature, run, quantile);
            let scale = if feature.is_logarithm() {
                1.0
            } else {
                linear.value.abs()
            };
            let narrow = quantile * linear.standard_error <= NARROW * scale;
            if narrow && options.intervals == Intervals::Automatic {
                own.push((feature, linear, None));
                continue;
            }
            let solved =
                along.get_or_insert_with(|| Solved::new(problem, problem.descend(&bottom.at, LIMIT, 1e-5)));
            let reach = if feature.is_logarithm() {
                REACH
            } else {
                reach(solved, feature, run, quantile)
            };
            let interval = solved.profile(feature, run, quantile, reach)?;
            own.push((feature, interval, partner(solved, feature, run)));
        }
        found.push(own);
    }
    *evaluations += along.map_or(0, |solved| solved.evaluations);
    Ok(found)
}

fn resample(problem: &Problem, bottom: &Bottom, bootstrap: Bootstrap) -> Vec<Vec<Resampled>> {
    let own = |run: usize| {
        features(problem.layout, problem, run)
            .into_iter()
            .map(move |feature| (run, feature))
    };
    let wanted: Vec<(usize, Feature)> = (0..problem.runs.len()).flat_map(own).collect();
    let refits = replicate(problem, &bottom.at, &wanted, bootstrap.seed, bootstrap.replicates);
    let mut found: Vec<Vec<Resampled>> = vec![Vec::new(); problem.runs.len()];
    for (column, (run, feature)) in wanted.into_iter().enumerate() {
        let reported = |value: f64| match feature {
            Feature::Steady => value.recip(),
            _ if feature.is_logarithm() => value.exp(),
            _ => value,
        };
        let mut values: Vec<f64> = refits.iter().map(|refit| reported(refit[column])).collect();
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

/// Whether a parameter of a fit is one that its group shares.
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
