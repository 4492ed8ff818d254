//! Causes that explain the readings equally well, and the effects that were accepted.

use super::FindingBuilder;
use super::forms::widened;
use crate::cause::candidates::{AS_GOOD, CandidateFit, INEXACT, PRICE};
use crate::cause::select::{Selection, SelectionStep};
use crate::fitting::ends::{bounded_by, held_by, told_by};
use crate::fitting::fitted::Fitted;
use crate::fitting::problem::ExtendedProblem;
use ieap_domain::{EffectFinding, Parameter, StrengthProfile};

/// A strength that is known to this part of itself is one number: a law without free strength is held against it.
const SHARP: f64 = 0.1;
/// ... where its free twin lowers the sum of squares by no more than this: two standard errors.
const AGREES: f64 = 4.0;

impl<'g> FindingBuilder<'_, 'g> {
    /// For every effect of the model the ids that could stand in its place, itself first.
    pub(crate) fn sets(&self, selection: &Selection<'g>) -> Vec<Vec<&'static str>> {
        if let Some(proved) = &selection.proved {
            return vec![proved.clone()];
        }
        let effects = &selection.model.problem.effects;
        if let ([_], Some(step)) = (effects.as_slice(), selection.steps.first())
            && step
                .candidates
                .first()
                .is_some_and(|best| effects[0].effect.about().id == best.effect)
        {
            return vec![self.sharpened(step, &selection.model)];
        }
        (0..effects.len())
            .map(|place| self.stand_ins(selection, place))
            .collect()
    }

    /// The rivals of a single cause; one that has no free strength wins where the fitted strength of its twin is
    /// sharp, for it could have been anything.
    fn sharpened(&self, step: &SelectionStep, model: &Fitted) -> Vec<&'static str> {
        let rivals = step.rivals.clone();
        let is_free = |id: &str| {
            step.candidates
                .iter()
                .any(|candidate| candidate.effect == id && candidate.extra > 0)
        };
        let free: Vec<&&str> = rivals.iter().filter(|id| is_free(id)).collect();
        let fixed: Vec<&&str> = rivals.iter().filter(|id| !is_free(id)).collect();
        let twin = step
            .candidates
            .iter()
            .find(|candidate| rivals.contains(&candidate.effect) && is_free(candidate.effect));
        let sharp = || {
            let fitted = twin.and_then(|twin| twin.fitted.as_ref()).unwrap_or(model);
            let parameters = fitted.effect_parameters(self.group);
            let strength = parameters.first().and_then(|p| p.first()).map(|p| &p.estimate);
            strength.is_some_and(|s| match (s.value, s.standard_error) {
                (Some(value), Some(sd)) => sd < SHARP * value.abs(),
                _ => false,
            })
        };
        // Only a law that the readings do not contradict: a free strength near the fixed one is another cause.
        let agrees = |id: &str| {
            let gain = |candidate: &CandidateFit| candidate.gain;
            let own = step
                .candidates
                .iter()
                .find(|candidate| candidate.effect == id)
                .map_or(0.0, gain);
            twin.is_none_or(|twin| twin.gain - own < AGREES)
        };
        if let ([fixed], false) = (fixed.as_slice(), free.is_empty())
            && sharp()
            && agrees(fixed)
        {
            return vec![**fixed];
        }
        rivals
    }

    /// Effects that fit as well in the place of one of several.
    fn stand_ins(&self, selection: &Selection<'g>, place: usize) -> Vec<&'static str> {
        let model = &selection.model;
        let own = model.problem.effects[place].effect.about().id;
        let step = selection
            .steps
            .iter()
            .find_map(|step| step.candidates.first().filter(|best| best.effect == own));
        let own_gain = step.map_or(0.0, |best| best.gain);
        let mut set = vec![own];
        let taken: Vec<&str> = model
            .problem
            .effects
            .iter()
            .map(|s| s.effect.about().id)
            .collect();
        let known = selection
            .steps
            .iter()
            .flat_map(|step| step.candidates.iter().take(8));
        for candidate in known {
            let Some(fitted) = candidate
                .fitted
                .as_ref()
                .filter(|_| !taken.contains(&candidate.effect))
            else {
                continue;
            };
            if set.contains(&candidate.effect) {
                continue;
            }
            let Some(other) = fitted.problem.effects.last() else {
                continue;
            };
            let mut effects = model.problem.effects.clone();
            let mut values = model.effect_values();
            let extra = other.free() as f64 - effects[place].free() as f64;
            effects[place] = other.clone();
            values[place] = fitted.effect_values().pop().unwrap_or_default();
            let problem = ExtendedProblem::new(self.group, &model.base(), effects);
            let start = problem.coordinates(&model.base(), &values);
            let Some(found) = Fitted::search(problem, &[start], &[]).map(Fitted::polished) else {
                continue;
            };
            let margin = AS_GOOD + INEXACT * own_gain;
            if found.square + PRICE * extra < model.square + margin {
                set.push(candidate.effect);
            }
        }
        set
    }

    pub(crate) fn findings(
        &self,
        selection: &Selection,
        sets: &[Vec<&'static str>],
        profiles: &[StrengthProfile],
        forms: &[(&'static str, Vec<Parameter>)],
    ) -> Vec<EffectFinding> {
        let model = &selection.model;
        let mut parameters = model.effect_parameters(self.group);
        let values = model.effect_values();
        for ((free_effect, own), values) in model.problem.effects.iter().zip(&mut parameters).zip(&values) {
            let id = free_effect.effect.about().id;
            for ((parameter, limits), value) in own.iter_mut().zip(&free_effect.limits).zip(values) {
                let is_its =
                    |profile: &&StrengthProfile| profile.effect == id && profile.key == parameter.key;
                if let Some(profile) = profiles.iter().find(is_its) {
                    parameter.estimate = match parameter.estimate.value {
                        Some(_) => held_by(&parameter.estimate, profile),
                        None => told_by(
                            &parameter.estimate,
                            profile,
                            *value,
                            free_effect,
                            limits.logarithmic,
                        ),
                    };
                }
                parameter.estimate = bounded_by(parameter.estimate.clone(), *limits);
            }
        }
        if let Some(strength) = parameters.first_mut().and_then(|own| own.first_mut()) {
            strength.estimate = widened(&strength.estimate, forms);
        }
        let each = model.problem.effects.iter().zip(parameters).zip(sets);
        each.map(|((free_effect, parameters), set)| {
            let about = free_effect.effect.about();
            let step = selection.steps.iter().find(|step| {
                let is_first =
                    |candidate: &CandidateFit| candidate.effect == about.id || selection.proved.is_some();
                step.taken && step.candidates.first().is_some_and(is_first)
            });
            EffectFinding {
                effect: about.id.to_owned(),
                variant: about.variants.get(free_effect.variant).map(|v| (*v).to_owned()),
                parameters,
                p: step.map_or(1.0, |step| step.p),
                q: None,
                twins: set
                    .iter()
                    .filter(|id| **id != about.id)
                    .map(|id| (*id).to_owned())
                    .collect(),
            }
        })
        .collect()
    }
}
