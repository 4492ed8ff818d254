//! One correlation for several channels: an instrument's noise is alike in all runs that it wrote, and all of them
//! together know its memory better than each alone.

use ieap_numerics::chance::chi_square_chance;

use super::tried::{CORRELATIONS, correlation_at, lowest};
use crate::joint::policy::DIFFERENT_BELOW;

/// Index of the lowest place of the sum of all curves, each minus twice a log likelihood.
pub(super) fn together(curves: &[&[f64]]) -> (f64, f64) {
    let sum: Vec<f64> = (0..=CORRELATIONS)
        .map(|k| curves.iter().map(|curve| curve[k]).sum())
        .collect();
    lowest(&sum)
}

/// The one correlation of all these curves; none where there is one only, or where they ask for different ones.
pub(super) fn shared(curves: &[&[f64]]) -> Option<f64> {
    let others = curves.len().checked_sub(1).filter(|others| *others > 0)?;
    let (index, depth) = together(curves);
    let alone: f64 = curves.iter().map(|curve| lowest(curve).1).sum();
    (chi_square_chance(depth - alone, others) > DIFFERENT_BELOW).then(|| correlation_at(index))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Minus twice the log likelihood of a normal estimate at that index.
    fn curve(at: f64, error: f64) -> Vec<f64> {
        (0..=CORRELATIONS)
            .map(|k| ((k as f64 - at) / error).powi(2))
            .collect()
    }

    #[test]
    fn alike_curves_share_their_mean_and_different_ones_nothing() {
        let [a, b, c] = [curve(30.2, 1.0), curve(31.2, 1.0), curve(40.0, 1.0)];
        assert!((lowest(&a).0 - 30.2).abs() < 1e-9 && lowest(&a).1.abs() < 1e-9);
        let found = shared(&[&a, &b]).unwrap();
        assert!((found - correlation_at(30.7)).abs() < 1e-9);
        assert_eq!(shared(&[&a, &c]), None);
        assert_eq!(shared(&[&a]), None);
        assert_eq!(shared(&[]), None);
    }
}
