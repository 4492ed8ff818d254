//! Symmetric matrices of any order: Cholesky solutions, inverses that lose no direction, eigenvalues by Jacobi rotations.

use super::sums::dot;

/// A symmetric matrix, row by row; both triangles are kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetric {
    order: usize,
    entries: Vec<f64>,
}

impl Symmetric {
    /// All entries zero.
    pub fn zero(order: usize) -> Symmetric {
        Symmetric {
            order,
            entries: vec![0.0; order * order],
        }
    }

    /// The matrix whose entries `entry(row, column)` gives; asked for the lower triangle only.
    pub fn from_fn(order: usize, entry: impl Fn(usize, usize) -> f64) -> Symmetric {
        let mut matrix = Symmetric::zero(order);
        for row in 0..order {
            for column in 0..=row {
                matrix.set(row, column, entry(row, column));
            }
        }
        matrix
    }

    /// Number of rows, and of columns.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The entry in `row` and `column`, both from 0.
    #[inline]
    pub fn get(&self, row: usize, column: usize) -> f64 {
        self.entries[row * self.order + column]
    }

    /// Sets an entry and its mirror image.
    #[inline]
    pub fn set(&mut self, row: usize, column: usize, value: f64) {
        self.entries[row * self.order + column] = value;
        self.entries[column * self.order + row] = value;
    }

    /// Adds to one entry; the caller adds to its mirror image as well.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.entries[row * self.order + column] += value;
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.entries[row * self.order..(row + 1) * self.order]
    }

    /// Product with a vector; entries of `x` beyond the order are not read.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let of_row = |row: usize| self.row(row).iter().zip(x).map(|(a, x)| a * x).sum();
        (0..self.order).map(of_row).collect()
    }

    /// `x` transposed times the matrix times `y`.
    pub fn form(&self, x: &[f64], y: &[f64]) -> f64 {
        let of_row = |row: usize| -> f64 { self.row(row).iter().zip(y).map(|(a, y)| a * y).sum() };
        (0..self.order).map(|row| x[row] * of_row(row)).sum()
    }

    /// Standard error of coordinate `k`, where this is a covariance; 0 where rounding left nothing of its variance.
    pub fn error(&self, k: usize) -> f64 {
        self.get(k, k).max(0.0).sqrt()
    }

    /// The same of what goes with the coordinates by this gradient.
    pub fn error_along(&self, gradient: &[f64]) -> f64 {
        self.form(gradient, gradient).max(0.0).sqrt()
    }

    /// The rows and columns in `keep`.
    pub fn part(&self, keep: &[usize]) -> Symmetric {
        Symmetric::from_fn(keep.len(), |row, column| self.get(keep[row], keep[column]))
    }

    /// So many rows and columns, from the first.
    pub fn first(&self, count: usize) -> Symmetric {
        Symmetric::from_fn(count, |row, column| self.get(row, column))
    }

    /// Product of two symmetric matrices with a third between them: `self * middle * self`.
    pub fn sandwich(&self, middle: &Symmetric) -> Symmetric {
        let columns: Vec<Vec<f64>> = (0..self.order).map(|k| middle.times(self.row(k))).collect();
        Symmetric::from_fn(self.order, |row, column| {
            let products = self.row(row).iter().zip(&columns[column]);
            products.map(|(a, b)| a * b).sum()
        })
    }

    /// Lower Cholesky factor, or none where a pivot falls below `relative` times its diagonal entry: the
    /// column is then a combination of earlier ones to that precision.
    pub fn cholesky(&self, relative: f64) -> Option<Cholesky> {
        Cholesky::of(
            self.order,
            |row, column| self.get(row, column),
            |row, rest| {
                let holds = rest > relative * self.get(row, row) && rest > 0.0 && rest.is_finite();
                holds.then(|| rest.sqrt())
            },
        )
    }

    /// One over the roots of the diagonal; zero where that is no positive number.
    fn scale(&self) -> Vec<f64> {
        let root = |k: usize| {
            let diagonal = self.get(k, k);
            if diagonal > 0.0 && diagonal.is_finite() {
                diagonal.sqrt().recip()
            } else {
                0.0
            }
        };
        (0..self.order).map(root).collect()
    }

    /// The factor of the matrix scaled to a unit diagonal, each pivot held at `floor` at least.
    fn scaled(&self, floor: f64) -> Scaled {
        let scale = self.scale();
        let factor = Cholesky::of(
            self.order,
            |row, column| self.get(row, column) * scale[row] * scale[column],
            |_, rest| Some(rest.max(floor).sqrt()),
        );
        Scaled {
            factor: factor.unwrap_or_default(),
            scale,
        }
    }

    /// Solution of `A x = right`; directions that the matrix loses are held at the relative pivot `floor`.
    pub fn solve(&self, right: &[f64], floor: f64) -> Vec<f64> {
        self.scaled(floor).solve(right)
    }

    /// The inverse, with directions that the matrix loses held at the relative pivot `floor`.
    pub fn inverse(&self, floor: f64) -> Symmetric {
        let scaled = self.scaled(floor);
        let mut inverse = Symmetric::zero(self.order);
        let mut unit = vec![0.0; self.order];
        for column in 0..self.order {
            unit[column] = 1.0;
            let x = scaled.solve(&unit);
            unit[column] = 0.0;
            for (row, value) in x.into_iter().enumerate() {
                inverse.entries[row * self.order + column] = value;
            }
        }
        inverse
    }

    /// Logarithm of the determinant.
    pub fn log_determinant(&self) -> f64 {
        self.scaled(1e-14).log_determinant()
    }

    /// Solution of `A x = right`, as [`Symmetric::solve`] has it, and the logarithm of the determinant, by one factor.
    pub fn solve_with_log_determinant(&self, right: &[f64]) -> (Vec<f64>, f64) {
        let scaled = self.scaled(1e-14);
        (scaled.solve(right), scaled.log_determinant())
    }

    /// Eigenvalues and eigenvectors by cyclic Jacobi rotations, in no particular order: `vectors[row][m]` belongs to
    /// value `m`.
    pub fn eigen(&self) -> (Vec<f64>, Vec<Vec<f64>>) {
        let n = self.order;
        let mut work = self.clone();
        let unit = |row: usize| (0..n).map(|column| f64::from(u8::from(row == column))).collect();
        let mut vectors: Vec<Vec<f64>> = (0..n).map(unit).collect();
        // Convergence is quadratic after a few sweeps; the limit only stops a matrix that holds no numbers.
        for _ in 0..60 {
            let mut rotated = false;
            for p in 0..n {
                for q in p + 1..n {
                    rotated |= work.rotate(p, q, &mut vectors);
                }
            }
            if !rotated {
                break;
            }
        }
        ((0..n).map(|k| work.get(k, k)).collect(), vectors)
    }

    /// One rotation that makes entry (p, q) zero; false where it is negligible already.
    fn rotate(&mut self, p: usize, q: usize, vectors: &mut [Vec<f64>]) -> bool {
        let (app, aqq, apq) = (self.get(p, p), self.get(q, q), self.get(p, q));
        let negligible = apq.abs() <= f64::EPSILON * 0.01 * (app.abs() * aqq.abs()).sqrt();
        if negligible || !apq.is_finite() {
            return false;
        }
        let theta = (aqq - app) / (2.0 * apq);
        let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
        let c = 1.0 / t.hypot(1.0);
        let s = t * c;
        for k in (0..self.order).filter(|&k| k != p && k != q) {
            let (akp, akq) = (self.get(k, p), self.get(k, q));
            self.set(k, p, c * akp - s * akq);
            self.set(k, q, s * akp + c * akq);
        }
        self.set(p, p, app - t * apq);
        self.set(q, q, aqq + t * apq);
        self.set(p, q, 0.0);
        for row in vectors {
            let (vp, vq) = (row[p], row[q]);
            (row[p], row[q]) = (c * vp - s * vq, s * vp + c * vq);
        }
        true
    }

    /// Inverse of a Gram matrix, with directions that it does not determine held at the relative precision
    /// `floor` of the scaled matrix instead of being lost: their variances come out huge, not absent.
    pub fn floored_inverse(&self, floor: f64) -> Symmetric {
        let scale = self.scale();
        let scaled = Symmetric::from_fn(self.order, |row, column| {
            if scale[row] == 0.0 || scale[column] == 0.0 {
                return 0.0;
            }
            self.get(row, column) * scale[row] * scale[column]
        });
        let (values, vectors) = scaled.eigen();
        let inverse: Vec<f64> = values.iter().map(|value| value.max(floor).recip()).collect();
        Symmetric::from_fn(self.order, |row, column| {
            let sum: f64 = (0..self.order)
                .map(|k| vectors[row][k] * vectors[column][k] * inverse[k])
                .sum();
            sum * scale[row] * scale[column]
        })
    }
}

/// A lower Cholesky factor, ready to solve.
#[derive(Debug, Clone, Default)]
pub struct Cholesky {
    order: usize,
    entries: Vec<f64>,
}

impl Cholesky {
    /// Of the matrix with these entries; `pivot` gives the root of what is left of a diagonal entry, or none.
    fn of(
        order: usize,
        entry: impl Fn(usize, usize) -> f64,
        pivot: impl Fn(usize, f64) -> Option<f64>,
    ) -> Option<Cholesky> {
        let mut factor = Cholesky {
            order,
            entries: vec![0.0; order * order],
        };
        for row in 0..order {
            for column in 0..=row {
                let (own, other) = (factor.row(row), factor.row(column));
                let known: f64 = (own.iter().zip(other).take(column)).map(|(a, b)| a * b).sum();
                let rest = entry(row, column) - known;
                factor.entries[row * order + column] = if row == column {
                    pivot(row, rest)?
                } else {
                    rest / factor.get(column, column)
                };
            }
        }
        Some(factor)
    }

    fn get(&self, row: usize, column: usize) -> f64 {
        self.entries[row * self.order + column]
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.entries[row * self.order..(row + 1) * self.order]
    }

    /// Logarithm of the determinant of the matrix.
    pub fn log_determinant(&self) -> f64 {
        (0..self.order).map(|k| 2.0 * self.get(k, k).ln()).sum()
    }

    /// Puts the solution of `L x = right`, of the factor alone, into its place.
    pub fn solve_factor(&self, right: &mut [f64]) {
        for row in 0..self.order {
            let (before, rest) = right.split_at_mut(row);
            rest[0] = (rest[0] - dot(&self.row(row)[..row], before)) / self.get(row, row);
        }
    }

    /// Solution of `A x = right`.
    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        let n = self.order;
        let mut x = right[..n].to_vec();
        self.solve_factor(&mut x);
        for row in (0..n).rev() {
            let known: f64 = (row + 1..n).map(|k| self.get(k, row) * x[k]).sum();
            x[row] = (x[row] - known) / self.get(row, row);
        }
        x
    }
}

/// The factor of a matrix scaled to a unit diagonal, with the scale.
struct Scaled {
    factor: Cholesky,
    scale: Vec<f64>,
}

impl Scaled {
    fn log_determinant(&self) -> f64 {
        let each = self.scale.iter().enumerate();
        each.map(|(k, scale)| 2.0 * (self.factor.get(k, k) / scale.max(f64::MIN_POSITIVE)).ln())
            .sum()
    }

    fn solve(&self, right: &[f64]) -> Vec<f64> {
        let by_scale = |values: &[f64]| -> Vec<f64> {
            let pairs = values.iter().zip(&self.scale);
            pairs.map(|(value, scale)| value * scale).collect()
        };
        by_scale(&self.factor.solve(&by_scale(right)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hilbert(n: usize) -> Symmetric {
        Symmetric::from_fn(n, |row, column| 1.0 / (row + column + 1) as f64)
    }

    #[test]
    fn cholesky_solves_and_refuses_a_dependent_column() {
        let matrix = hilbert(4);
        let x = [1.0, -2.0, 3.0, 0.5];
        let found = matrix.cholesky(1e-14).unwrap().solve(&matrix.times(&x));
        for (a, b) in found.iter().zip(x) {
            assert!((a - b).abs() < 1e-11, "{a} {b}");
        }
        let dependent = Symmetric::from_fn(2, |_, _| 1.0);
        assert!(dependent.cholesky(1e-12).is_none());
    }

    #[test]
    fn eigenvectors_rebuild_the_matrix_and_are_orthonormal() {
        let matrix = hilbert(15);
        let (values, vectors) = matrix.eigen();
        for row in 0..15 {
            for column in 0..15 {
                let rebuilt: f64 = (0..15)
                    .map(|k| vectors[row][k] * vectors[column][k] * values[k])
                    .sum();
                assert!((rebuilt - matrix.get(row, column)).abs() < 1e-14);
                let product: f64 = (0..15).map(|k| vectors[k][row] * vectors[k][column]).sum();
                assert!((product - f64::from(u8::from(row == column))).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn floored_inverse_is_the_inverse_and_keeps_lost_directions_visible() {
        let matrix = hilbert(3);
        let inverse = matrix.floored_inverse(1e-13);
        for k in 0..3 {
            let mut unit = [0.0; 3];
            unit[k] = 1.0;
            let x = matrix.cholesky(1e-14).unwrap().solve(&unit);
            assert!((x[k] / inverse.get(k, k) - 1.0).abs() < 1e-10);
        }
        let singular = Symmetric::from_fn(2, |_, _| 4.0);
        assert!(singular.floored_inverse(1e-12).get(0, 0) > 1e10);
    }

    #[test]
    fn inverse_and_determinant_of_hilbert_matrices() {
        // det H_3 = 1/2160; the inverse of a Hilbert matrix has whole numbers.
        assert!((hilbert(3).log_determinant() + 2160.0_f64.ln()).abs() < 1e-10);
        let inverse = hilbert(4).inverse(1e-14);
        assert!(
            (inverse.get(0, 0) / 16.0 - 1.0).abs() < 1e-9 && (inverse.get(2, 3) / -4200.0 - 1.0).abs() < 1e-9
        );
    }
}
