//! Least squares with coefficients that may not be negative, for any number of columns: the active set method of Lawson
//! and Hanson (Solving Least Squares Problems, 1974, chapter 23), on the normal equations.

use super::sums::peak;
use super::symmetric::Symmetric;

/// A slope, relative to the largest, below which a column would no longer help.
const NO_SLOPE: f64 = 1e-10;

/// Coefficients x, none negative, with the lowest x' M x / 2 - r' x; `matrix` M is positive definite.
///
/// A column whose pivot falls below the part `dependent` of its diagonal hangs on those taken before it and gets 0. The plain
/// solution is tried first, which of a few columns is mostly the one. The method ends after three rounds for each column at the latest,
/// where rounding lets it turn in a circle.
pub fn nonnegative(matrix: &Symmetric, right: &[f64], dependent: f64) -> Vec<f64> {
    let plain = matrix.cholesky(dependent).map(|factor| factor.solve(right));
    if let Some(plain) = plain.filter(|x| x.iter().all(|value| *value >= 0.0)) {
        return plain;
    }
    let count = matrix.order();
    let largest = peak(right);
    let mut x = vec![0.0; count];
    let mut taken = vec![false; count];
    let mut refused = vec![false; count];
    for _ in 0..3 * count {
        let product = matrix.times(&x);
        let steepest = (0..count)
            .filter(|&k| !taken[k] && !refused[k])
            .map(|k| (k, right[k] - product[k]))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((next, _)) = steepest.filter(|(_, slope)| *slope > NO_SLOPE * largest) else {
            break;
        };
        taken[next] = true;
        match settled(matrix, right, dependent, &mut taken, &x, next) {
            Some(found) => (x, refused) = (found, vec![false; count]),
            None => (taken[next], refused[next]) = (false, true),
        }
    }
    x
}

/// The solution on the taken columns, of which those that would become negative are given up one after the other; none
/// where the columns are dependent, or the new one is given up at once.
fn settled(
    matrix: &Symmetric,
    right: &[f64],
    dependent: f64,
    taken: &mut [bool],
    x: &[f64],
    next: usize,
) -> Option<Vec<f64>> {
    let mut x = x.to_vec();
    let mut is_first = true;
    loop {
        let keep: Vec<usize> = (0..taken.len()).filter(|k| taken[*k]).collect();
        let of_kept: Vec<f64> = keep.iter().map(|&k| right[k]).collect();
        let solved = matrix.part(&keep).cholesky(dependent)?.solve(&of_kept);
        let is_new = |k: usize, value: f64| k == next && is_first && value <= 0.0;
        if keep.iter().zip(&solved).any(|(&k, value)| is_new(k, *value)) {
            return None;
        }
        is_first = false;
        // How far to go towards the solution before the first coefficient is zero.
        let way = keep.iter().zip(&solved).filter(|(_, value)| **value <= 0.0);
        let way = way
            .map(|(&k, value)| x[k] / (x[k] - value))
            .fold(1.0_f64, f64::min);
        for (&k, value) in keep.iter().zip(&solved) {
            x[k] += way * (value - x[k]);
        }
        if way >= 1.0 && solved.iter().all(|value| *value > 0.0) {
            return Some(x);
        }
        for (&k, value) in keep.iter().zip(&solved) {
            if *value <= 0.0 && x[k] <= f64::EPSILON * value.abs() {
                (taken[k], x[k]) = (false, 0.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Karush-Kuhn-Tucker: no coefficient is negative, and no column left out would still help.
        #[test]
        fn optimality_conditions_hold(
            design in prop::collection::vec(-1.0..1.0f64, 12 * 20),
            y in prop::collection::vec(-1.0..1.0f64, 20),
        ) {
            let column = |c: usize| &design[20 * c..20 * (c + 1)];
            let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
            let matrix = Symmetric::from_fn(12, |a, b| dot(column(a), column(b)));
            let right: Vec<f64> = (0..12).map(|c| dot(column(c), &y)).collect();
            let x = nonnegative(&matrix, &right, 1e-13);
            let product = matrix.times(&x);
            for c in 0..12 {
                let slope = right[c] - product[c];
                prop_assert!(x[c] >= 0.0 && slope < 1e-7 && (x[c] == 0.0 || slope.abs() < 1e-7));
            }
        }
    }
}
