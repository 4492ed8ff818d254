//! What is tried of a channel's noise: correlations on a grid, and the evidence that any property of it must bring.

/// Correlations tried by reading order, between these inverse hyperbolic tangents.
pub(super) const CORRELATIONS: usize = 60;
pub(super) const FROM: f64 = -0.7;
pub(super) const TO: f64 = 3.4;

/// Lowest place of a curve over the correlations that are tried: its index, between those of its neighbours, and its depth,
/// by a parabola.
pub(super) fn lowest(curve: &[f64]) -> (f64, f64) {
    let least = (0..curve.len())
        .min_by(|&a, &b| curve[a].total_cmp(&curve[b]))
        .unwrap_or(0);
    if least == 0 || least + 1 >= curve.len() {
        return (least as f64, curve.get(least).copied().unwrap_or(0.0));
    }
    let [a, b, c] = [curve[least - 1], curve[least], curve[least + 1]];
    let bend = a - 2.0 * b + c;
    if bend <= 0.0 {
        return (least as f64, b);
    }
    let part = 0.5 * (a - c) / bend;
    (least as f64 + part, b - 0.25 * (a - c) * part)
}

/// The correlation at an index of the curve.
pub(super) fn correlation_at(index: f64) -> f64 {
    (FROM + (TO - FROM) * index / CORRELATIONS as f64).tanh()
}

/// What is thought of each correlation that was tried, their sum being one; empty where none was.
pub(super) fn posterior(curve: &[f64]) -> Vec<f64> {
    let least = curve.iter().copied().fold(f64::INFINITY, f64::min);
    let weights: Vec<f64> = curve.iter().map(|own| (0.5 * (least - own)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}
