//! The effects of the extended model with their parameters.

use super::FindingBuilder;
use super::forms::widened;
use crate::fitting::ends::{bounded_by, held_by, told_by};
use crate::fitting::fitted::Fitted;
use ieap_domain::{EffectFinding, Parameter, StrengthProfile};

impl FindingBuilder<'_, '_> {
    /// The effects of `model`; those of `set` that it has not could stand in their place.
    pub(crate) fn findings(
        &self,
        model: &Fitted,
        set: &[String],
        profiles: &[StrengthProfile],
        forms: &[(&'static str, Vec<Parameter>)],
    ) -> Vec<EffectFinding> {
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
        let ids: Vec<&str> = effects_of(model).collect();
        let each = model.problem.effects.iter().zip(parameters);
        each.map(|(free_effect, parameters)| {
            let about = free_effect.effect.about();
            EffectFinding {
                effect: about.id.to_owned(),
                variant: about.variants.get(free_effect.variant).map(|v| (*v).to_owned()),
                parameters,
                p: self.p_misfit,
                q: None,
                twins: set
                    .iter()
                    .filter(|id| !ids.contains(&id.as_str()))
                    .cloned()
                    .collect(),
            }
        })
        .collect()
    }
}

fn effects_of<'a>(model: &'a Fitted) -> impl Iterator<Item = &'static str> + 'a {
    model
        .problem
        .effects
        .iter()
        .map(|free_effect| free_effect.effect.about().id)
}
