//! Products of columns, and columns made orthonormal.

use ieap_numerics::sums::add;

/// Columns made orthonormal over so many of their entries (Gram and Schmidt, twice); dependent ones fall out.
pub(super) fn orthonormal(columns: Vec<Vec<f64>>, over: usize) -> Vec<Vec<f64>> {
    let mut found: Vec<Vec<f64>> = Vec::new();
    let norm = |column: &[f64]| inner(&column[..over], &column[..over]).sqrt();
    for mut column in columns {
        let before = norm(&column);
        for _ in 0..2 {
            for shape in &found {
                let part = inner(&shape[..over], &column[..over]);
                add(&mut column, -part, shape);
            }
        }
        let norm = norm(&column);
        if norm > 1e-6 * before && norm.is_finite() {
            column.iter_mut().for_each(|c| *c /= norm);
            found.push(column);
        }
    }
    found
}

/// Inner product in eight running sums, which the compiler turns into vector instructions.
pub(super) fn inner(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (left, right) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = left
        .remainder()
        .iter()
        .zip(right.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (left, right) in left.zip(right) {
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum += left[lane] * right[lane];
        }
    }
    sums.iter().sum::<f64>() + rest
}
