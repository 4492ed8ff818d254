//! The evidence for effects at the place where they fit best (Laplace's method).
//!
//! The integral of likelihood times prior over the effect's parameters is taken from the height and the width of its peak.
//! Parameters of the base are fitted anew beside every effect and not integrated: an effect that leaves them undetermined
//! would gain by the mere width of their flat prior.

use ieap_numerics::symmetric::Symmetric;

use super::policy::{KNOWN_BEFORE, SIZES};
use crate::fitting::fitted::Fitted;

/// Logarithm of the evidence for `fitted` over that of `before`, which has all its effects but some, both of the same readings:
/// what the likelihood gains at its peak, and what the width of the peak and the priors leave of it.
pub(crate) fn log_evidence(before: &Fitted, fitted: &Fitted) -> (f64, f64) {
    let fall = 0.5 * (before.penalised() - fitted.penalised());
    (fall, log_widths(fitted) - log_widths(before))
}

/// Logarithm of what the width of the peak and the priors of all effects leave of the likelihood at its peak.
fn log_widths(fitted: &Fitted) -> f64 {
    if fitted.problem.effects.is_empty() {
        return 0.0;
    }
    let (slope, _) = fitted.problem.slope(&fitted.at);
    let known = fitted.problem.base_len();
    let normal = known_before(&slope.normal, known);
    let width = 0.5 * (block(&normal, known).log_determinant() - normal.log_determinant());
    let mut at = known;
    let mut prior = 0.0;
    for free_effect in &fitted.problem.effects {
        for (k, limits) in free_effect.limits.iter().enumerate().filter(|(_, l)| !l.held) {
            // A Gaussian: its height is all that is left of it.
            if let Some(precision) = free_effect.known.get(k) {
                prior += 0.5 * precision.ln();
                at += 1;
                continue;
            }
            let precision = precision_beside(&normal, known, at);
            let (low, high) = fitted.problem.limits_of(at);
            prior += match (k, limits.logarithmic) {
                (0, false) => strength(fitted.at[at], precision, low < 0.0 && high > 0.0),
                (0, true) => -(SIZES.1 / SIZES.0).ln(),
                _ => -(high - low).max(f64::MIN_POSITIVE).ln(),
            };
            // A peak wider than what is possible is cut at its ends.
            let width = (std::f64::consts::TAU / precision.max(f64::MIN_POSITIVE)).sqrt();
            let room = if k == 0 { width } else { width.min(high - low) };
            prior += std::f64::consts::TAU.sqrt().ln() + (room / width).ln();
            at += 1;
        }
    }
    width + prior
}

/// Logarithm of the prior density of a strength's coordinate: its size is as likely on any part of a logarithmic scale.
fn strength(coordinate: f64, precision: f64, either_sign: bool) -> f64 {
    let size_of_unit = precision.max(f64::MIN_POSITIVE).sqrt();
    let size = (coordinate.abs() * size_of_unit).max(SIZES.0);
    let sign = if either_sign { 0.5_f64 } else { 1.0 };
    (sign * size_of_unit / (size * (SIZES.1 / SIZES.0).ln())).ln()
}

/// The first rows and columns.
fn block(normal: &Symmetric, order: usize) -> Symmetric {
    let mut part = Symmetric::zero(order);
    for a in 0..order {
        for b in 0..order {
            part.add(a, b, normal.get(a, b));
        }
    }
    part
}

/// Precision of coordinate `k` where the parameters of the base (the first `base` coordinates) are free and its fellows are
/// held.
fn precision_beside(normal: &Symmetric, base: usize, k: usize) -> f64 {
    let part = block(normal, base);
    let across: Vec<f64> = (0..base).map(|a| normal.get(a, k)).collect();
    let taken_up = part.solve(&across, 1e-12);
    let absorbed: f64 = taken_up.iter().zip(&across).map(|(x, y)| x * y).sum();
    (normal.get(k, k) - absorbed).max(1e-12 * normal.get(k, k))
}

/// The matrix with what is known of the first `base` coordinates before any reading.
pub(super) fn known_before(normal: &Symmetric, base: usize) -> Symmetric {
    let mut known = normal.clone();
    for k in 0..base.min(known.order()) {
        known.add(k, k, KNOWN_BEFORE);
    }
    known
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A peak of one strength, integrated by steps, against the closed form.
    #[test]
    fn the_integral_over_a_strength_is_that_of_its_peak() {
        let (best, precision) = (0.8, 900.0_f64);
        let unit = precision.sqrt();
        let density = |s: f64| 1.0 / (2.0 * s.abs() * (SIZES.1 / SIZES.0).ln());
        let steps = 200_000;
        let (low, high) = (SIZES.0 / unit, SIZES.1 / unit);
        let width = (high - low) / f64::from(steps);
        let sum: f64 = (0..steps)
            .map(|k| low + width * (f64::from(k) + 0.5))
            .map(|s| density(s) * (-0.5 * precision * (s - best) * (s - best)).exp() * width)
            .sum();
        let closed = strength(best, precision, true) + 0.5 * (std::f64::consts::TAU / precision).ln();
        assert!((sum.ln() - closed).abs() < 5e-3, "{} {closed}", sum.ln());
    }
}
