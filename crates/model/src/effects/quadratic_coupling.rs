//! Bending with the square of the charge: Maxwell stress.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct QuadraticCoupling;

static ABOUT: About = About {
    id: "quadratic-coupling",
    code: "K3",
    summary: "even in charge",
    equation: "kappa -> kappa + a Q^2, or through the same relaxation as the charge, Q the charge of the strip",
    variants: &["direct", "relaxing"],
    parameters: &[EffectParameter {
        key: "quadratic_cm_per_c2",
        symbol: "a",
        unit: "1/(C2 cm)",
        meaning: "curvature per square of the charge",
    }],
    vanishes: "a = 0",
    signature: "a bending that does not change its sign with the voltage",
    twins: &[
        "coupling-saturation",
        "modulus-drift",
        "faradaic-leak",
        "asymmetric-capacitance",
    ],
    separated_by: "reversed polarity",
    sources: "Maxwell stress against osmotic pressure (Leronni and Bardella 2017)",
};

impl Equation for QuadraticCoupling {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.charge_c == 0.0 {
            return Search::none();
        }
        let most = scale.curvature_per_cm / (scale.charge_c * scale.charge_c);
        Search::over(0.01 * most, vec![Limits::linear(-0.7 * most, 0.7 * most)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let a = parameters[0];
        if variant == 0 {
            let before = system.direct_bending.take();
            system.direct_bending = Some(Box::new(move |q| {
                before.as_ref().map_or(0.0, |bend| bend(q)) + a * q * q
            }));
        } else if system.charge_to_curvature_per_c_cm != 0.0 {
            let of_charge = a / system.charge_to_curvature_per_c_cm;
            let before = system.bending_charge.take();
            system.bending_charge = Some(Box::new(move |q| {
                before.as_ref().map_or(q, |map| map(q)) + of_charge * q * q
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn what_both_polarities_share_is_the_square() {
        let (a, t) = (0.4, 280.0);
        let sum = |variant| {
            let of = |v| {
                respond(
                    &[("quadratic-coupling", variant, &[a])],
                    &[(0.0, Some(v))],
                    &[],
                    &[t],
                )
                .curvature_per_cm[0]
            };
            of(2.0) + of(-2.0)
        };
        let charge: f64 = 0.1 * 0.7 * 2.0;
        assert!((sum(0) / (2.0 * a * charge * charge) - 1.0).abs() < 1e-9);
        assert!(sum(1) > 0.0 && sum(1) < 0.1 * sum(0));
    }
}
