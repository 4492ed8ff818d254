//! Time constants spread over many pores: constant-phase behaviour.

use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{BranchLaw, RunContext, System};

/// See the module.
pub(super) struct Dispersion;

static ABOUT: About = About {
    id: "dispersion",
    code: "E4",
    class: Class::Charging,
    summary: "constant-phase behaviour, a spread of time constants",
    equation: "branch k becomes many with ln tau normal around ln tau_k, standard deviation g; the same C_k in all",
    variants: &["branch-1", "branch-2", "both"],
    parameters: &[EffectParameter {
        key: "log_spread",
        symbol: "g",
        unit: "",
        meaning: "standard deviation of the logarithm of the time constants",
    }],
    vanishes: "g = 0",
    signature: "residual of the current that changes sign twice per decade around tau_k; linear in the voltage",
    twins: &[
        "series-resistance",
        "voltage-dependent-capacitance",
        "resistance-drift",
        "water-exchange",
        "asymmetric-capacitance",
    ],
    separated_by: "half the voltage against a capacitance that depends on it; a pulse train against drift; a four-wire measurement against a contact",
    sources: "constant-phase elements of porous electrodes; hermite quadrature of the normal distribution",
};

/// Nodes, not negative, and weights of the quadrature of the standard normal distribution that is exact up to degree 17.
const NODES: [(f64, f64); 5] = [
    (0.0000000000000000e+00, 0.4063492063492063),
    (1.0232556637891326, 0.2440975028949394),
    (2.076_847_978_677_83, 0.0499164067652179),
    (3.2054290028564703, 0.0027891413212318),
    (4.512_745_863_399_783, 2.234_584_400_774_657e-5),
];

impl Effect for Dispersion {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        if variant > 0 && scale.base.branches.len() < 2 {
            return Search::none();
        }
        Search::over(0.1, vec![Limits::linear(0.0, 1.2)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let spread = parameters[0];
        let chosen = |branch: &BranchLaw| {
            matches!(
                (variant, branch.of_base),
                (0, Some(0)) | (1, Some(1)) | (2, Some(_))
            )
        };
        let nodes: Vec<(f64, f64)> = NODES
            .iter()
            .flat_map(|&(x, w)| {
                if x == 0.0 {
                    vec![(x, w)]
                } else {
                    vec![(x, w), (-x, w)]
                }
            })
            .collect();
        let shares = |branch: &BranchLaw| -> Vec<BranchLaw> {
            if chosen(branch) && spread > 0.0 {
                nodes
                    .iter()
                    .map(|&(x, part)| branch.share(part, (spread * x).exp()))
                    .collect()
            } else {
                vec![*branch]
            }
        };
        system.branches = system.branches.iter().flat_map(shares).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn shares_add_up_and_the_first_current_is_known() {
        let sum: f64 = super::NODES
            .iter()
            .map(|(x, w)| if *x == 0.0 { *w } else { 2.0 * w })
            .sum();
        assert!((sum - 1.0).abs() < 1e-12);
        let found = respond(&[("dispersion", 2, &[0.7])], &[(0.0, Some(2.0))], &[0.0], &[]);
        let grown = (0.7_f64 * 0.7 / 2.0).exp();
        let expected = 0.1 * 2.0 * (grown / 3.0 + grown / 15.0 + 1.0 / 300.0);
        assert!((found.current_a[0] / expected - 1.0).abs() < 1e-6);
    }
}
