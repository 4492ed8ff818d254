//! Relaxation by a power law, or by a stretched exponential.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RelaxationMode, RunContext, System};
use ieap_numerics::line;

/// See the module.
pub(super) struct FractionalRelaxation;

static ABOUT: About = About {
    id: "fractional-relaxation",
    code: "M3",
    summary: "power-law or stretched relaxation",
    equation: "power: kappa(p) = alpha p^b/(p^b + lambda^b) q(p); stretched: what a charge at once has bent falls as e^(-(lambda t)^b); b = 1 - d",
    variants: &["power", "stretched"],
    parameters: &[EffectParameter {
        key: "order_shortfall",
        symbol: "d",
        unit: "",
        meaning: "how far the order of the derivative, or the exponent of time, falls short of 1",
    }],
    vanishes: "d = 0",
    signature: "a tail of the bending that falls as a power of time, or a slope that flattens in the logarithm of time",
    twins: &["second-relaxation", "creep", "partial-relaxation"],
    separated_by: "a hold over three decades of time; the order with its interval says more than the name",
    sources: "Mittag-Leffler function and its spectrum of rates (Cole-Cole); Caponetto et al. 2013; stretched exponential (Williams and Watts 1970), its rates by Kanter 1975",
};

/// Modes to either side of the middle one.
const SIDE: usize = 14;

/// Logarithms of rates (in units of the rate of the law) and weights of an order below 1: the density
/// sin(b pi)/(2 pi (cosh(b u) + cos(b pi))) of u in bins, each with all that it holds.
fn spectrum(order: f64) -> Vec<(f64, f64)> {
    spectrum_of(order, SIDE)
}

/// The same with so many bins to either side of the middle one.
pub(super) fn spectrum_of(order: f64, side: usize) -> Vec<(f64, f64)> {
    use std::f64::consts::PI;
    let up_to = |u: f64| ((PI * order / 2.0).tan() * (order * u / 2.0).tanh()).atan() / (PI * order);
    let edges = edges(PI * (1.0 - order) / order, 4.0 / order, side);
    let mut out = vec![(0.0, 2.0 * up_to(edges[0]))];
    for (k, &edge) in edges.iter().enumerate() {
        let (next, middle) = match edges.get(k + 1) {
            Some(&next) => (up_to(next), (edge + next) / 2.0),
            // Beyond the last edge the density falls as e^(-b u).
            None => (0.5, edge + 1.0 / order),
        };
        let weight = next - up_to(edge);
        out.extend([(middle, weight), (-middle, weight)]);
    }
    out
}

/// Edges of the bins above 0 up to `far`: as wide as the density's peak at 0, then wider, smooth in the peak's width.
fn edges(width: f64, far: f64, side: usize) -> Vec<f64> {
    let width = width.max(1e-3);
    let places = |u: f64| (u / width).asinh() + u / 0.8;
    let all = places(far);
    let edge = |k: usize| {
        let wanted = all * (k as f64 + 0.5) / (side as f64 - 0.5);
        line::edge(0.0, far, 60, |u| places(u) < wanted)
    };
    (0..side).map(edge).collect()
}

/// Bins of the rates of a stretched exponential, and nodes of the integral for what a bin holds.
const BINS: usize = 24;
const NODES: usize = 64;

/// Logarithms of rates and weights of e^(-(lambda t)^b): rates are distributed as a one-sided stable law, whose
/// distribution is the mean over 0 < phi < pi of e^(-A(phi) rate^(-b/(1 - b))) (Kanter 1975).
fn stretched(order: f64) -> Vec<(f64, f64)> {
    use std::f64::consts::PI;
    let left = 1.0 - order;
    let power = order / left;
    // Nodes crowd at pi, where the fast rates come from.
    let node = |k: usize| {
        let s = (k as f64 + 0.5) / NODES as f64;
        let phi = PI * (1.0 - s.powi(4));
        let log_a =
            (left * (left * phi).sin().ln() + order * (order * phi).sin().ln() - phi.sin().ln()) / left;
        (log_a, s.powi(3))
    };
    let nodes: Vec<(f64, f64)> = (0..NODES).map(node).collect();
    let whole: f64 = nodes.iter().map(|(_, weight)| weight).sum();
    let up_to = |u: f64| -> f64 {
        let part = |(log_a, weight): &(f64, f64)| weight * (-(log_a - power * u).exp()).exp();
        nodes.iter().map(part).sum::<f64>() / whole
    };
    // Slower rates than the first edge hold less than 1e-4 of the strain, faster ones than the last about as little.
    let least = (power * order.ln() + left.ln() - 9.2_f64.ln()) / power;
    let wide = (9.0 / order - least) / -least;
    let edge = |half: usize| least - least * (wide.ln_1p() * half as f64 / (2 * BINS) as f64).exp_m1();
    let halves: Vec<f64> = (0..=2 * BINS).map(edge).collect();
    let shares: Vec<f64> = halves.iter().map(|&u| up_to(u)).collect();
    let bin = |k: usize| {
        let [a, b, c] = [2 * k, 2 * k + 1, 2 * k + 2];
        let (first, second) = (shares[b] - shares[a], shares[c] - shares[b]);
        let weight = first + second;
        let (below, above) = ((halves[a] + halves[b]) / 2.0, (halves[b] + halves[c]) / 2.0);
        let away = if weight > 0.0 {
            (first * below + second * above) / weight
        } else {
            halves[b]
        };
        (away, weight)
    };
    let mut out: Vec<(f64, f64)> = (0..BINS).map(bin).collect();
    out[0].1 += shares[0];
    out.push((halves[2 * BINS] + 1.0 / order, 1.0 - shares[2 * BINS]));
    out
}

impl Equation for FractionalRelaxation {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        if scale.base.relaxation_rate_per_s <= 0.0 {
            return Search::none();
        }
        Search::over(0.02, vec![Limits::linear(0.0, 0.6)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        // Every mode that relaxes becomes a spectrum.
        let order = 1.0 - parameters[0].clamp(0.0, 0.9);
        if order == 1.0 {
            return;
        }
        let spectrum = if variant == 0 {
            spectrum(order)
        } else {
            stretched(order)
        };
        let spread = |mode: &RelaxationMode| -> Vec<RelaxationMode> {
            if mode.rate_per_s == 0.0 {
                return vec![*mode];
            }
            let part = |&(away, weight): &(f64, f64)| RelaxationMode {
                rate_per_s: mode.rate_per_s * away.exp(),
                weight: mode.weight * weight,
            };
            spectrum.iter().map(part).collect()
        };
        system.relaxation = system.relaxation.iter().flat_map(spread).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::{spectrum, stretched};

    #[test]
    fn rates_of_a_stretched_exponential_add_up_to_it() {
        for order in [0.4_f64, 0.5, 0.7, 0.9, 0.98, 0.998] {
            let modes = stretched(order);
            let total: f64 = modes.iter().map(|m| m.1).sum();
            assert!(
                (total - 1.0).abs() < 1e-12 && modes.iter().all(|m| m.1 >= 0.0),
                "{order}"
            );
            for x in [0.03_f64, 0.1, 0.3, 1.0, 3.0] {
                let sum: f64 = modes.iter().map(|(u, w)| w * (-x * u.exp()).exp()).sum();
                let exact = (-x.powf(order)).exp();
                assert!((sum - exact).abs() < 4e-3, "{order} {x}: {sum} {exact}");
            }
        }
    }

    /// E_(1/2)(-sqrt(x)) = e^x erfc(sqrt(x)).
    #[test]
    fn half_order_is_the_error_function() {
        let modes = spectrum(0.5);
        let total: f64 = modes.iter().map(|m| m.1).sum();
        assert!((total - 1.0).abs() < 1e-12);
        for x in [0.03_f64, 0.1, 0.3, 1.0, 3.0, 10.0] {
            let sum: f64 = modes.iter().map(|(u, w)| w * (-x * u.exp()).exp()).sum();
            let exact = x.exp() * statrs::function::erf::erfc(x.sqrt());
            assert!((sum - exact).abs() < 2e-3, "{x}: {sum} {exact}");
        }
    }

    #[test]
    fn near_order_one_the_modes_close_up() {
        for order in [0.999_f64, 0.97] {
            let away: f64 = spectrum(order)
                .iter()
                .map(|(u, w)| w * ((-u.exp()).exp() - (-1.0_f64).exp()))
                .sum();
            assert!(away.abs() < 2.0 * (1.0 - order), "{order}: {away}");
        }
    }
}
