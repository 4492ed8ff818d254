//! Charge that bends less the more of it there is.

use super::acting::instant;
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// Where tanh(z)/z is one half.
const HALF_AT: f64 = 1.915_008_048_237_39;

/// How many times less the strip bends at a charge in terms of q_s: 1/g.
fn weaker(variant: usize, charge: f64) -> f64 {
    if variant < 2 {
        return 1.0 + charge.abs();
    }
    let z = HALF_AT * charge.abs();
    if z < 1e-4 { 1.0 + z * z / 3.0 } else { z / z.tanh() }
}

/// See the module.
pub(super) struct CouplingSaturation;

static ABOUT: About = About {
    id: "coupling-saturation",
    code: "K5",
    summary: "alpha falls with charge",
    equation: "drive: x -> x g before relaxation; gain: kappa -> kappa g; g = 1/(1 + |Q|/q_s), of tanh: g = tanh(z)/z with z = 1.9150 |Q|/q_s, Q the charge of the strip",
    variants: &["drive", "gain", "tanh-drive", "tanh-gain"],
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

impl Equation for CouplingSaturation {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        if scale.charge_c == 0.0 {
            return Search::none();
        }
        // The hyperbolic tangent begins with the square of its strength.
        let small = if variant < 2 { 0.02 } else { 1.0 };
        Search::over(
            small / scale.charge_c,
            vec![Limits::linear(0.0, 3.0 / scale.charge_c)],
            &[],
        )
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let per_c = parameters[0].max(0.0);
        if variant.is_multiple_of(2) {
            let before = system.bending_charge.take();
            system.bending_charge = Some(Box::new(move |q| {
                before.as_ref().map_or(q, |map| map(q)) / weaker(variant, per_c * q)
            }));
        } else {
            let area_cm2 = run.area_cm2;
            system.laws.push(instant(move |now, c| {
                c.coupling_factor /= weaker(variant, per_c * (area_cm2 * now.charge_c_per_cm2));
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
        let ratio = |variant, per_c: f64| {
            let with = respond(
                &[("coupling-saturation", variant, &[per_c])],
                &levels,
                &[],
                &[200.0],
            );
            let with = with.curvature_per_cm[0];
            with / respond(&[], &levels, &[], &[200.0]).curvature_per_cm[0]
        };
        assert!((ratio(1, 5.0) * (1.0 + 5.0 * 0.14) - 1.0).abs() < 1e-8);
        // At q_s half of it is gone in either form.
        assert!((ratio(1, 1.0 / 0.14) - 0.5).abs() < 1e-8);
        assert!((ratio(3, 1.0 / 0.14) - 0.5).abs() < 1e-8);
    }
}
