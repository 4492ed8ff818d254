//! The evidence for effects at the place where they fit best (Laplace's method).
//!
//! The integral of likelihood times prior over the effect's parameters is taken from the height and the width of its peak.
//! Parameters of the base are fitted anew beside every effect and not integrated: an effect that leaves them undetermined
//! would gain by the mere width of their flat prior.

use ieap_numerics::sums::dot;
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
///
/// A prior that is even over a range is as wide as a Gaussian of a variance of a twelfth of its square: along what no reading
/// tells the peak is no wider than that, in whatever direction it lies.
fn log_widths(fitted: &Fitted) -> f64 {
    if fitted.problem.effects.is_empty() {
        return 0.0;
    }
    let (slope, _) = fitted.problem.slope(&fitted.at);
    let known = fitted.problem.base_len();
    let mut normal = known_before(&slope.normal, known);
    let base = normal.first(known).log_determinant();
    let mut at = known;
    let mut priors = Vec::new();
    for free_effect in &fitted.problem.effects {
        for (k, limits) in free_effect.limits.iter().enumerate().filter(|(_, l)| !l.held) {
            priors.push(match free_effect.known.get(k) {
                Some(precision) => Prior::Gaussian(*precision),
                None => {
                    let precision = precision_beside(&normal, known, at);
                    let (low, high) = fitted.problem.limits_of(at);
                    match (k, limits.logarithmic) {
                        (0, false) => Prior::strength(fitted.at[at], precision, low < 0.0 && high > 0.0),
                        (0, true) => Prior::Even((SIZES.1 / SIZES.0).ln()),
                        _ => Prior::Even((high - low).max(f64::MIN_POSITIVE)),
                    }
                }
            });
            at += 1;
        }
    }
    let mut log = 0.0;
    for (k, prior) in priors.iter().enumerate() {
        log += prior.log_height();
        normal.add(known + k, known + k, prior.narrows());
    }
    log + 0.5 * (base - normal.log_determinant())
}

/// What is thought of a coordinate before any reading.
enum Prior {
    /// A Gaussian of that precision, which the likelihood has already.
    Gaussian(f64),
    /// Even over a range.
    Even(f64),
    /// Of that density where the peak is, and of that range about it.
    Falling { density: f64, range: f64 },
}

impl Prior {
    /// Of a strength's coordinate, of that precision: its size is as likely on any part of a logarithmic scale.
    fn strength(coordinate: f64, precision: f64, either_sign: bool) -> Prior {
        let size_of_unit = precision.max(f64::MIN_POSITIVE).sqrt();
        let least = (SIZES.0 / size_of_unit).max(coordinate.abs());
        let range = least * (SIZES.1 / SIZES.0).ln();
        let sign = if either_sign { 0.5_f64 } else { 1.0 };
        Prior::Falling {
            density: sign / range,
            range,
        }
    }

    /// Logarithm of its height at the peak, over that of a Gaussian of unit width.
    fn log_height(&self) -> f64 {
        match self {
            Prior::Gaussian(precision) => 0.5 * precision.ln(),
            Prior::Even(range) => 0.5 * std::f64::consts::TAU.ln() - range.ln(),
            Prior::Falling { density, .. } => 0.5 * std::f64::consts::TAU.ln() + density.ln(),
        }
    }

    /// The precision that it adds to that of the likelihood.
    fn narrows(&self) -> f64 {
        match self {
            Prior::Gaussian(_) => 0.0,
            Prior::Even(range) | Prior::Falling { range, .. } => 12.0 / (range * range),
        }
    }
}

/// Precision of coordinate `k` where the parameters of the base (the first `base` coordinates) are free and its fellows are
/// held.
fn precision_beside(normal: &Symmetric, base: usize, k: usize) -> f64 {
    let part = normal.first(base);
    let across: Vec<f64> = (0..base).map(|a| normal.get(a, k)).collect();
    let taken_up = part.solve(&across, 1e-12);
    (normal.get(k, k) - dot(&taken_up, &across)).max(1e-12 * normal.get(k, k))
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
        let prior = Prior::strength(best, precision, true);
        let closed = prior.log_height() - 0.5 * (precision + prior.narrows()).ln();
        assert!((sum.ln() - closed).abs() < 5e-3, "{} {closed}", sum.ln());
    }
}
