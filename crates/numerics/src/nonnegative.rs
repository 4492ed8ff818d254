//! Least squares with coefficients that may not be negative, for a few columns.

use super::gram::{CAPACITY, Gram};

/// Pivot, relative to the diagonal, below which columns count as dependent.
const DEPENDENT: f64 = 1e-11;

/// Coefficients of the first `n` columns of `gram`, none negative, that leave the smallest sum of squares;
/// dependent columns are left out (zero).
///
/// The first try is the plain solution; where it is not admissible every set of active columns is tried,
/// which is exact and, for the three columns meant here, cheap.
pub fn nonnegative_least_squares(gram: &Gram, n: usize) -> [f64; CAPACITY] {
    let all = (1_usize << n) - 1;
    if let Some((x, _)) = solve_active(gram, all, n) {
        return x;
    }
    let mut best = ([0.0; CAPACITY], 0.0);
    for active in 1..all {
        if let Some((x, explained)) = solve_active(gram, active, n)
            && explained > best.1
        {
            best = (x, explained);
        }
    }
    best.0
}

/// Solution on the columns whose bits are set, and the sum of squares it explains; none where a coefficient
/// is negative or the columns are dependent.
fn solve_active(gram: &Gram, active: usize, n: usize) -> Option<([f64; CAPACITY], f64)> {
    let mut keep = [0; CAPACITY];
    let mut count = 0;
    for column in (0..n).filter(|column| active >> column & 1 == 1) {
        keep[count] = column;
        count += 1;
    }
    let keep = &keep[..count];
    let right: [f64; CAPACITY] =
        std::array::from_fn(|k| keep.get(k).map_or(0.0, |&column| gram.right[column]));
    let solution = gram.matrix.part(keep).cholesky(DEPENDENT)?.solve(&right);
    if !solution[..count].iter().all(|&value| value >= 0.0) {
        return None;
    }
    let mut x = [0.0; CAPACITY];
    for (value, &column) in solution.iter().zip(keep) {
        x[column] = *value;
    }
    let explained = (0..count).map(|k| solution[k] * right[k]).sum();
    Some((x, explained))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::symmetric::Symmetric;
    use proptest::prelude::*;

    proptest! {
        /// Karush-Kuhn-Tucker: no coefficient is negative, and no column left out would still help.
        #[test]
        fn optimality_conditions_hold(design in prop::array::uniform16(-1.0..1.0f64), y in prop::array::uniform8(-1.0..1.0f64)) {
            let column = |c: usize, r: usize| if c < 2 { design[8 * c + r] } else { 1.0 };
            let mut gram = Gram::new(3);
            gram.matrix = Symmetric::from_fn(3, |a, b| (0..8).map(|r| column(a, r) * column(b, r)).sum());
            for c in 0..3 {
                gram.right[c] = (0..8).map(|r| column(c, r) * y[r]).sum();
            }
            let x = nonnegative_least_squares(&gram, 3);
            let product = gram.matrix.times(&x);
            for c in 0..3 {
                let slope = gram.right[c] - product[c];
                prop_assert!(x[c] >= 0.0 && slope < 1e-7 && (x[c] == 0.0 || slope.abs() < 1e-7));
            }
        }
    }
}
