//! What every weight of every law adds to the readings, to first order.

use ieap_domain::range_of;
use ieap_model::effects::smooth_laws::{SMOOTH_LAWS, SmoothLaw, WEIGHTS};
use ieap_model::effects::{Applied, Effect, Limits, Scale};
use ieap_model::extended::ExtendedModel;
use ieap_numerics::sums::dot;
use rayon::prelude::*;

use super::policy::ALIKE;
use crate::fitting::problem::{ExtendedProblem, FreeEffect};

/// Part of the probe's weight at which a column is taken.
const SMALL: f64 = 0.1;

/// A law in these data, with the change of the whitened model by each of its weights.
pub(crate) struct LawColumns {
    pub(crate) law: &'static SmoothLaw,
    pub(crate) limits: Vec<Limits>,
    /// A weight each, then what is held.
    pub(crate) probe: Vec<f64>,
    /// Per unit of each weight.
    pub(crate) columns: Vec<Vec<f64>>,
}

impl LawColumns {
    /// The law as something to search.
    pub(crate) fn free_effect(&self) -> FreeEffect {
        FreeEffect::new(self.law, 0, self.limits.clone(), &self.probe)
    }

    /// Coordinate per unit of weight.
    pub(crate) fn coordinate(&self) -> f64 {
        self.free_effect().coordinate(0, 1.0)
    }
}

/// The columns of all laws beside a model, but for those that it has. Laws that are one function on the group's drives are one:
/// under voltages of one sign, of the voltage and of its size; under one edge a run, of the time and of that since an edge; where
/// the voltage never falls, of it and of the largest so far.
pub(crate) fn columns(problem: &ExtendedProblem, at: &[f64], scale: &Scale) -> Vec<LawColumns> {
    let has = |law: &SmoothLaw| {
        problem
            .effects
            .iter()
            .any(|own| own.effect.about().id == law.about().id)
    };
    let levels = problem.group.runs.iter().flat_map(|run| run.drive().levels());
    let (low, high) = range_of(levels.filter_map(|(_, volts)| volts));
    let mut drives = problem.group.runs.iter().map(|run| run.drive());
    let are_steps = drives.all(|drive| drive.segments.len() < 2 || drive.moves());
    let is_one = |law: &SmoothLaw| {
        let is_told_by_another = are_steps && law.needs_edges();
        is_told_by_another || low * high >= 0.0 && !law.needs_edges() && law.is_by_size_among(&SMOOTH_LAWS)
    };
    let all = SMOOTH_LAWS.iter().copied();
    let laws: Vec<&'static SmoothLaw> = all.filter(|law| !has(law) && !is_one(law)).collect();
    let mut found = columns_of(&laws, problem, at, scale);
    let is_other = |own: &LawColumns, other: &LawColumns| {
        own.law.is_by_size_among(&[other.law]) && are_alike(&own.columns, &other.columns)
    };
    let twins: Vec<bool> = (found.iter())
        .map(|own| own.law.needs_edges() && found.iter().any(|other| is_other(own, other)))
        .collect();
    let mut twins = twins.into_iter();
    found.retain(|_| !twins.next().unwrap_or(false));
    found
}

/// Whether no reading tells two laws apart: what differs is the rounding of steps.
fn are_alike(own: &[Vec<f64>], other: &[Vec<f64>]) -> bool {
    let apart = |own: &[f64], other: &[f64]| own.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let of = |pair: (&Vec<f64>, &Vec<f64>)| (apart(pair.0, pair.1), dot(pair.1, pair.1));
    let (apart, whole) = own
        .iter()
        .zip(other)
        .map(of)
        .fold((0.0, 0.0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
    apart <= ALIKE * whole
}

/// The columns of these laws.
pub(crate) fn columns_of(
    laws: &[&'static SmoothLaw],
    problem: &ExtendedProblem,
    at: &[f64],
    scale: &Scale,
) -> Vec<LawColumns> {
    let model = problem.model(at);
    let mut without = Vec::new();
    problem.residuals(at, &mut without);
    let wanted: Vec<(&'static SmoothLaw, Vec<Limits>, Vec<f64>)> = (laws.iter())
        .filter_map(|&law| {
            let search = law.search(0, scale);
            let probe = search.probes.into_iter().next()?;
            Some((law, search.limits, probe))
        })
        .collect();
    let of = |(law, limits, probe): (&'static SmoothLaw, Vec<Limits>, Vec<f64>)| {
        let column = |k: usize| {
            let mut parameters = probe.clone();
            parameters[..WEIGHTS].fill(0.0);
            parameters[k] = SMALL * probe[k];
            let with = residuals_with(problem, &model, law, parameters);
            let change = without.iter().zip(&with).map(|(without, with)| without - with);
            change
                .map(|change| change / (SMALL * probe[k]))
                .collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = (0..law.weights()).map(column).collect();
        let is_finite = columns.iter().all(|column| dot(column, column).is_finite());
        is_finite.then_some(LawColumns {
            law,
            limits,
            probe,
            columns,
        })
    };
    wanted.into_par_iter().filter_map(of).collect()
}

fn residuals_with(
    problem: &ExtendedProblem,
    model: &ExtendedModel,
    law: &'static SmoothLaw,
    parameters: Vec<f64>,
) -> Vec<f64> {
    let mut effects = model.effects.clone();
    effects.push(Applied {
        effect: law,
        variant: 0,
        parameters,
    });
    let extended = ExtendedModel {
        base: model.base.clone(),
        effects,
    };
    let mut out = Vec::new();
    for &run in &problem.runs {
        problem.run_residuals(&extended, run, &mut out);
    }
    out
}
