//! Time constants spread over many pores: constant-phase behaviour.

use super::fractional_relaxation::spectrum_of;
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{BranchLaw, RunContext, System};

/// See the module.
pub(super) struct Dispersion;

static ABOUT: About = About {
    id: "dispersion",
    code: "E4",
    summary: "constant-phase behaviour, a spread of time constants",
    equation: "branch k becomes many with ln tau normal around ln tau_k, of power as in q(p) = C_k v(p)/(1 + (p tau_k)^b), standard deviation g = pi sqrt((1/b^2 - 1)/3); the same C_k in all",
    variants: &["branch-1", "branch-2", "both", "power-branch-1", "power-branch-2"],
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
    sources: "constant-phase elements of porous electrodes; hermite quadrature of the normal distribution; Cole and Cole 1941",
};

/// Nodes, not negative, and weights of the quadrature of the standard normal distribution that is exact up to degree 17.
const NODES: [(f64, f64); 5] = [
    (0.0000000000000000e+00, 0.4063492063492063),
    (1.0232556637891326, 0.2440975028949394),
    (2.076_847_978_677_83, 0.0499164067652179),
    (3.2054290028564703, 0.0027891413212318),
    (4.512_745_863_399_783, 2.234_584_400_774_657e-5),
];

/// Bins to either side of the middle one of a spread by a power law.
const SIDE: usize = 8;

/// Logarithms of time constants and shares of the spread by a power law with that standard deviation.
fn power_law(spread: f64) -> Vec<(f64, f64)> {
    let order = 1.0 / (1.0 + 3.0 * (spread / std::f64::consts::PI).powi(2)).sqrt();
    spectrum_of(order, SIDE)
}

impl Equation for Dispersion {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        if !matches!(variant, 0 | 3) && scale.base.branches.len() < 2 {
            return Search::none();
        }
        let small = if variant < 3 { 0.1 } else { 0.3 };
        Search::over(small, vec![Limits::linear(0.0, 1.2)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let spread = parameters[0];
        let chosen = |branch: &BranchLaw| {
            matches!(
                (variant, branch.of_base),
                (0 | 3, Some(0)) | (1 | 4, Some(1)) | (2, Some(_))
            )
        };
        if spread <= 0.0 {
            return;
        }
        let both = |&(x, w): &(f64, f64)| match x {
            0.0 => vec![(0.0, w)],
            _ => vec![(spread * x, w), (-spread * x, w)],
        };
        let nodes: Vec<(f64, f64)> = match variant {
            0..=2 => NODES.iter().flat_map(both).collect(),
            _ => power_law(spread),
        };
        let shares = |branch: &BranchLaw| -> Vec<BranchLaw> {
            if chosen(branch) {
                nodes
                    .iter()
                    .map(|&(away, part)| branch.share(part, away.exp()))
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

    /// Of order one half the charge after a step is C v (1 - e^x erfc(sqrt x)), x = t/tau.
    #[test]
    fn a_power_law_charges_as_a_mittag_leffler_function() {
        let spread = std::f64::consts::PI;
        let shares = super::power_law(spread);
        let total: f64 = shares.iter().map(|(_, part)| part).sum();
        assert!((total - 1.0).abs() < 1e-12);
        for x in [0.03_f64, 0.1, 0.3, 1.0, 3.0, 10.0] {
            let left: f64 = shares.iter().map(|(u, w)| w * (-x / u.exp()).exp()).sum();
            let exact = x.exp() * statrs::function::erf::erfc(x.sqrt());
            assert!((left - exact).abs() < 5e-3, "{x}: {left} {exact}");
        }
    }

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
