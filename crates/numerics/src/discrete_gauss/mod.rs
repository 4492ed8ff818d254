//! Gauss quadrature for a sum over readings: a few nodes that stand for many readings of a smooth curve.
//!
//! Over n readings at times t_j the polynomials orthonormal under `SUM_j p(t_j) q(t_j)` have a Gauss rule of m
//! nodes, exact to degree 2m-1. With the node values `SUM_k p_k(node) SUM_j p_k(t_j) y_j` in place of the
//! readings, every inner product of least squares that has polynomials below degree m in it stays what it
//! was (Golub and Welsch 1969; Gautschi 2004, chapter 2).

mod even;
mod recurrence;

use even::even_sums;
use recurrence::Recurrence;

pub use recurrence::NODES;

/// Readings below which compressing them gains nothing.
pub const FEWEST: usize = 4 * NODES;

/// What stands for a stretch of readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compressed {
    /// Times of the nodes, increasing.
    pub at: [f64; NODES],
    /// Number of readings that each node stands for; not whole.
    pub weights: [f64; NODES],
    /// Values of the nodes.
    pub values: [f64; NODES],
}

/// Nodes for the readings `values` at `at` (increasing, [`FEWEST`] at least, with that even spacing where there
/// is one); none where the times are so uneven that rounding spoils the polynomials.
pub fn compress(at: &[f64], values: &[f64], step: Option<f64>) -> Option<Compressed> {
    let (first, last) = (*at.first()?, *at.last()?);
    let centre = 0.5 * (first + last);
    let half = 0.5 * (last - first);
    if at.len() < FEWEST || half <= 0.0 || !half.is_finite() {
        return None;
    }
    let mut recurrence = Recurrence::constant(at.len());
    let sums = match step {
        Some(_) => {
            recurrence.of_even_spacing(at.len());
            even_sums(&recurrence, values)
        }
        None => {
            let place: Vec<f64> = at.iter().map(|t| (t - centre) / half).collect();
            recurrence.stieltjes(&place, values)?
        }
    };
    let nodes = match step {
        Some(_) => recurrence.symmetric_nodes(at.len()),
        None => recurrence.nodes()?,
    };
    let mut found = Compressed {
        at: nodes.map(|x| centre + half * x),
        weights: [0.0; NODES],
        values: [0.0; NODES],
    };
    for (k, &x) in nodes.iter().enumerate() {
        let p = recurrence.polynomials(x);
        found.weights[k] = p.iter().map(|v| v * v).sum::<f64>().recip();
        found.values[k] = p.iter().zip(&sums).map(|(p, s)| p * s).sum();
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Relative difference of SUM x y and SUM x x' between the readings and the nodes, for a decay `rate`.
    fn difference(at: &[f64], values: &[f64], found: &Compressed, rate: f64) -> (f64, f64) {
        let scale: f64 = values.iter().map(|y| y * y).sum::<f64>().sqrt();
        let all: f64 = at.iter().map(|t| (-2.0 * rate * t).exp()).sum();
        let direct: f64 = at.iter().zip(values).map(|(t, y)| (-rate * t).exp() * y).sum();
        let (mut product, mut square) = (0.0, 0.0);
        for k in 0..NODES {
            let x = (-rate * found.at[k]).exp();
            product += found.weights[k] * x * found.values[k];
            square += found.weights[k] * x * x;
        }
        let readings = at.len() as f64;
        (
            (product - direct).abs() / (scale * readings.sqrt()),
            (square - all).abs() / readings,
        )
    }

    #[test]
    fn inner_products_with_every_decay_are_kept_over_an_octave() {
        for n in [FEWEST, 77, 383, 384, 500, 4000, 20_001] {
            let at: Vec<f64> = (0..n).map(|k| 1.0 + k as f64 / n as f64).collect();
            let noisy: Vec<f64> = (0..n).map(|k| ((k * k) as f64).sin() + at[k]).collect();
            for step in [Some(1.0 / n as f64), None] {
                let found = compress(&at, &noisy, step).unwrap();
                let mut worst = (0.0_f64, 0.0_f64);
                for power in -40..60 {
                    let (product, square) =
                        difference(&at, &noisy, &found, 10.0_f64.powf(power as f64 / 20.0));
                    worst = (worst.0.max(product), worst.1.max(square));
                }
                assert!(worst.0 < 2e-8 && worst.1 < 1e-13, "{n} {step:?}: {worst:?}");
                let total: f64 = found.weights.iter().sum();
                assert!((total / n as f64 - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn what_cannot_be_compressed_is_refused() {
        let same = [1.0; FEWEST];
        assert_eq!(compress(&same, &same, None), None);
        assert_eq!(compress(&[1.0, 2.0], &[1.0, 2.0], None), None);
        let mut clustered: Vec<f64> = (0..FEWEST).map(|k| 1.0 + 1e-9 * k as f64).collect();
        clustered.push(2.0);
        assert_eq!(compress(&clustered, &clustered, None), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// However uneven the times, what is not refused is right.
        #[test]
        fn uneven_times(steps in prop::collection::vec((0.001..1.0f64, -3..1i32), FEWEST..200), rate in 0.01..30.0f64) {
            let total: f64 = steps.iter().map(|(step, power)| step * 10.0_f64.powi(*power)).sum();
            let mut now = 1.0;
            let mut at = Vec::new();
            for (step, power) in &steps {
                at.push(now);
                now += step * 10.0_f64.powi(*power) / total;
            }
            let values: Vec<f64> = (0..at.len()).map(|k| ((k * k) as f64).cos()).collect();
            if let Some(found) = compress(&at, &values, None) {
                let (product, square) = difference(&at, &values, &found, rate);
                prop_assert!(product < 2e-8 && square < 1e-11, "{product} {square}");
            }
        }
    }
}
