//! Diffusion of ions into pores of finite depth.

use std::sync::LazyLock;

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{BranchLaw, RunContext, System};

/// See the module.
pub(super) struct Warburg;

static ABOUT: About = About {
    id: "warburg",
    code: "E5",
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

/// The first terms of the series stand alone, ...
const ALONE: usize = 5;
/// ... further ones form groups that begin with these and end before the next; the last holds all the rest.
const GROUPS: [usize; 6] = [6, 9, 14, 23, 40, 72];

/// Part of the capacitance and time over tau of the n-th term.
fn term(n: usize) -> (f64, f64) {
    let square = ((n as f64 - 0.5) * std::f64::consts::PI).powi(2);
    (2.0 / square, 1.0 / square)
}

/// Two terms with the first four moments of many: the current of the whole series is met to 0.1 % from 2e-4 tau on.
fn two_of(terms: std::ops::Range<usize>) -> [(f64, f64); 2] {
    let moment =
        |of: &dyn Fn(f64) -> f64| -> f64 { terms.clone().map(term).map(|(c, time)| c * of(time)).sum() };
    let part = moment(&|_| 1.0);
    let mean = moment(&|time| time) / part;
    let variance = moment(&|time| (time - mean).powi(2)) / part;
    let half_skew = 0.5 * moment(&|time| (time - mean).powi(3)) / part / variance;
    let apart = half_skew.hypot(variance.sqrt());
    let (below, above) = (half_skew - apart, half_skew + apart);
    let share = above / (above - below);
    [(part * share, mean + below), (part * (1.0 - share), mean + above)]
}

/// The series as a few terms: part of the capacitance, and time over tau.
fn terms() -> &'static [(f64, f64)] {
    static TERMS: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| {
        let mut out: Vec<(f64, f64)> = (1..=ALONE).map(term).collect();
        for group in GROUPS.windows(2) {
            out.extend(two_of(group[0]..group[1]));
        }
        // Beyond the last group sums go as integrals do.
        let rest = 1.0 - out.iter().map(|(part, _)| part).sum::<f64>();
        let beyond = (GROUPS[GROUPS.len() - 1] - 1) as f64 * std::f64::consts::PI;
        out.push((rest, 1.0 / (3.0 * beyond * beyond)));
        out
    });
    &TERMS
}

/// Branches that diffusion of a capacitance within a time is made of.
fn branches(capacitance: f64, time_s: f64) -> impl Iterator<Item = BranchLaw> {
    terms()
        .iter()
        .map(move |(part, time)| BranchLaw::added(capacitance * part, time_s * time))
}

impl Equation for Warburg {
    const ABOUT: &'static About = &ABOUT;

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
        let total: f64 = super::branches(c, tau).map(|b| b.capacitance_f_per_cm2).sum();
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

    #[test]
    fn terms_lumped_give_the_current_of_the_series() {
        for quarter_decades in 2..=15 {
            let t = 10f64.powf(-0.25 * f64::from(quarter_decades));
            let current = |terms: &mut dyn Iterator<Item = (f64, f64)>| -> f64 {
                terms.map(|(part, time)| part / time * (-t / time).exp()).sum()
            };
            let series = current(&mut (1..2000).map(super::term));
            let lumped = current(&mut super::terms().iter().copied());
            assert!((lumped / series - 1.0).abs() < 1e-3, "{t}: {lumped} {series}");
        }
    }
}
