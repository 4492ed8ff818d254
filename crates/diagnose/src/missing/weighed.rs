//! Everything that may be behind a misfit, weighed: laws as smooth curves, equations, runs that differ. Slow noise stands beside
//! them and is no rival.

use std::collections::BTreeMap;

use ieap_model::FitModel;
use ieap_model::effects::Scale;
use ieap_model::effects::smooth_laws::{Place, SmoothLaw, Textbook};
use ieap_model::effects::{place_of_form, textbooks_of};
use rayon::prelude::*;

use super::columns::{LawColumns, columns_of};
use super::evidence::{evidence, process};
use super::policy::{
    DIFFERS, FITTED_TOGETHER, INEXACT, MOST_FITTED, NEAR_BESIDE, NEAR_PART, OF_CURVES, SLOW, SURE, UNFITTED,
    UNNAMED,
};
use super::simple::{Top, simple};
use super::unnamed::{Unnamed, unnamed};
use crate::cause::candidates::{CandidateFit, fit_candidates};
use crate::cause::evidence::{Process, Varying, log_evidence, log_sum, slow_noise};
use crate::fitting::fitted::Fitted;
use crate::fitting::tangent::Tangent;
use crate::misfit::signature::{Direction, Signature};
use crate::options::AbsentLaw;
use crate::readings::group::RunGroup;

/// What a hypothesis says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Says {
    /// A law is a smooth function: place among the columns.
    Curve(usize),
    /// It is one of textbooks that has no name.
    Textbook(usize),
    /// An equation of the library.
    Equation(&'static str),
    /// Parameters differ between runs.
    Differ,
    /// Something at its site that is none of the laws.
    Unnamed,
}

/// A hypothesis with its weight, logarithms over that of the base alone.
#[derive(Clone)]
pub(crate) struct Weight<'g> {
    pub(crate) says: Says,
    pub(crate) place: Option<Place>,
    /// What the likelihood gains.
    pub(crate) fall: f64,
    /// Logarithm of the prior weight.
    pub(crate) prior: f64,
    /// What the widths of priors and peaks cost (Occam's factor).
    pub(crate) occam: f64,
    /// Parameters that it adds, or as many as the readings determine of them.
    pub(crate) free: f64,
    /// The model in full, where it was fitted.
    pub(crate) fitted: Option<Fitted<'g>>,
    /// What is no model but random functions: they are asked again in a likelihood that is broader.
    pub(crate) random: Option<Unnamed>,
}

impl Weight<'_> {
    /// Its logarithm where falls are divided by `t`: a likelihood that is so much broader leaves less to pay for widths.
    fn log(&self, t: f64) -> f64 {
        let of_fit = || self.fall / t + (self.occam + 0.5 * self.free * t.ln()).min(0.0);
        let all = self.prior + self.random.as_ref().map_or_else(of_fit, |random| random.log(t));
        if all.is_nan() { f64::NEG_INFINITY } else { all }
    }
}

/// All of them.
pub(crate) struct Weighed<'g> {
    pub(crate) all: Vec<Weight<'g>>,
    pub(crate) varying: Option<Varying>,
    /// Probability of slow noise, at rest as under voltage, beside all of them.
    pub(crate) slow_noise: f64,
}

/// What hypotheses are weighed on: beside `current`, which may have laws already.
pub(crate) struct Asked<'a, 'g> {
    pub(crate) group: &'g RunGroup<'g>,
    pub(crate) current: &'a Fitted<'g>,
    pub(crate) residuals: &'a [f64],
    pub(crate) signatures: &'a [Signature],
    pub(crate) directions: &'a [Direction],
    pub(crate) laws: &'a [LawColumns],
    pub(crate) model: &'static FitModel,
    pub(crate) absent: Option<AbsentLaw>,
}

impl<'g> Asked<'_, 'g> {
    pub(crate) fn weigh(&self) -> Weighed<'g> {
        let (slope, tangent) = self.current.tangent();
        let candidates = fit_candidates(self.current, self.residuals, self.signatures, self.directions);
        let mut all = self.equations(&candidates);
        all.extend(self.curves(&all));
        all.retain(|own| {
            !self
                .absent
                .is_some_and(|absent| own.place.is_some_and(|place| absent.is(&place)))
        });
        share_priors(&mut all);
        // Beside a law runs are not asked again whether they differ.
        let is_base = self.current.problem.effects.is_empty();
        let varying = is_base
            .then(|| Varying::of(self.group, self.current, self.model, &slope.normal))
            .flatten();
        if let Some(varying) = &varying {
            let logs: Vec<f64> = varying.weighed(self.current).map(|(_, log)| log).collect();
            let log = log_sum(&logs) - varying.prior().ln();
            let fall = 0.5 * (self.current.penalised() - varying.square());
            all.push(Weight {
                says: Says::Differ,
                place: None,
                fall,
                prior: DIFFERS.ln(),
                occam: log - fall,
                free: varying.free() as f64,
                fitted: None,
                random: None,
            });
        }
        let slow = slow_noise(self.group, &tangent, self.residuals);
        let logs: Vec<f64> = all.iter().map(|own| own.log(1.0)).collect();
        let rest = log_sum(&logs);
        let slow = slow.fall + slow.occam.min(0.0) + SLOW.ln();
        all.extend(self.unnamed(&tangent));
        Weighed {
            all,
            varying,
            slow_noise: (1.0 + (rest - slow).exp()).recip(),
        }
    }

    /// What follows the drive and is no law of the list.
    fn unnamed(&self, tangent: &Tangent) -> Vec<Weight<'g>> {
        let found = unnamed(
            self.group,
            &self.current.base(),
            self.laws,
            tangent,
            self.residuals,
        );
        let prior = (UNNAMED / found.len().max(1) as f64).ln();
        let weight = |own: Unnamed| Weight {
            says: Says::Unnamed,
            place: Some(Place {
                site: own.site,
                law: "",
                of: "",
                variable: "",
            }),
            fall: own.fall(),
            prior,
            occam: 0.0,
            free: 0.0,
            fitted: None,
            random: Some(own),
        };
        found.into_iter().map(weight).collect()
    }

    /// Every law as a smooth function, fitted in full until one that was leads; and as a curve of textbooks that is none of the
    /// `equations`.
    fn curves(&self, equations: &[Weight]) -> Vec<Weight<'g>> {
        let (_, tangent) = self.current.tangent();
        let of = |k: usize| Curve::of(k, &self.laws[k], &tangent, self.residuals);
        let mut found: Vec<Curve> = (0..self.laws.len()).into_par_iter().filter_map(of).collect();
        found.sort_by(|a, b| b.weight.log(1.0).total_cmp(&a.weight.log(1.0)));
        let (_, base_columns) = self.current.problem.slope(&self.current.at);
        let fit = |own: &Curve<'g>| {
            let law = &self.laws[own.law];
            let fitted = refit(self.current, law, &own.precisions, &own.weights, &base_columns)?;
            let fall = 0.5 * (self.current.penalised() - fitted.penalised());
            Some((fall, fitted))
        };
        // What the first order promises is believed as far as it was kept where it was tried.
        let mut kept: f64 = 1.0;
        let mut tried = 0;
        while tried < found.len().min(MOST_FITTED) {
            let best = found
                .iter()
                .take(tried)
                .map(|own| own.weight.log(1.0))
                .fold(0.0, f64::max);
            let is_near = |own: &Weight| {
                let log = kept * own.fall + own.occam;
                log > (1.0 - NEAR_PART) * best - NEAR_BESIDE
            };
            let next = found[tried..]
                .iter()
                .take(FITTED_TOGETHER)
                .take_while(|own| is_near(&own.weight));
            let count = next.count().min(MOST_FITTED - tried);
            if count == 0 {
                break;
            }
            let batch: Vec<_> = found[tried..tried + count].par_iter().map(fit).collect();
            let (mut promised, mut brought) = (0.0, 0.0);
            for (own, fitted) in found[tried..].iter_mut().zip(batch) {
                let Some((fall, fitted)) = fitted else { continue };
                promised += own.weight.fall;
                brought += fall.clamp(0.0, own.weight.fall);
                own.put(fall, fitted, &self.laws[own.law]);
            }
            kept = kept.min(if promised > 0.0 { brought / promised } else { 1.0 });
            tried += count;
        }
        let simple: Vec<Weight> = (found.iter())
            .filter_map(|own| own.simple(&self.laws[own.law], equations))
            .collect();
        let mut all: Vec<Weight> = found.into_iter().map(|own| own.weight).chain(simple).collect();
        let untried = all.iter_mut().filter(|own| own.fitted.is_none());
        untried.for_each(|own| own.fall *= kept);
        all
    }

    /// Every equation of the library: those that promise most were fitted in full.
    fn equations(&self, candidates: &[CandidateFit<'g>]) -> Vec<Weight<'g>> {
        let forecast = |own: &CandidateFit<'g>| 0.5 * own.forecast;
        let pairs = candidates.iter().filter_map(|own| {
            let (fall, _) = log_evidence(self.current, own.fitted.as_ref()?);
            Some((forecast(own), fall.clamp(0.0, forecast(own))))
        });
        let (promised, brought) = pairs.fold((0.0, 0.0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
        let kept = if promised > 0.0 { brought / promised } else { 1.0 };
        let of = |candidate: &CandidateFit<'g>| {
            let place = place_of_form(candidate.effect, candidate.variant)?;
            let (fall, occam) = match &candidate.fitted {
                Some(fitted) => log_evidence(self.current, fitted),
                None => (kept * forecast(candidate), -0.5 * candidate.forms - UNFITTED),
            };
            Some(Weight {
                says: Says::Equation(candidate.effect),
                place: Some(place),
                fall,
                prior: 0.0,
                occam,
                free: candidate.extra as f64,
                fitted: candidate.fitted.clone(),
                random: None,
            })
        };
        candidates.par_iter().filter_map(of).collect()
    }
}

/// A law as a smooth function, about its top.
struct Curve<'g> {
    weight: Weight<'g>,
    /// Place among the columns.
    law: usize,
    process: Process,
    precisions: Vec<f64>,
    weights: Vec<f64>,
}

impl<'g> Curve<'g> {
    /// To first order; none where a refit takes up everything.
    fn of(k: usize, law: &LawColumns, tangent: &Tangent, residuals: &[f64]) -> Option<Curve<'g>> {
        let process = process(&law.columns, tangent, residuals);
        let evidence = evidence(&process)?;
        let (weights, first) = process.most_probable(&evidence.precisions);
        let weight = Weight {
            says: Says::Curve(k),
            place: Some(law.law.place),
            fall: 0.5 * first,
            prior: 0.0,
            occam: evidence.log - 0.5 * first,
            free: law.law.weights() as f64,
            fitted: None,
            random: None,
        };
        Some(Curve {
            weight,
            law: k,
            process,
            precisions: evidence.precisions,
            weights,
        })
    }

    /// Puts it where it was fitted.
    fn put(&mut self, fall: f64, fitted: Fitted<'g>, law: &LawColumns) {
        let own = &fitted.at[fitted.at.len() - law.law.weights()..];
        self.weights = own.iter().map(|at| at / law.coordinate()).collect();
        (self.weight.fall, self.weight.fitted) = (fall, Some(fitted));
    }

    /// The law as a curve of textbooks that is none of the `equations` at its place.
    fn simple(&self, law: &LawColumns, equations: &[Weight]) -> Option<Weight<'g>> {
        let named: Vec<Textbook> = (equations.iter())
            .filter(|own| own.place == self.weight.place)
            .filter_map(|own| match own.says {
                Says::Equation(id) => Some(textbooks_of(id)),
                _ => None,
            })
            .flatten()
            .copied()
            .collect();
        let top = Top {
            weights: &self.weights,
            precisions: &self.precisions,
            fall: self.weight.fall,
        };
        let parts = simple(&self.process, &top, &law.law.simple(&law.probe, &named))?;
        Some(Weight {
            says: Says::Textbook(self.law),
            fall: parts.fall,
            occam: parts.occam,
            free: parts.free as f64,
            ..self.weight.clone()
        })
    }
}

/// Base and law together from what the first order says, or from the base where that is better.
fn refit<'g>(
    current: &Fitted<'g>,
    law: &LawColumns,
    precisions: &[f64],
    weights: &[f64],
    base_columns: &[Vec<f64>],
) -> Option<Fitted<'g>> {
    let unit = law.coordinate();
    let known = precisions.iter().map(|own| own / (unit * unit)).collect();
    let problem = current.problem.with(law.free_effect().known_to(known));
    // Derivatives of residuals: what the model gains is taken from them.
    let own = law.columns.iter().map(|column| {
        let each = column.iter();
        each.map(|v| -v / unit).collect::<Vec<f64>>()
    });
    let columns: Vec<Vec<f64>> = base_columns.iter().cloned().chain(own).collect();
    let start = |part: f64| {
        let mut start = current.at.clone();
        start.extend(weights.iter().map(|weight| part * weight * unit));
        start
    };
    let best = [1.0, 0.3, 0.0]
        .map(start)
        .into_iter()
        .map(|start| (problem.square(&start) + problem.penalty(&start), start))
        .filter(|(square, _)| square.is_finite())
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    Fitted::along(problem, &best.1, &columns)
}

/// A model with one more law at its most probable place; none where the law does not act or a refit takes it up.
pub(crate) fn with_law<'g>(
    current: &Fitted<'g>,
    law: &'static SmoothLaw,
    scale: &Scale,
) -> Option<Fitted<'g>> {
    let own = columns_of(&[law], &current.problem, &current.at, scale).pop()?;
    let (_, base_columns) = current.problem.slope(&current.at);
    let process = process(&own.columns, &Tangent::of(&base_columns), &current.residuals());
    let precisions = evidence(&process)?.precisions;
    let (weights, _) = process.most_probable(&precisions);
    refit(current, &own, &precisions, &weights, &base_columns)
}

/// Gives every law and variable the same weight, its curves a part of it and its equations the rest.
fn share_priors(all: &mut [Weight]) {
    let mut counts: BTreeMap<Place, [usize; 2]> = BTreeMap::new();
    let is_curve = |own: &Weight| matches!(own.says, Says::Curve(_) | Says::Textbook(_));
    for own in all.iter() {
        if let Some(place) = own.place {
            counts.entry(place).or_default()[usize::from(is_curve(own))] += 1;
        }
    }
    let places = counts.len() as f64;
    for own in all.iter_mut() {
        let Some([equations, curves]) = own.place.and_then(|place| counts.get(&place)).copied() else {
            continue;
        };
        let part = match (is_curve(own), equations, curves) {
            (true, 0, _) => 1.0,
            (true, ..) => OF_CURVES,
            (false, _, 0) => 1.0,
            (false, ..) => 1.0 - OF_CURVES,
        };
        let among = if is_curve(own) { curves } else { equations };
        own.prior = (part / among.max(1) as f64 / places).ln();
    }
}

impl Weighed<'_> {
    /// Probabilities of all, in their order, at the temperature at which a rival that explains nearly as much is not ruled out.
    pub(crate) fn masses(&self) -> Vec<f64> {
        let best = self.all.iter().map(|own| own.fall).fold(0.0, f64::max);
        let t = (INEXACT * best / (SURE / (1.0 - SURE)).ln()).max(1.0);
        let logs: Vec<f64> = self.all.iter().map(|own| own.log(t)).collect();
        let whole = log_sum(&logs);
        logs.iter().map(|own| (own - whole).exp()).collect()
    }
}
