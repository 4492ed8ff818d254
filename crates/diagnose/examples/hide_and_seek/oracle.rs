//! The ceiling: who knows the noise and the base parameters, sees to first order, and has the hidden effect's exact
//! trace in the list.

use ieap_diagnose::{base_columns, in_units_of_noise};
use ieap_model::effects::{ALL, Applied};
use ieap_model::extended::Responses;
use rand_distr::{Distribution, StandardNormal};

use crate::case::{Case, responses};
use crate::hidden::scale;

/// An effect is named where the next other one gains less by so much.
const WORSE: f64 = 6.0;
/// Part of a probe's strength at which its trace is taken.
const SMALL: f64 = 0.1;
/// Groups in which nothing is hidden, from which the limit of a gain follows.
const NULLS: usize = 200;

/// What the oracle says of a group.
pub struct Said {
    pub seen: bool,
    /// Whether it is seen by the ratio of likelihoods over all effects and their forms, each at its best strength.
    pub seen_by_all: bool,
    /// Effects that gain as much as the best to within the margin.
    pub set: Vec<&'static str>,
    /// By how much the best effect gains more than the best other one.
    pub margin: f64,
}

/// A trace after the refit, of unit length.
struct Trace {
    id: &'static str,
    unit: Vec<f64>,
    one_sided: bool,
}

/// Asks for `hidden`, of which `with` is what it leaves in the readings without noise.
pub fn oracle(case: &mut Case, hidden: &Applied, with: &[Responses]) -> Said {
    let basis = basis(case);
    let plain = in_units_of_noise(&responses(case, &[]), case.noise);
    let mut traces = traces(case, &plain, &basis);
    let mut truth: Vec<f64> = in_units_of_noise(with, case.noise)
        .iter()
        .zip(&plain)
        .map(|(with, plain)| with - plain)
        .collect();
    remove(&basis, &mut truth);
    traces.extend(trace(hidden.effect.about().id, truth.clone(), false));
    let mut noisy = |signal: &[f64]| -> Vec<f64> {
        let each = signal.iter().map(|v| {
            let fresh: f64 = StandardNormal.sample(&mut case.generator);
            v + fresh
        });
        each.collect()
    };
    let readings = noisy(&truth);
    let nothing = vec![0.0; truth.len()];
    let nulls: Vec<Vec<f64>> = (0..NULLS).map(|_| gains(&traces, &noisy(&nothing))).collect();
    let limit = |of: &dyn Fn(&[f64]) -> f64| {
        let mut each: Vec<f64> = nulls.iter().map(|gains| of(gains)).collect();
        each.sort_by(f64::total_cmp);
        each[NULLS * 95 / 100]
    };
    let shares = shares(&traces);
    let by_all = |gains: &[f64]| log_ratio(&shares, gains);
    let own = gains(&traces, &readings);
    let most = largest(&own);
    let mut set: Vec<&'static str> = traces
        .iter()
        .filter(|trace| gain(trace, &readings) > most - WORSE)
        .map(|trace| trace.id)
        .collect();
    set.sort_unstable();
    set.dedup();
    let seen = most > limit(&largest);
    let seen_by_all = by_all(&own) > limit(&by_all);
    let first = traces.iter().find(|trace| gain(trace, &readings) >= most);
    let others = traces
        .iter()
        .filter(|trace| first.is_some_and(|first| first.id != trace.id));
    let next = others.map(|trace| gain(trace, &readings)).fold(0.0, f64::max);
    Said {
        margin: most - next,
        seen,
        seen_by_all,
        set: if seen { set } else { Vec::new() },
    }
}

fn traces(case: &Case, plain: &[f64], basis: &[Vec<f64>]) -> Vec<Trace> {
    let scale = scale(case);
    let mut traces = Vec::new();
    for &effect in ALL {
        for variant in 0..effect.about().variants.len().max(1) {
            let search = effect.search(variant, &scale);
            // An effect that cannot act in these runs has neither limits nor probes.
            let Some(&strength) = search.limits.first() else {
                continue;
            };
            let absent = search.absent;
            for probe in search.probes {
                let one_sided = strength.held
                    || if probe[0] > absent {
                        strength.low >= absent
                    } else {
                        strength.high <= absent
                    };
                let mut parameters = probe;
                parameters[0] *= if absent == 0.0 { SMALL } else { 1.0 };
                let applied = Applied {
                    effect,
                    variant,
                    parameters,
                };
                let with = in_units_of_noise(&responses(case, &[applied]), case.noise);
                let mut change: Vec<f64> = with.iter().zip(plain).map(|(w, p)| w - p).collect();
                remove(basis, &mut change);
                traces.extend(trace(effect.about().id, change, one_sided));
            }
        }
    }
    traces
}

fn trace(id: &'static str, mut unit: Vec<f64>, one_sided: bool) -> Option<Trace> {
    let norm = dot(&unit, &unit).sqrt();
    (norm > 1e-6).then(|| {
        unit.iter_mut().for_each(|v| *v /= norm);
        Trace { id, unit, one_sided }
    })
}

fn gain(trace: &Trace, readings: &[f64]) -> f64 {
    let z = dot(&trace.unit, readings);
    if z > 0.0 || !trace.one_sided { z * z } else { 0.0 }
}

fn gains(traces: &[Trace], readings: &[f64]) -> Vec<f64> {
    traces.iter().map(|trace| gain(trace, readings)).collect()
}

fn largest(gains: &[f64]) -> f64 {
    gains.iter().copied().fold(0.0, f64::max)
}

/// Share of every trace where all effects are as likely, and all forms of each.
fn shares(traces: &[Trace]) -> Vec<f64> {
    let forms = |id: &str| traces.iter().filter(|other| other.id == id).count() as f64;
    let mut ids: Vec<&str> = traces.iter().map(|trace| trace.id).collect();
    ids.sort_unstable();
    ids.dedup();
    let share = |trace: &Trace| (forms(trace.id) * ids.len() as f64).recip();
    traces.iter().map(share).collect()
}

/// Logarithm of the mean likelihood of the traces over that of none, each of unknown length.
fn log_ratio(shares: &[f64], gains: &[f64]) -> f64 {
    let most = largest(gains);
    let parts = shares
        .iter()
        .zip(gains)
        .map(|(share, gain)| share * (0.5 * (gain - most)).exp());
    0.5 * most + parts.sum::<f64>().ln()
}

/// An orthonormal basis of what a refit of the base parameters takes up.
pub fn basis(case: &Case) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut column in base_columns(&case.base, &case.design, case.noise) {
        remove(&basis, &mut column);
        remove(&basis, &mut column);
        let norm = dot(&column, &column).sqrt();
        column.iter_mut().for_each(|v| *v /= norm);
        basis.push(column);
    }
    basis
}

pub fn remove(basis: &[Vec<f64>], series: &mut [f64]) {
    for direction in basis {
        let part = dot(direction, series);
        for (value, d) in series.iter_mut().zip(direction) {
            *value -= part * d;
        }
    }
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
