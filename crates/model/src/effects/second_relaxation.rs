//! Two rates of back-relaxation.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RelaxationMode, RunContext, System};

/// See the module.
pub(super) struct SecondRelaxation;

static ABOUT: About = About {
    id: "second-relaxation",
    code: "M2",
    summary: "two relaxation rates",
    equation: "kappa = alpha ((1 - w) HP_lambda(q) + w HP_(n lambda)(q))",
    variants: &[],
    parameters: &[
        EffectParameter {
            key: "weight",
            symbol: "w",
            unit: "",
            meaning: "part of the strain with the second rate",
        },
        EffectParameter {
            key: "rate_ratio",
            symbol: "n",
            unit: "",
            meaning: "second rate in terms of the first",
        },
    ],
    vanishes: "w = 0",
    signature: "an S-shaped residual of the bending in the logarithm of time",
    twins: &[
        "fractional-relaxation",
        "partial-relaxation",
        "modulus-drift",
        "creep",
        "slow-branch",
    ],
    separated_by: "a hold of five times the slower relaxation; a pulse train against a drift of the stiffness",
    sources: "generalised Maxwell solid",
};

impl Equation for SecondRelaxation {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.base.relaxation_rate_per_s <= 0.0 {
            return Search::none();
        }
        let limits = vec![Limits::linear(0.0, 0.9), Limits::logarithmic(2.0, 200.0)];
        Search::over(0.02, limits, &[vec![3.0, 10.0, 30.0, 100.0]])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        // Every mode that is there is shared out.
        let [weight, ratio] = [parameters[0], parameters[1]];
        let share = |mode: &RelaxationMode| {
            let part = |weight, ratio| RelaxationMode {
                rate_per_s: ratio * mode.rate_per_s,
                weight: weight * mode.weight,
            };
            [part(1.0 - weight, 1.0), part(weight, ratio)]
        };
        system.relaxation = system.relaxation.iter().flat_map(share).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;
    use crate::extended::tests::{base, drive};

    #[test]
    fn it_is_the_sum_of_two_closed_forms() {
        let (levels, times) = ([(0.0, Some(2.0))], [5.0, 50.0, 250.0]);
        let found = respond(&[("second-relaxation", 0, &[0.3, 10.0])], &levels, &[], &times);
        let slow = base().curvature_per_cm(&drive(&levels), 0.1, &times);
        let mut other = base();
        other.relaxation_rate_per_s *= 10.0;
        let fast = other.curvature_per_cm(&drive(&levels), 0.1, &times);
        for k in 0..times.len() {
            let expected = 0.7 * slow[k] + 0.3 * fast[k];
            assert!((found.curvature_per_cm[k] - expected).abs() < 1e-9 * slow[0]);
        }
    }
}
