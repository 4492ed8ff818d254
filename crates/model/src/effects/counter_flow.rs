//! Solvent or counter-ions that flow back slowly.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RelaxationMode, RunContext, System};

/// See the module.
pub(super) struct CounterFlow;

static ABOUT: About = About {
    id: "counter-flow",
    code: "K2",
    summary: "slow counter-ion or solvent back-flow",
    equation: "kappa = alpha (HP_lambda(q) - f y); exponential: y' = (q - y)/tau; diffusive: y = SUM y_n with y_n' = (w_n q - y_n) n^2/tau, w_n = 8/(n pi)^2, n = 1, 3, 5, ...",
    variants: &["exponential", "diffusive"],
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
    sources: "two-way transport (Bao et al.); uptake of a sheet (Crank 1975)",
};

impl Equation for CounterFlow {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let limits = vec![
            Limits::linear(0.0, 1.5),
            Limits::logarithmic(scale.longest_s() / 100.0, 3.0 * scale.longest_s()),
        ];
        let times_s = match variant {
            0 => scale.times_s(0.03, 1.5, 4),
            _ => scale.times_s(0.1, 0.8, 2),
        };
        Search::over(0.01, limits, &[times_s])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        // y = q - HP_(1/tau)(q).
        let [fraction, rate_per_s] = [parameters[0], parameters[1].recip()];
        system.relaxation.push(RelaxationMode {
            rate_per_s: 0.0,
            weight: -fraction,
        });
        let shares = if variant == 0 {
            vec![(1.0, 1.0)]
        } else {
            of_a_sheet()
        };
        system
            .relaxation
            .extend(shares.iter().map(|(share, faster)| RelaxationMode {
                rate_per_s: rate_per_s * faster,
                weight: fraction * share,
            }));
    }
}

/// Terms of the uptake of a sheet that stand alone; one more holds all the rest.
const TERMS: usize = 4;

/// Shares and rates, in terms of the slowest, of what diffuses into a sheet.
fn of_a_sheet() -> Vec<(f64, f64)> {
    let term = |k: usize| {
        let square = ((2 * k + 1) * (2 * k + 1)) as f64;
        (8.0 / (square * std::f64::consts::PI.powi(2)), square)
    };
    let mut terms: Vec<(f64, f64)> = (0..TERMS).map(term).collect();
    let rest = 1.0 - terms.iter().map(|(share, _)| share).sum::<f64>();
    // The mean time of all of them is pi^2/12 of the slowest.
    let late: f64 = terms.iter().map(|(share, faster)| share / faster).sum();
    terms.push((rest, rest / (std::f64::consts::PI.powi(2) / 12.0 - late)));
    terms
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

    #[test]
    fn terms_of_a_sheet_follow_its_uptake() {
        let terms = super::of_a_sheet();
        let total: f64 = terms.iter().map(|(share, _)| share).sum();
        assert!((total - 1.0).abs() < 1e-12);
        for x in [0.01, 0.03, 0.1, 0.5, 2.0] {
            let left: f64 = terms
                .iter()
                .map(|(share, faster)| share * (-faster * x).exp())
                .sum();
            let exact = 1.0 - super::super::acting::approached(1, x);
            assert!((left - exact).abs() < 3e-3, "{x}: {left} {exact}");
        }
    }
}
