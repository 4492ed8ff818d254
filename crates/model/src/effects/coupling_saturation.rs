//! Charge that bends less the more of it there is.

use super::acting::instant;
use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct CouplingSaturation;

static ABOUT: About = About {
    id: "coupling-saturation",
    code: "K5",
    class: Class::Coupling,
    summary: "alpha falls with charge",
    equation: "drive: x -> x/(1 + |Q|/q_s) before relaxation; gain: kappa -> kappa/(1 + |Q|/q_s), Q the charge of the strip",
    variants: &["drive", "gain"],
    parameters: &[EffectParameter {
        key: "inverse_charge_per_c",
        symbol: "1/q_s",
        unit: "1/C",
        meaning: "inverse of the charge at which half the bending is gone",
    }],
    vanishes: "1/q_s = 0",
    signature: "bending is concave in the charge, alike for both signs",
    twins: &[
        "quadratic-coupling",
        "faradaic-leak",
        "modulus-drift",
        "softening",
        "tip-formula",
    ],
    separated_by: "half the voltage",
    sources: "crowding of ions",
};

impl Effect for CouplingSaturation {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        if scale.charge_c == 0.0 {
            return Search::none();
        }
        Search::over(
            0.02 / scale.charge_c,
            vec![Limits::linear(0.0, 3.0 / scale.charge_c)],
            &[],
        )
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let per_c = parameters[0].max(0.0);
        if variant == 0 {
            let before = system.bending_charge.take();
            system.bending_charge = Some(Box::new(move |q| {
                before.as_ref().map_or(q, |map| map(q)) / (1.0 + per_c * q.abs())
            }));
        } else {
            let area_cm2 = run.area_cm2;
            system.laws.push(instant(move |now, c| {
                c.coupling_factor /= 1.0 + per_c * (area_cm2 * now.charge_c_per_cm2).abs();
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn gain_falls_by_the_charge_stored() {
        let levels = [(0.0, Some(-2.0))];
        let with = respond(&[("coupling-saturation", 1, &[5.0])], &levels, &[], &[200.0]);
        let without = respond(&[], &levels, &[], &[200.0]);
        let ratio = with.curvature_per_cm[0] / without.curvature_per_cm[0];
        assert!((ratio * (1.0 + 5.0 * 0.14) - 1.0).abs() < 1e-8);
    }
}
