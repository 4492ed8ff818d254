//! A law that is a curve of textbooks: of two numbers, where a smooth curve has eight.
//!
//! What nature does is mostly simple, named or not. Without these a named equation would win by being short alone.

use ieap_numerics::sums::dot;

use crate::cause::evidence::{Parts, Process, SIZES, log_mean};

/// Where a law's smooth curve is most probable.
pub(super) struct Top<'a> {
    /// Its weights, and the precisions that they have before any reading.
    pub(super) weights: &'a [f64],
    pub(super) precisions: &'a [f64],
    /// What the penalised likelihood gains there.
    pub(super) fall: f64,
}

/// Numbers of a curve of textbooks: its size, and where or how it bends.
const NUMBERS: usize = 2;

/// What these curves together say, each of any size: the likelihood about the top of the smooth curve is a parabola over the
/// weights. None where nothing acts.
pub(super) fn simple(process: &Process, top: &Top, curves: &[&[f64]]) -> Option<Parts> {
    let known: Vec<f64> = (top.weights.iter().zip(top.precisions))
        .map(|(weight, precision)| weight * precision)
        .collect();
    let bent = process.times(top.weights);
    let slope: Vec<f64> = known.iter().zip(&bent).map(|(a, b)| a + b).collect();
    let at_none = top.fall - 0.5 * dot(&known, top.weights) - 0.5 * dot(&bent, top.weights);
    let of_curve = |curve: &&[f64]| {
        let (square, along) = (dot(&process.times(curve), curve), dot(&slope, curve));
        let size = along.abs() / square.sqrt();
        let fall = at_none + 0.5 * size * size;
        fall.is_finite().then(|| (fall, width(size)))
    };
    let all: Vec<(f64, f64)> = curves.iter().filter_map(of_curve).collect();
    let best = all.iter().map(|own| own.0).reduce(f64::max)?;
    let logs: Vec<f64> = all.iter().map(|(fall, width)| fall + width).collect();
    Some(Parts {
        fall: best,
        occam: log_mean(&logs) - best,
        free: NUMBERS,
    })
}

/// Logarithm of what the width of the peak leaves where a size, in its own standard deviations and of either sign, is as likely on
/// any part of a logarithmic scale.
fn width(size: f64) -> f64 {
    let density = 0.5 / (size.max(SIZES.0) * (SIZES.1 / SIZES.0).ln());
    (density * std::f64::consts::TAU.sqrt()).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::tangent::Tangent;
    use crate::missing::evidence::process;

    /// Two columns, a curve along one of them: the likelihood of it by itself, whatever the smooth curve was thought to be.
    #[test]
    fn a_curve_along_one_column_is_that_column() {
        let columns = [vec![3.0, 0.0, 1.0], vec![0.0, 2.0, 1.0]];
        let residuals = [30.0, 4.0, 7.0];
        let process = process(&columns, &Tangent::default(), &residuals);
        for precision in [1e-9, 0.1] {
            let precisions = [precision; 2];
            let (weights, first) = process.most_probable(&precisions);
            let top = Top {
                weights: &weights,
                precisions: &precisions,
                fall: 0.5 * first,
            };
            let found = simple(&process, &top, &[&[1.0, 0.0]]).unwrap();
            let size = dot(&columns[0], &residuals) / dot(&columns[0], &columns[0]).sqrt();
            assert!((found.fall - 0.5 * size * size).abs() < 1e-6, "{}", found.fall);
            assert!((found.occam - width(size)).abs() < 1e-9);
        }
    }
}
