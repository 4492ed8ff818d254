//! Hypotheses about a group with their masses.

use ieap_domain::{Hypothesis, HypothesisKind, VaryingParameter, VaryingValue};
use ieap_model::FitModel;
use ieap_numerics::symmetric::Symmetric;
use rayon::prelude::*;

use super::form_error::form_error;
use super::laplace::{known_before, log_evidence};
use super::own::OwnFits;
use super::policy::{self, SIZES, log_sum};
use super::shared::{self, Shared};
use super::unnamed::Nameless;
use super::varies::{Covariate, Subset, covariates, least, subsets};
use crate::cause::candidates::CandidateFit;
use crate::cause::select::Selection;
use crate::fitting::fitted::Fitted;
use crate::readings::group::RunGroup;

/// Hypotheses below this mass are not told, but for the leading one of each kind.
const LEAST: f64 = 1e-3;
/// Subsets of parameters that are fitted in full: the leading ones.
const FITTED: usize = 3;

/// What hypotheses are weighed on.
pub(crate) struct Asked<'a, 'g> {
    pub(crate) group: &'g RunGroup<'g>,
    pub(crate) base: &'a Fitted<'g>,
    pub(crate) selection: &'a Selection<'g>,
    pub(crate) model: &'static FitModel,
}

/// What is found.
pub(crate) struct Weighed {
    /// In falling order.
    pub(crate) posterior: Vec<Hypothesis>,
    /// Parameters that differ between the runs under the leading such hypothesis, where it carries mass.
    pub(crate) differs: Vec<VaryingParameter>,
}

/// Weighs all hypotheses.
pub(crate) fn weigh(asked: &Asked) -> Weighed {
    let base = asked.base;
    let (slope, tangent) = base.tangent();
    let residuals = base.residuals();
    let nameless = Nameless::of(asked.group);
    let effects = asked
        .selection
        .steps
        .first()
        .map_or(0, |step| step.candidates.len());
    let mut found = vec![
        weight(HypothesisKind::Base, policy::BASE, 0.0),
        weight(
            HypothesisKind::Unnamed,
            policy::EFFECT * effects.max(1) as f64,
            nameless.unnamed(&tangent, &residuals),
        ),
        weight(
            HypothesisKind::SlowNoise,
            policy::SLOW_NOISE,
            nameless.slow_noise(&tangent, &residuals),
        ),
    ];
    found.extend(of_effects(asked, &slope.normal, &nameless, &residuals));
    let varying = Varying::of(asked, &slope.normal);
    if let Some(varying) = &varying {
        found.extend(
            varying
                .subsets
                .iter()
                .map(|subset| varying.hypothesis(asked, subset)),
        );
    }
    normalise(&mut found);
    let matters: f64 = found
        .iter()
        .filter(|h| h.kind == HypothesisKind::Varies)
        .map(|h| h.mass)
        .sum();
    let mut kinds: Vec<HypothesisKind> = Vec::new();
    found.retain(|h| {
        let is_first = !kinds.contains(&h.kind);
        kinds.push(h.kind);
        is_first || h.mass >= LEAST
    });
    let differs = varying.filter(|_| matters > 1.0 - policy::SURE);
    Weighed {
        differs: differs.map_or_else(Vec::new, |varying| varying.told(asked)),
        posterior: found,
    }
}

/// Makes masses of logarithms of weights, in falling order. One whose evidence is no number cannot be weighed and has none:
/// it must not take the others' from them.
fn normalise(found: &mut [Hypothesis]) {
    for own in found.iter_mut().filter(|own| own.mass.is_nan()) {
        own.mass = f64::NEG_INFINITY;
    }
    let all = log_sum(&found.iter().map(|own| own.mass).collect::<Vec<_>>());
    found.iter_mut().for_each(|own| own.mass = (own.mass - all).exp());
    found.sort_by(|a, b| b.mass.total_cmp(&a.mass));
}

/// A hypothesis with the logarithm of its prior weight times its evidence in the place of its mass.
fn weight(kind: HypothesisKind, prior: f64, log_evidence: f64) -> Hypothesis {
    Hypothesis {
        kind,
        effects: Vec::new(),
        form: None,
        parameters_that_differ: Vec::new(),
        with: None,
        with_unnamed: false,
        form_error: None,
        mass: prior.ln() + log_evidence,
    }
}

/// Every effect and pair that was fitted, each alone and with something unnamed beside it; those that were not fitted by what
/// they promise.
fn of_effects(asked: &Asked, normal: &Symmetric, nameless: &Nameless, residuals: &[f64]) -> Vec<Hypothesis> {
    let singles = asked
        .selection
        .steps
        .first()
        .map_or(&[][..], |step| &step.candidates);
    let pairs = asked
        .selection
        .steps
        .iter()
        .skip(1)
        .flat_map(|step| &step.candidates);
    let effects = singles.len().max(1) as f64;
    let mut wanted: Vec<(&Fitted, f64)> = Vec::new();
    let fitted = |candidate: &'_ CandidateFit<'_>| candidate.fitted.is_some();
    for candidate in singles.iter().filter(|candidate| fitted(candidate)) {
        wanted.extend(candidate.fitted.as_ref().map(|own| (own, policy::EFFECT)));
    }
    for candidate in pairs.filter(|candidate| fitted(candidate)) {
        let of_two = candidate
            .fitted
            .as_ref()
            .filter(|own| own.problem.effects.len() == 2);
        wanted.extend(of_two.map(|own| (own, policy::PAIR / effects)));
    }
    if asked.selection.model.problem.effects.len() > 1 {
        wanted.push((&asked.selection.model, policy::PAIR / effects));
    }
    let mut found: Vec<Hypothesis> = wanted
        .par_iter()
        .flat_map_iter(|(fitted, prior)| of_fitted(asked, normal, nameless, residuals, fitted, *prior))
        .collect();
    for candidate in singles.iter().filter(|candidate| !fitted(candidate)) {
        let size = candidate.forecast.max(0.0).sqrt().max(SIZES.0);
        let peak = 0.5 * candidate.forecast + 0.5 * std::f64::consts::TAU.ln();
        let prior = -(2.0 * size * (SIZES.1 / SIZES.0).ln()).ln();
        let mut own = weight(HypothesisKind::Effect, policy::EFFECT, peak + prior);
        own.effects = vec![candidate.effect.to_owned()];
        found.push(own);
    }
    found
}

fn of_fitted(
    asked: &Asked,
    normal: &Symmetric,
    nameless: &Nameless,
    residuals: &[f64],
    fitted: &Fitted,
    prior: f64,
) -> [Hypothesis; 2] {
    let (_, tangent) = fitted.tangent();
    let left = fitted.residuals();
    let trace: Vec<f64> = residuals
        .iter()
        .zip(&left)
        .map(|(before, after)| before - after)
        .collect();
    let exact = log_evidence(asked.base, normal, fitted);
    let errors = form_error(asked.group, &tangent, &trace, &left);
    let mut own = weight(HypothesisKind::Effect, prior, exact + errors.gain);
    own.form_error = Some(errors.of_largest);
    own.effects = fitted
        .problem
        .effects
        .iter()
        .map(|free_effect| free_effect.effect.about().id.to_owned())
        .collect();
    own.form = fitted
        .problem
        .effects
        .first()
        .and_then(|free_effect| free_effect.effect.about().variants.get(free_effect.variant))
        .map(|form| (*form).to_owned());
    let beside = nameless.unnamed(&tangent, &left);
    let with_unnamed = Hypothesis {
        with_unnamed: true,
        form_error: None,
        mass: prior.ln() + policy::EFFECT_AND_UNNAMED.ln() + exact + beside,
        ..own.clone()
    };
    [own, with_unnamed]
}

/// Parameters that differ between the runs.
struct Varying {
    covariates: Vec<Covariate>,
    /// The leading ones, in falling order.
    subsets: Vec<Subset>,
    /// The leading one, fitted in full.
    shared: Shared,
}

impl Varying {
    fn of(asked: &Asked, normal: &Symmetric) -> Option<Varying> {
        if asked.group.runs.len() < 2 {
            return None;
        }
        let own = OwnFits::of(asked.group, asked.base, asked.model)?;
        let covariates = covariates(asked.group);
        let width = known_before(normal, normal.order()).log_determinant();
        let log_base = -0.5 * asked.base.square - 0.5 * width;
        let forms = own.forms();
        let mut subsets = subsets(&forms, &covariates, log_base);
        subsets.sort_by(|a, b| b.log_weight.total_cmp(&a.log_weight));
        // What is left in full is more than the closed form has it: where parameters are far apart it is a parabola.
        let mut known: Vec<(Vec<usize>, Shared)> = Vec::new();
        for _ in 0..FITTED {
            let first = subsets.first()?.of.clone();
            if known.iter().any(|(of, _)| *of == first) {
                break;
            }
            let fitted = shared::fit(asked.base, &first, &own.at);
            let beyond = 0.5 * (fitted.square - least(&forms, &first)).max(0.0);
            for subset in subsets.iter_mut().filter(|subset| subset.of == first) {
                subset.log_weight -= beyond;
            }
            known.push((first, fitted));
            subsets.sort_by(|a, b| b.log_weight.total_cmp(&a.log_weight));
        }
        let first = subsets.first()?.of.clone();
        let place = known.iter().position(|(of, _)| *of == first);
        let shared = match place {
            Some(place) => known.swap_remove(place).1,
            None => shared::fit(asked.base, &first, &own.at),
        };
        Some(Varying {
            covariates,
            subsets,
            shared,
        })
    }

    fn hypothesis(&self, asked: &Asked, subset: &Subset) -> Hypothesis {
        let mut own = weight(HypothesisKind::Varies, 1.0, subset.log_weight);
        own.parameters_that_differ = subset.of.iter().map(|&k| asked.base.base_key(k)).collect();
        own.with = Some(match subset.with {
            Some(place) => self.covariates[place].name.clone(),
            None => "run".to_owned(),
        });
        own
    }

    /// The parameters of the leading subset, run by run.
    fn told(&self, asked: &Asked) -> Vec<VaryingParameter> {
        let Some(first) = self.subsets.first() else {
            return Vec::new();
        };
        let of_parameter = |&k: &usize| {
            let of_run = |(run, name): (usize, &str)| {
                let (value, standard_error) =
                    asked
                        .base
                        .base_value(k, self.shared.at[run][k], self.shared.standard_errors[run][k])?;
                Some(VaryingValue {
                    run: name.to_owned(),
                    step_v: asked.group.runs[run].drive().nominal_step_v(),
                    value,
                    standard_error,
                })
            };
            let names = asked.group.runs.iter().map(|run| run.given.name);
            VaryingParameter {
                key: asked.base.base_key(k),
                values: names.enumerate().filter_map(of_run).collect(),
            }
        };
        first.of.iter().map(of_parameter).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hypothesis_that_cannot_be_weighed_takes_nothing_from_the_others() {
        let mut found = vec![
            weight(HypothesisKind::Effect, 1.0, f64::NAN),
            weight(HypothesisKind::Base, 1.0, 0.0),
            weight(HypothesisKind::Unnamed, 3.0, 0.0),
        ];
        normalise(&mut found);
        let masses: Vec<f64> = found.iter().map(|own| own.mass).collect();
        assert!((masses[0] - 0.75).abs() < 1e-12 && (masses[1] - 0.25).abs() < 1e-12);
        assert_eq!((masses[2], found[2].kind), (0.0, HypothesisKind::Effect));
    }
}
