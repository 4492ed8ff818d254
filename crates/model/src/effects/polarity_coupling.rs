//! Charge that bends more to one side than to the other.

use super::acting::read_as;
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct PolarityCoupling;

static ABOUT: About = About {
    id: "polarity-coupling",
    code: "K9",
    summary: "alpha differs between the polarities",
    equation: "drive: x -> x (1 + p sgn Q) before relaxation; gain: kappa -> kappa (1 + p sgn kappa), Q the charge of the strip",
    variants: &["drive", "gain"],
    parameters: &[EffectParameter {
        key: "asymmetry",
        symbol: "p",
        unit: "",
        meaning: "how much more positive charge bends, and how much less negative",
    }],
    vanishes: "p = 0",
    signature: "bending of another size, not of another course, under the other polarity",
    twins: &["quadratic-coupling", "even-bending", "noncircular-shape"],
    separated_by: "reversed polarity at two voltages: what is even grows with the square there, this with the voltage",
    sources: "cations and anions of unlike size; electrodes of unlike thickness",
};

impl Equation for PolarityCoupling {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.charge_c == 0.0 {
            return Search::none();
        }
        Search::over(0.02, vec![Limits::linear(-0.95, 0.95)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let asymmetry = parameters[0];
        if variant == 0 {
            let before = system.bending_charge.take();
            system.bending_charge = Some(Box::new(move |q| {
                before.as_ref().map_or(q, |map| map(q)) * (1.0 + asymmetry * q.signum())
            }));
        } else {
            system.observations.push(read_as(move |_, kappa| {
                kappa * (1.0 + asymmetry * kappa.signum())
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn polarities_bend_by_more_and_by_less() {
        for variant in 0..2 {
            let ratio = |volts| {
                let levels = [(0.0, Some(volts))];
                let with = respond(&[("polarity-coupling", variant, &[0.3])], &levels, &[], &[50.0]);
                with.curvature_per_cm[0] / respond(&[], &levels, &[], &[50.0]).curvature_per_cm[0]
            };
            assert!((ratio(2.0) - 1.3).abs() < 1e-9, "{variant}: {}", ratio(2.0));
            assert!((ratio(-2.0) - 0.7).abs() < 1e-9, "{variant}: {}", ratio(-2.0));
        }
    }
}
