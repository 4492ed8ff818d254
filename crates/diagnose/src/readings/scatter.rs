//! Scatter from run to run: parameters that differ between runs of one sample in one condition by nothing but chance.
//!
//! A specimen answers a second step a per cent differently. Where that is more than the noise, one parameter set for all runs
//! leaves a misfit that is no error of the model. So the spread of every parameter is estimated from repeats of one drive, with
//! what they share integrated out, and each run's own deviations are then taken out of its residuals like noise. Runs of different
//! drives say nothing of it: that they differ is an explanation that stands beside others.

use ieap_model::LumpedModel;
use ieap_model::extended::ExtendedModel;
use ieap_numerics::least_squares::Local;
use ieap_numerics::random_effects::{Form, Spread, log_likelihood, most_likely, spreads};
use ieap_numerics::sums::dot;

use crate::levels::{DIFFERENCE_EVIDENCE, SCATTER, SCATTER_EVIDENCE};
use crate::readings::group::RunGroup;
use crate::readings::left_open::LeftOpen;

/// Relative spread that is looked at to see whether there is more.
const BEYOND: f64 = 3.0;
/// Precision with which what the runs share is known before, relative: hardly.
const KNOWN_BEFORE: f64 = 1e-4;
/// Parts of a run's deviations that are tried, until one brings its residuals down.
const PARTS: [f64; 6] = [1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125];
/// Relative step of the slopes.
const STEP: f64 = 1e-4;

/// Scatter that was looked at: relative spreads of the parameters of the base, in the order of [`moved`].
#[derive(Debug, Clone, Default)]
pub(crate) struct Scatter {
    /// The most likely ones, up to where runs differ rather than scatter.
    likely: Vec<f64>,
    /// What is taken as noise; empty where the readings ask for none, or for more than scatter.
    pub(crate) taken: Vec<f64>,
}

impl Scatter {
    /// As much as is still scatter, of every parameter: to begin with; none without repeats.
    pub(crate) fn most(group: &RunGroup, model: &ExtendedModel) -> Option<Scatter> {
        let all = vec![SCATTER; parameters(group, &model.base)];
        (!group.repeats().is_empty()).then_some(Scatter {
            likely: all.clone(),
            taken: all,
        })
    }

    /// Found in the readings beside `model`.
    pub(crate) fn found(group: &RunGroup, model: &ExtendedModel) -> Scatter {
        let forms = of_repeats(group, model);
        let (taken, gain) = most_likely(&forms, KNOWN_BEFORE, SCATTER);
        let (likely, _) = most_likely(&forms, KNOWN_BEFORE, BEYOND);
        let log_likelihood = |spreads: &[f64]| log_likelihood(&forms, KNOWN_BEFORE, spreads);
        let is_beyond = |k: usize| {
            let mut within = likely.clone();
            within[k] = SCATTER;
            likely[k] > SCATTER && log_likelihood(&likely) > log_likelihood(&within) + DIFFERENCE_EVIDENCE
        };
        let is_noise = gain >= SCATTER_EVIDENCE && !(0..likely.len()).any(is_beyond);
        Scatter {
            likely,
            taken: if is_noise { taken } else { Vec::new() },
        }
    }

    /// The model of each run: that of the group with the run's own deviations, as far as they bring its residuals down. What is
    /// said of small deviations may be far off for large ones.
    pub(crate) fn own_models(&self, group: &RunGroup, model: &ExtendedModel) -> Vec<ExtendedModel> {
        let of_run = |(run, form): (usize, &Form)| {
            let deviations = form.deviations(&self.likely);
            let with = |part: f64| {
                let each = deviations.iter().enumerate();
                ExtendedModel {
                    base: each.fold(model.base.clone(), |base, (k, by)| moved(&base, k, part * by)),
                    effects: model.effects.clone(),
                }
            };
            let square = |model: &ExtendedModel| {
                let rows = rows(group, model, run);
                dot(&rows, &rows)
            };
            let before = square(model);
            let tried = PARTS.iter().map(|part| with(*part));
            let mut better = tried.filter(|own| square(own) <= before);
            better.next().unwrap_or_else(|| model.clone())
        };
        forms(group, model).iter().enumerate().map(of_run).collect()
    }
}

/// The spread of every parameter beside `model` with its interval, up to where runs differ rather than scatter.
pub(crate) fn told(group: &RunGroup, model: &ExtendedModel) -> Vec<Spread> {
    spreads(&of_repeats(group, model), KNOWN_BEFORE, BEYOND)
}

/// What the runs of each repeated drive say of their own parameters.
fn of_repeats(group: &RunGroup, model: &ExtendedModel) -> Vec<Vec<Form>> {
    let of_run = |run: &usize| form(group, model, *run);
    let each = group.repeats().into_iter();
    each.map(|runs| runs.iter().map(of_run).collect()).collect()
}

/// What every run says of its own parameters, as deviations from those of `model`.
fn forms(group: &RunGroup, model: &ExtendedModel) -> Vec<Form> {
    (0..group.runs.len()).map(|run| form(group, model, run)).collect()
}

fn form(group: &RunGroup, model: &ExtendedModel, run: usize) -> Form {
    let here = rows(group, model, run);
    let columns: Vec<Vec<f64>> = (0..parameters(group, &model.base))
        .map(|k| change(group, model, run, k, STEP, &here))
        .collect();
    let of_readings: Vec<Vec<f64>> = columns
        .iter()
        .map(|column| column.iter().map(|change| -change / STEP).collect())
        .collect();
    let none = vec![0.0; columns.len()];
    Form::of(&none, &Local::of(&here, &of_readings))
}

/// What runs with that scatter leave open.
pub(crate) fn left_open(group: &RunGroup, model: &ExtendedModel, run: usize, scatter: &Scatter) -> LeftOpen {
    let here = rows(group, model, run);
    let each = scatter
        .taken
        .iter()
        .enumerate()
        .filter(|(_, spread)| **spread > 0.0);
    LeftOpen::of(each.map(|(k, spread)| {
        let step = change(group, model, run, k, STEP, &here);
        step.into_iter().map(|change| spread / STEP * change).collect()
    }))
}

/// Change of the whitened rows of a run where parameter `k` is larger by that part.
fn change(group: &RunGroup, model: &ExtendedModel, run: usize, k: usize, by: f64, here: &[f64]) -> Vec<f64> {
    let there = ExtendedModel {
        base: moved(&model.base, k, by),
        effects: model.effects.clone(),
    };
    let mut rows = rows(group, &there, run);
    rows.iter_mut().zip(here).for_each(|(row, here)| *row -= here);
    rows
}

/// Whitened residuals of a run, with what is open of its zeros and edges taken out.
fn rows(group: &RunGroup, model: &ExtendedModel, run: usize) -> Vec<f64> {
    let own = &group.runs[run];
    let mut rows = Vec::new();
    own.whitened(&own.fitted(model, &own.context(run, None)), &mut rows);
    own.take_out_of_readings(&mut rows);
    rows
}

fn parameters(group: &RunGroup, base: &LumpedModel) -> usize {
    2 * base.branches.len() + if group.bends() { 3 } else { 1 }
}

/// The model with parameter `k` larger by that part: resistances, capacitances, conductance at rest, alpha, lambda.
fn moved(model: &LumpedModel, k: usize, by: f64) -> LumpedModel {
    let (mut moved, n) = (model.clone(), model.branches.len());
    match k {
        k if k < n => moved.branches[k].resistance_ohm_cm2 *= by.exp(),
        k if k < 2 * n => moved.branches[k - n].capacitance_f_per_cm2 *= by.exp(),
        k if k == 2 * n => moved.steady_state_resistance_ohm_cm2 /= 1.0 + by,
        k if k == 2 * n + 1 => moved.charge_to_curvature_per_c_cm *= 1.0 + by,
        _ => moved.relaxation_rate_per_s *= 1.0 + by,
    }
    moved
}
