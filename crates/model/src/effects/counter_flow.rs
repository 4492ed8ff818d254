//! Solvent or counter-ions that flow back slowly.

use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{RelaxationMode, RunContext, System};

/// See the module.
pub(super) struct CounterFlow;

static ABOUT: About = About {
    id: "counter-flow",
    code: "K2",
    class: Class::Relaxation,
    summary: "slow counter-ion or solvent back-flow",
    equation: "y' = (q - y)/tau, kappa = alpha (HP_lambda(q) - f y)",
    variants: &[],
    parameters: &[
        EffectParameter {
            key: "fraction",
            symbol: "f",
            unit: "",
            meaning: "bending of the back-flow in terms of the charge",
        },
        EffectParameter {
            key: "time_constant_s",
            symbol: "tau",
            unit: "s",
            meaning: "time of the back-flow",
        },
    ],
    vanishes: "f = 0",
    signature: "bending that goes back through zero",
    twins: &["partial-relaxation", "leak-coupling", "moisture-bending"],
    separated_by: "a long hold: the sign of the plateau; another solvent or counter-ion",
    sources: "two-way transport (Bao et al.)",
};

impl Effect for CounterFlow {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        let limits = vec![
            Limits::linear(0.0, 1.5),
            Limits::logarithmic(scale.longest_s() / 100.0, 3.0 * scale.longest_s()),
        ];
        Search::over(0.01, limits, &[scale.times_s(0.03, 1.5, 4)])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        // y = q - HP_(1/tau)(q).
        let [fraction, rate_per_s] = [parameters[0], parameters[1].recip()];
        system.relaxation.extend([
            RelaxationMode {
                rate_per_s: 0.0,
                weight: -fraction,
            },
            RelaxationMode {
                rate_per_s,
                weight: fraction,
            },
        ]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    /// With tau = 1/lambda it is partial relaxation with a negative fraction.
    #[test]
    fn at_one_rate_it_is_partial_relaxation() {
        let (levels, times) = ([(0.0, Some(2.0))], [5.0, 100.0, 290.0]);
        let flow = respond(&[("counter-flow", 0, &[0.3, 1.0 / 0.012])], &levels, &[], &times);
        let partial = respond(&[("partial-relaxation", 0, &[-0.3])], &levels, &[], &times);
        for (a, b) in flow.curvature_per_cm.iter().zip(&partial.curvature_per_cm) {
            assert!((a - b).abs() < 1e-9);
        }
    }
}
