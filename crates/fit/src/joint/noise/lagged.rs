//! Products of series from which the likelihood of any first-order autoregression follows without going through the
//! readings again.

use ieap_numerics::symmetric::Symmetric;

use super::columns::inner;

/// Products of two series at the first reading, at later ones, at those before them, and across.
pub(crate) type Products = [f64; 4];

/// See [`Products`].
pub(crate) fn products(x: &[f64], y: &[f64]) -> Products {
    let last = x.len() - 1;
    let later = inner(&x[1..], &y[1..]);
    let ends = x[0] * y[0] - x[last] * y[last];
    let across = inner(&x[1..], &y[..last]) + inner(&x[..last], &y[1..]);
    [x[0] * y[0], later, later + ends, across]
}

/// The product of both series made white by that correlation.
pub(crate) fn white([first, later, earlier, across]: &Products, rho: f64) -> f64 {
    first + (later + rho * rho * earlier - rho * across) / (1.0 - rho * rho)
}

/// Products of series with each other, of every series with those up to itself.
pub(super) fn among(series: &[Vec<f64>]) -> Vec<Vec<Products>> {
    let row = |a: usize| (0..=a).map(|b| products(&series[a], &series[b])).collect();
    (0..series.len()).map(row).collect()
}

/// Inner products of the first `count` of these series made white by that correlation.
pub(super) fn normal(among: &[Vec<Products>], count: usize, rho: f64) -> Symmetric {
    Symmetric::from_fn(count, |a, b| white(&among[a][b], rho))
}

/// Inner products of series that are white already.
pub(super) fn normal_of(series: &[Vec<f64>]) -> Symmetric {
    Symmetric::from_fn(series.len(), |a, b| inner(&series[a], &series[b]))
}

/// A series over the readings of a span in units of `scale`.
pub(super) fn scaled(series: &[f64], scale: &[f64]) -> Vec<f64> {
    series
        .iter()
        .zip(scale)
        .map(|(value, scale)| value / scale)
        .collect()
}
