//! Back-relaxation of the strain: `s' = p' - lambda s`, p what drives it.
//!
//! Each relaxing part keeps `m = s - (p - p_0)`, so that `m' = -lambda (m + p - p_0)` and no derivative of p is needed.
//!
//! - `second-relaxation`: `(1-w) s(lambda) + w s(lambda ratio)`.
//! - `fractional-relaxation`: the transfer `s^b/(s^b + lambda^b)` with b = 1 - shortfall is a spread of rates r about
//!   lambda, with the density `sin(b pi)/(2 pi (cosh(b v) + cos(b pi)))` of v = ln(r/lambda) (spectrum of the
//!   Mittag-Leffler function). It is taken at even steps of xi, `v = d sinh xi`, `d = (1-b) pi/b`, up to |v| = 16; the
//!   tails beyond stand at the ends.

use super::effects::Effects;
use super::states::States;

const FARTHEST: f64 = 16.0;
const STEP: f64 = 0.17;

/// A part of the strain with its own rate.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part {
    state: usize,
    weight: f64,
    /// Rate against lambda.
    ratio: f64,
}

/// The relaxing strain.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Relaxation {
    /// lambda, 1/s.
    pub rate_per_s: f64,
    parts: Vec<Part>,
}

impl Relaxation {
    pub fn new(effects: &Effects, states: &mut States, rate_per_s: f64) -> Relaxation {
        let order = 1.0 - effects.value("fractional-relaxation", "order_shortfall");
        let own = if order < 1.0 {
            spectrum(order)
        } else {
            vec![(1.0, 1.0)]
        };
        let second = effects.value("second-relaxation", "weight");
        let ratio = effects.value("second-relaxation", "rate_ratio");
        let mut parts = Vec::new();
        for (share, by) in [(1.0 - second, 1.0), (second, ratio)] {
            if share != 0.0 {
                parts.extend(own.iter().map(|&(weight, rate)| Part {
                    state: states.add(0.0),
                    weight: weight * share,
                    ratio: rate * by,
                }));
            }
        }
        Relaxation { rate_per_s, parts }
    }

    /// The strain, C/cm2, while what drives it has moved by `moved` since the first edge.
    pub fn strain(&self, moved: f64, y: &[f64]) -> f64 {
        let left = |part: &Part| part.weight * (moved + y[part.state]);
        self.parts.iter().map(left).sum()
    }

    /// Rate at which the strain relaxes (negative for a positive strain); lambda is multiplied by `factor`.
    pub fn loss(&self, moved: f64, factor: f64, y: &[f64]) -> f64 {
        let rate = |part: &Part| part.weight * part.ratio * (moved + y[part.state]);
        -factor * self.rate_per_s * self.parts.iter().map(rate).sum::<f64>()
    }

    pub fn rates(&self, moved: f64, factor: f64, y: &[f64], out: &mut [f64]) {
        for part in &self.parts {
            out[part.state] = -factor * self.rate_per_s * part.ratio * (moved + y[part.state]);
        }
    }
}

/// Weights and rates (in units of lambda) of fractional relaxation of that order.
fn spectrum(order: f64) -> Vec<(f64, f64)> {
    let angle = order * std::f64::consts::PI;
    let width = (1.0 - order) * std::f64::consts::PI / order;
    let last = ((FARTHEST / width).asinh() / STEP).ceil() as i32;
    let mut parts: Vec<(f64, f64)> = (-last..=last)
        .map(|k| {
            let xi = STEP * f64::from(k);
            let v = width * xi.sinh();
            let density = angle.sin() / (std::f64::consts::TAU * ((order * v).cosh() + angle.cos()));
            (density * width * xi.cosh() * STEP, v.exp())
        })
        .collect();
    let tail = 0.5 * (1.0 - parts.iter().map(|part| part.0).sum::<f64>());
    let end = parts.len() - 1;
    parts[0].0 += tail;
    parts[end].0 += tail;
    parts
}
