//! Forms of one cause that the readings do not tell apart: its strength is as uncertain as they differ.

use super::FindingBuilder;
use crate::cause::extended_start::ExtendedStart;
use crate::cause::policy::{AS_GOOD, PRICE};
use crate::fitting::fitted::Fitted;
use crate::misfit::signature::Direction;
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::{Estimate, Parameter};
use ieap_numerics::sums::dot;

impl FindingBuilder<'_, '_> {
    /// Other forms of the only effect of `model` that explain the readings as well: name and parameters.
    pub(crate) fn other_forms(&self, model: &Fitted) -> Vec<(&'static str, Vec<Parameter>)> {
        let [free_effect] = model.problem.effects.as_slice() else {
            return Vec::new();
        };
        let about = free_effect.effect.about();
        let extended_start = ExtendedStart::of(self.base);
        let others = (0..about.variants.len()).filter(|&variant| variant != free_effect.variant);
        let fitted = others.filter_map(|variant| {
            let direction = self.best_of(about.id, variant)?;
            let signature = &self.signatures[direction.signature];
            let strength = signature.part * dot(&direction.unit, self.residuals) / direction.norm;
            let other = extended_start
                .extended(signature, strength)?
                .converged()
                .in_own_limits();
            let price = PRICE * (other.extra() as f64 - model.extra() as f64);
            let is_as_good = other.square + price < model.square + AS_GOOD;
            let parameters = other.effect_parameters(self.group).pop()?;
            is_as_good.then_some((about.variants[variant], parameters))
        });
        fitted.collect()
    }

    /// The direction of an effect's form that promises most.
    fn best_of(&self, id: &str, variant: usize) -> Option<&Direction> {
        let own = self.directions.iter().filter(|direction| {
            let signature = &self.signatures[direction.signature];
            signature.effect.about().id == id && signature.variant == variant
        });
        own.max_by(|a, b| a.gain(self.residuals).total_cmp(&b.gain(self.residuals)))
    }
}

/// The strength with an interval that holds those of the other forms too. An end that one of them leaves open is open:
/// what one form tells and another, as good, does not, the readings do not tell.
pub(crate) fn widened(strength: &Estimate, others: &[(&'static str, Vec<Parameter>)]) -> Estimate {
    let mut wide = strength.clone();
    let mut open_in: Option<&str> = None;
    for (form, parameters) in others {
        let Some(other) = parameters.first().map(|parameter| &parameter.estimate) else {
            continue;
        };
        let ends = |estimate: &Estimate| {
            usize::from(estimate.low_95.is_some()) + usize::from(estimate.high_95.is_some())
        };
        let before = ends(&wide);
        wide.low_95 = wide.low_95.zip(other.low_95).map(|(own, its)| own.min(its));
        wide.high_95 = wide.high_95.zip(other.high_95).map(|(own, its)| own.max(its));
        if ends(&wide) < before {
            open_in = Some(form);
        }
    }
    if let Some(form) = open_in {
        let reason = format!("its form `{form}` explains the readings as well and leaves it open");
        (wide.value, wide.standard_error, wide.reason) = (None, None, Some(reason));
    } else if let (Some(low), Some(high)) = (wide.low_95, wide.high_95)
        && (wide.low_95, wide.high_95) != (strength.low_95, strength.high_95)
    {
        wide.standard_error = Some(0.5 * (high - low) / NORMAL_95_ROUNDED);
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_holds_those_of_other_forms() {
        let strength = Estimate::determined(2.0, 0.1, 1.8, 2.2);
        assert_eq!(widened(&strength, &[]), strength);
        let other = Parameter {
            key: "part".to_owned(),
            estimate: Estimate::determined(3.0, 0.2, 2.6, 3.4),
        };
        let wide = widened(&strength, &[("both", vec![other])]);
        assert_eq!(
            (wide.value, wide.low_95, wide.high_95),
            (Some(2.0), Some(1.8), Some(3.4))
        );
        assert!((wide.standard_error.unwrap() - 0.8 / 1.96).abs() < 1e-12);
    }

    #[test]
    fn what_another_form_leaves_open_is_open() {
        let strength = Estimate::determined(2.0, 0.1, 1.8, 2.2);
        let leaves = |estimate| {
            let parameter = Parameter {
                key: "part".to_owned(),
                estimate,
            };
            widened(&strength, &[("linear", vec![parameter])])
        };
        let above = leaves(Estimate::above(1.5, "the threshold makes up for it"));
        assert_eq!(
            (above.value, above.low_95, above.high_95),
            (None, Some(1.5), None)
        );
        assert!(above.reason.unwrap().contains("`linear`"));
        let nothing = leaves(Estimate::not_determined("flat"));
        assert_eq!(
            (nothing.value, nothing.low_95, nothing.high_95),
            (None, None, None)
        );
    }
}
