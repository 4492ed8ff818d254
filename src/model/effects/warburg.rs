//! Diffusion of ions into pores of finite depth.

use super::{About, Class, Effect, EffectParameter, Limits, Scale, Search};
use crate::model::extended::{BranchLaw, RunContext, System};

/// See the module.
pub(super) struct Warburg;

static ABOUT: About = About {
    id: "warburg",
    code: "E5",
    class: Class::Charging,
    summary: "diffusion into pores, current ~ t^-1/2, its charge bends",
    equation: "i = V (2C/tau) SUM e^(-(n - 1/2)^2 pi^2 t/tau) under a step V, n = 1, 2, ..., tau = L^2/D",
    variants: &[],
    parameters: &[
        EffectParameter {
            key: "diffusion_capacitance_f_per_cm2",
            symbol: "C",
            unit: "F/cm2",
            meaning: "capacitance at the end of diffusion",
        },
        EffectParameter {
            key: "diffusion_time_s",
            symbol: "tau",
            unit: "s",
            meaning: "time of diffusion L^2/D",
        },
    ],
    vanishes: "C = 0",
    signature: "a straight line of slope -1/2 in the logarithms of current and time",
    twins: &["slow-branch", "diffusion-limited-leak"],
    separated_by: "readings over three decades of time, and a discharge; or an impedance",
    sources: "finite-space diffusion between a source and a wall (Warburg)",
};

/// The first terms of the series stand alone; further ones are lumped from these on, the last with all the rest.
const LUMPS: [usize; 13] = [1, 2, 3, 4, 5, 6, 8, 11, 16, 24, 36, 60, 100];

/// Branches with the series' capacitance and its mean time, lump by lump.
fn branches(capacitance: f64, time_s: f64) -> Vec<BranchLaw> {
    let square = |n: usize| ((n as f64 - 0.5) * std::f64::consts::PI).powi(2);
    let mut rest = capacitance;
    let mut out = Vec::with_capacity(LUMPS.len());
    for pair in LUMPS.windows(2) {
        let terms = pair[0]..pair[1];
        let c: f64 = terms.clone().map(|n| 2.0 * capacitance / square(n)).sum();
        let times: f64 = terms
            .map(|n| 2.0 * capacitance * time_s / square(n).powi(2))
            .sum();
        rest -= c;
        out.push(BranchLaw::added(c, times / c));
    }
    // Beyond the hundredth term the sums go as integrals do.
    let beyond = (LUMPS[LUMPS.len() - 1] - 1) as f64 * std::f64::consts::PI;
    let of_rest_s = time_s / (3.0 * beyond * beyond);
    out.push(BranchLaw::added(rest, of_rest_s));
    out
}

impl Effect for Warburg {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        let longest_s = scale.longest_s();
        let most = 2.0 * scale.capacitance_f_per_cm2();
        let low_s = (10.0 * scale.shortest_s).min(longest_s);
        let high_s = 10.0 * longest_s;
        let limits = vec![Limits::linear(0.0, most), Limits::logarithmic(low_s, high_s)];
        let shapes = super::search::spread(2.0 * low_s, high_s / 4.0, 4);
        Search::over(0.003 * most, limits, &[shapes])
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let [capacitance, time_s] = [parameters[0], parameters[1]];
        if capacitance > 0.0 {
            system.branches.extend(branches(capacitance, time_s));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn current_falls_with_the_root_of_time_and_charge_is_complete() {
        let (c, tau) = (0.05, 400.0);
        let branches = super::branches(c, tau);
        let total: f64 = branches.iter().map(|b| b.capacitance_f_per_cm2).sum();
        assert!((total / c - 1.0).abs() < 1e-12);
        let times = [0.2, 2.0, 20.0];
        let levels = [(0.0, Some(1.0))];
        let with = respond(&[("warburg", 0, &[c, tau])], &levels, &times, &[]);
        let without = respond(&[], &levels, &times, &[]);
        for (k, t) in times.iter().enumerate() {
            let root = 0.1 * c / (std::f64::consts::PI * tau * t).sqrt();
            let more = with.current_a[k] - without.current_a[k];
            assert!((more / root - 1.0).abs() < 0.01, "{t}: {more} {root}");
        }
    }
}
