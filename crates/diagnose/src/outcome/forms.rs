//! Forms of one cause that the readings do not tell apart: its strength is as uncertain as they differ.

use super::Shown;
use crate::beside::Beside;
use crate::candidates::{AS_GOOD, PRICE};
use crate::fitted::Fitted;
use crate::null;
use crate::signature::Direction;
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::{Estimate, Parameter};
use ieap_numerics::sums::dot;

impl Shown<'_, '_> {
    /// Other forms of the only effect of `model` that explain the readings as well: name and parameters.
    pub(super) fn other_forms(&self, model: &Fitted) -> Vec<(&'static str, Vec<Parameter>)> {
        let [sought] = model.problem.effects.as_slice() else {
            return Vec::new();
        };
        let about = sought.effect.about();
        let beside = Beside::of(self.base);
        let others = (0..about.variants.len()).filter(|&variant| variant != sought.variant);
        let fitted = others.filter_map(|variant| {
            let direction = self.best_of(about.id, variant)?;
            let signature = &self.signatures[direction.signature];
            let strength = signature.part * dot(&direction.unit, self.residuals) / direction.norm;
            let other = beside.extended(signature, strength)?.arrived().in_own_limits();
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
        own.max_by(|a, b| null::gain(a, self.residuals).total_cmp(&null::gain(b, self.residuals)))
    }
}

/// The strength with an interval that holds those of the other forms too.
pub(super) fn widened(strength: &Estimate, others: &[(&'static str, Vec<Parameter>)]) -> Estimate {
    let mut wide = strength.clone();
    let (Some(mut low), Some(mut high)) = (wide.low_95, wide.high_95) else {
        return wide;
    };
    for (_, parameters) in others {
        let other = parameters.first().map(|parameter| &parameter.estimate);
        if let Some((its_low, its_high)) = other.and_then(|other| other.low_95.zip(other.high_95)) {
            (low, high) = (low.min(its_low), high.max(its_high));
        }
    }
    if (wide.low_95, wide.high_95) == (Some(low), Some(high)) {
        return wide;
    }
    wide.standard_error = Some(0.5 * (high - low) / NORMAL_95_ROUNDED);
    (wide.low_95, wide.high_95) = (Some(low), Some(high));
    wide
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_holds_those_of_other_forms_and_is_itself_without_any() {
        let strength = Estimate::determined(2.0, 0.1, 1.8, 2.2);
        assert_eq!(widened(&strength, &[]), strength);
        let other = Parameter {
            key: "part".to_owned(),
            estimate: Estimate::determined(3.0, 0.2, 2.6, 3.4),
        };
        let unknown = Parameter {
            key: "part".to_owned(),
            estimate: Estimate::not_determined("flat"),
        };
        let wide = widened(&strength, &[("both", vec![other]), ("one", vec![unknown])]);
        assert_eq!(
            (wide.value, wide.low_95, wide.high_95),
            (Some(2.0), Some(1.8), Some(3.4))
        );
        assert!((wide.standard_error.unwrap() - 0.8 / 1.96).abs() < 1e-12);
    }
}
