//! Back-relaxation of the strain: `s' = p' - lambda s`, p what drives it.
//!
//! Each relaxing part keeps `m = s - (p - p_0)`, so that `m' = -lambda (m + p - p_0)` and no derivative of p is needed.
//!
//! - `second-relaxation`: `(1-w) s(lambda) + w s(lambda ratio)`. "two-times": the second share half at ratio/3, half at
//!   3 ratio; "stretched": the second share of the fractional order 0.6.
//! - `fractional-relaxation`: the transfer `s^b/(s^b + lambda^b)` with b = 1 - shortfall is a spread of rates r about
//!   lambda, with the density `sin(b pi)/(2 pi (cosh(b v) + cos(b pi)))` of v = ln(r/lambda) (spectrum of the
//!   Mittag-Leffler function). It is taken at even steps of xi, `v = d sinh xi`, `d = (1-b) pi/b`, up to |v| = 16; the
//!   tails beyond stand at the ends. "logistic": v logistic; "skewed": v exponential to faster rates, less its mean; both
//!   with the sd `sqrt(2 shortfall)`.
//! - `partial-relaxation`, "yield": a small strain hardly relaxes, `s' = p' - lambda s s^2/(s^2 + y^2)`,
//!   y = f 0.2 C/cm2.

use super::effects::Effects;
use super::states::States;

const FARTHEST: f64 = 16.0;
const STEP: f64 = 0.17;
/// Order of a stretched second share.
const STRETCHED: f64 = 0.6;
/// Strain that yields where all of it stays, C/cm2.
const YIELD_C_PER_CM2: f64 = 0.2;

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
    /// Strain below which it hardly relaxes, C/cm2.
    yields: f64,
}

impl Relaxation {
    pub fn new(effects: &Effects, states: &mut States, rate_per_s: f64) -> Relaxation {
        let shortfall = effects.value("fractional-relaxation", "order_shortfall");
        let law = effects.law("fractional-relaxation");
        let own = match (shortfall > 0.0, law) {
            (false, _) => vec![(1.0, 1.0)],
            (true, "") => spectrum(1.0 - shortfall),
            (true, law) => spread(law, (2.0 * shortfall).sqrt()),
        };
        let second = effects.value("second-relaxation", "weight");
        let ratio = effects.value("second-relaxation", "rate_ratio");
        let faster = match effects.law("second-relaxation") {
            "two-times" => vec![(0.5, 1.0 / 3.0), (0.5, 3.0)],
            "stretched" => spectrum(STRETCHED),
            _ => own.clone(),
        };
        let mut parts = Vec::new();
        for (share, by, spectrum) in [(1.0 - second, 1.0, own), (second, ratio, faster)] {
            if share != 0.0 {
                parts.extend(spectrum.iter().map(|&(weight, rate)| Part {
                    state: states.add(0.0),
                    weight: weight * share,
                    ratio: rate * by,
                }));
            }
        }
        let yields = match effects.law("partial-relaxation") {
            "yield" => YIELD_C_PER_CM2 * effects.value("partial-relaxation", "fraction"),
            _ => 0.0,
        };
        Relaxation {
            rate_per_s,
            parts,
            yields,
        }
    }

    /// What of a strain relaxes.
    fn yielding(&self, strain: f64) -> f64 {
        if self.yields == 0.0 {
            return strain;
        }
        let square = strain * strain;
        strain * square / (square + self.yields * self.yields)
    }

    /// The strain, C/cm2, while what drives it has moved by `moved` since the first edge.
    pub fn strain(&self, moved: f64, y: &[f64]) -> f64 {
        let left = |part: &Part| part.weight * (moved + y[part.state]);
        self.parts.iter().map(left).sum()
    }

    /// Rate at which the strain relaxes (negative for a positive strain); lambda is multiplied by `factor`.
    pub fn loss(&self, moved: f64, factor: f64, y: &[f64]) -> f64 {
        let rate = |part: &Part| part.weight * part.ratio * self.yielding(moved + y[part.state]);
        -factor * self.rate_per_s * self.parts.iter().map(rate).sum::<f64>()
    }

    pub fn rates(&self, moved: f64, factor: f64, y: &[f64], out: &mut [f64]) {
        for part in &self.parts {
            let relaxing = self.yielding(moved + y[part.state]);
            out[part.state] = -factor * self.rate_per_s * part.ratio * relaxing;
        }
    }
}

/// Fifteen equal weights, and rates (in units of lambda) whose logarithm has that standard deviation and the mean 0.
fn spread(law: &str, sd: f64) -> Vec<(f64, f64)> {
    let middle = |k: i32| (f64::from(k) + 0.5) / 15.0;
    let place = |k: i32| match law {
        "skewed" => -(1.0 - middle(k)).ln() - 1.0,
        _ => (middle(k) / (1.0 - middle(k))).ln() * 3.0_f64.sqrt() / std::f64::consts::PI,
    };
    (0..15).map(|k| (1.0 / 15.0, (sd * place(k)).exp())).collect()
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
