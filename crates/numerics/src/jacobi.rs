//! Eigenvalues and eigenvectors of a symmetric matrix of any order by Jacobi rotations.

/// Eigenvalues and eigenvectors of the symmetric matrix of order `n` whose entries `entry(row, column)` gives for
/// the lower triangle: `vectors[row][m]` belongs to value `m`, in no particular order.
///
/// For matrices of up to `symmetric::CAPACITY` rows the stack version there is faster.
pub fn eigen(n: usize, entry: impl Fn(usize, usize) -> f64) -> (Vec<f64>, Vec<Vec<f64>>) {
    let at = |row: usize, column: usize| entry(row.max(column), row.min(column));
    let mut matrix: Vec<Vec<f64>> = (0..n)
        .map(|row| (0..n).map(|column| at(row, column)).collect())
        .collect();
    let unit = |row: usize| (0..n).map(|column| f64::from(u8::from(row == column))).collect();
    let mut vectors: Vec<Vec<f64>> = (0..n).map(unit).collect();
    // Convergence is quadratic after a few sweeps; the limit only stops a matrix that holds no numbers.
    for _ in 0..60 {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                rotated |= rotate(&mut matrix, &mut vectors, p, q);
            }
        }
        if !rotated {
            break;
        }
    }
    ((0..n).map(|k| matrix[k][k]).collect(), vectors)
}

/// One rotation that makes entry (p, q) zero; false where it is negligible already.
fn rotate(matrix: &mut [Vec<f64>], vectors: &mut [Vec<f64>], p: usize, q: usize) -> bool {
    let (app, aqq, apq) = (matrix[p][p], matrix[q][q], matrix[p][q]);
    let negligible = apq.abs() <= f64::EPSILON * 0.01 * (app.abs() * aqq.abs()).sqrt();
    if negligible || !apq.is_finite() {
        return false;
    }
    let theta = (aqq - app) / (2.0 * apq);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for k in (0..matrix.len()).filter(|&k| k != p && k != q) {
        let (akp, akq) = (matrix[k][p], matrix[k][q]);
        (matrix[k][p], matrix[k][q]) = (c * akp - s * akq, s * akp + c * akq);
        (matrix[p][k], matrix[q][k]) = (matrix[k][p], matrix[k][q]);
    }
    matrix[p][p] = app - t * apq;
    matrix[q][q] = aqq + t * apq;
    (matrix[p][q], matrix[q][p]) = (0.0, 0.0);
    for row in vectors {
        let (vp, vq) = (row[p], row[q]);
        (row[p], row[q]) = (c * vp - s * vq, s * vp + c * vq);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::symmetric::Symmetric;

    #[test]
    fn eigenvectors_rebuild_the_matrix_and_are_orthonormal() {
        let hilbert = |row: usize, column: usize| 1.0 / (row + column + 1) as f64;
        let (values, vectors) = eigen(15, hilbert);
        for row in 0..15 {
            for column in 0..15 {
                let rebuilt: f64 = (0..15)
                    .map(|k| vectors[row][k] * vectors[column][k] * values[k])
                    .sum();
                assert!((rebuilt - hilbert(row, column)).abs() < 1e-14);
                let product: f64 = (0..15).map(|k| vectors[k][row] * vectors[k][column]).sum();
                assert!((product - f64::from(u8::from(row == column))).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn small_matrices_have_the_values_of_the_stack_version() {
        let entry = |row: usize, column: usize| 1.0 / (row + column + 1) as f64;
        let (values, _) = eigen(6, entry);
        let (expected, _) = Symmetric::from_fn(6, entry).eigen();
        for (a, b) in values.iter().zip(expected) {
            assert!((a - b).abs() < 1e-15, "{a} {b}");
        }
    }
}
