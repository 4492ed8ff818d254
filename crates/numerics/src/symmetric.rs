//! Small symmetric matrices on the stack: Cholesky solution, eigenvalues by Jacobi rotations.

/// Largest order that fits.
pub const CAPACITY: usize = 10;

/// A symmetric matrix of order `n` up to [`CAPACITY`]; both triangles are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Symmetric {
    n: usize,
    entries: [[f64; CAPACITY]; CAPACITY],
}

impl Symmetric {
    /// The zero matrix of order `n`, at most [`CAPACITY`].
    pub fn zero(n: usize) -> Symmetric {
        debug_assert!(n <= CAPACITY);
        Symmetric {
            n: n.min(CAPACITY),
            entries: [[0.0; CAPACITY]; CAPACITY],
        }
    }

    /// The matrix whose entries `entry(row, column)` gives; asked for the lower triangle only.
    pub fn from_fn(n: usize, entry: impl Fn(usize, usize) -> f64) -> Symmetric {
        let mut matrix = Symmetric::zero(n);
        for row in 0..matrix.n {
            for column in 0..=row {
                matrix.set(row, column, entry(row, column));
            }
        }
        matrix
    }

    /// Order of the matrix.
    pub fn order(&self) -> usize {
        self.n
    }

    /// One entry.
    #[inline]
    pub fn get(&self, row: usize, column: usize) -> f64 {
        self.entries[row][column]
    }

    /// Sets an entry and its mirror image.
    #[inline]
    pub fn set(&mut self, row: usize, column: usize, value: f64) {
        self.entries[row][column] = value;
        self.entries[column][row] = value;
    }

    /// Product with a vector; entries of `x` beyond the order are not read.
    pub fn times(&self, x: &[f64]) -> [f64; CAPACITY] {
        let mut product = [0.0; CAPACITY];
        for (row, out) in product.iter_mut().enumerate().take(self.n) {
            *out = (0..self.n)
                .map(|column| self.entries[row][column] * x[column])
                .sum();
        }
        product
    }

    /// `x` transposed times the matrix times `y`.
    pub fn form(&self, x: &[f64], y: &[f64]) -> f64 {
        let product = self.times(y);
        (0..self.n).map(|row| x[row] * product[row]).sum()
    }

    /// The rows and columns in `keep`.
    pub fn part(&self, keep: &[usize]) -> Symmetric {
        Symmetric::from_fn(keep.len(), |row, column| self.get(keep[row], keep[column]))
    }

    /// Product of two symmetric matrices with a third between them: `self * middle * self`.
    pub fn sandwich(&self, middle: &Symmetric) -> Symmetric {
        let columns: [[f64; CAPACITY]; CAPACITY] = std::array::from_fn(|column| {
            if column < self.n {
                middle.times(&self.entries[column])
            } else {
                [0.0; CAPACITY]
            }
        });
        Symmetric::from_fn(self.n, |row, column| {
            (0..self.n)
                .map(|k| self.entries[row][k] * columns[column][k])
                .sum()
        })
    }

    /// Lower Cholesky factor, or none where a pivot falls below `relative` times its diagonal entry: the
    /// column is then a combination of earlier ones to that precision.
    pub fn cholesky(&self, relative: f64) -> Option<Cholesky> {
        let mut factor = [[0.0; CAPACITY]; CAPACITY];
        for row in 0..self.n {
            for column in 0..=row {
                let dot: f64 = (0..column).map(|k| factor[row][k] * factor[column][k]).sum();
                let rest = self.entries[row][column] - dot;
                if row > column {
                    factor[row][column] = rest / factor[column][column];
                } else if rest > relative * self.entries[row][row] && rest > 0.0 && rest.is_finite() {
                    factor[row][row] = rest.sqrt();
                } else {
                    return None;
                }
            }
        }
        Some(Cholesky { n: self.n, factor })
    }

    /// Eigenvalues and eigenvectors by cyclic Jacobi rotations: column `m` of the vectors belongs to value `m`.
    pub fn eigen(&self) -> ([f64; CAPACITY], [[f64; CAPACITY]; CAPACITY]) {
        let mut work = *self;
        let mut vectors = [[0.0; CAPACITY]; CAPACITY];
        for (k, row) in vectors.iter_mut().enumerate() {
            row[k] = 1.0;
        }
        // Convergence is quadratic: a handful of sweeps reaches rounding for these orders.
        for _ in 0..30 {
            let mut rotated = false;
            for p in 0..self.n {
                for q in p + 1..self.n {
                    rotated |= work.rotate(p, q, &mut vectors);
                }
            }
            if !rotated {
                break;
            }
        }
        (std::array::from_fn(|k| work.entries[k][k]), vectors)
    }

    /// One rotation that makes entry (p, q) zero; false where it is negligible already.
    fn rotate(&mut self, p: usize, q: usize, vectors: &mut [[f64; CAPACITY]; CAPACITY]) -> bool {
        let (app, aqq, apq) = (self.get(p, p), self.get(q, q), self.get(p, q));
        let negligible = apq.abs() <= f64::EPSILON * 0.01 * (app.abs() * aqq.abs()).sqrt();
        if negligible || !apq.is_finite() {
            return false;
        }
        let theta = (aqq - app) / (2.0 * apq);
        let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
        let c = 1.0 / t.hypot(1.0);
        let s = t * c;
        for k in 0..self.n {
            if k != p && k != q {
                let (akp, akq) = (self.get(k, p), self.get(k, q));
                self.set(k, p, c * akp - s * akq);
                self.set(k, q, s * akp + c * akq);
            }
        }
        self.set(p, p, app - t * apq);
        self.set(q, q, aqq + t * apq);
        self.set(p, q, 0.0);
        for row in vectors.iter_mut().take(self.n) {
            let (vp, vq) = (row[p], row[q]);
            row[p] = c * vp - s * vq;
            row[q] = s * vp + c * vq;
        }
        true
    }

    /// Inverse of a Gram matrix, with directions that it does not determine held at the relative precision
    /// `floor` of the scaled matrix instead of being lost: their variances come out huge, not absent.
    pub fn floored_inverse(&self, floor: f64) -> Symmetric {
        let scale: [f64; CAPACITY] = std::array::from_fn(|k| {
            let diagonal = self.entries[k][k];
            if diagonal > 0.0 && diagonal.is_finite() {
                diagonal.sqrt().recip()
            } else {
                0.0
            }
        });
        let scaled = Symmetric::from_fn(self.n, |row, column| {
            if scale[row] == 0.0 || scale[column] == 0.0 {
                return 0.0;
            }
            self.get(row, column) * scale[row] * scale[column]
        });
        let (values, vectors) = scaled.eigen();
        let inverse: [f64; CAPACITY] = std::array::from_fn(|k| values[k].max(floor).recip());
        Symmetric::from_fn(self.n, |row, column| {
            let sum: f64 = (0..self.n)
                .map(|k| vectors[row][k] * vectors[column][k] * inverse[k])
                .sum();
            sum * scale[row] * scale[column]
        })
    }
}

/// A Cholesky factor, ready to solve.
#[derive(Debug, Clone, Copy)]
pub struct Cholesky {
    n: usize,
    factor: [[f64; CAPACITY]; CAPACITY],
}

impl Cholesky {
    /// Solution of `A x = right`; entries beyond the order are zero.
    pub fn solve(&self, right: &[f64]) -> [f64; CAPACITY] {
        let mut x = [0.0; CAPACITY];
        for row in 0..self.n {
            let dot: f64 = (0..row).map(|k| self.factor[row][k] * x[k]).sum();
            x[row] = (right[row] - dot) / self.factor[row][row];
        }
        for row in (0..self.n).rev() {
            let dot: f64 = (row + 1..self.n).map(|k| self.factor[k][row] * x[k]).sum();
            x[row] = (x[row] - dot) / self.factor[row][row];
        }
        x
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
    fn eigenvectors_rebuild_the_matrix() {
        let matrix = hilbert(5);
        let (values, vectors) = matrix.eigen();
        for row in 0..5 {
            for column in 0..5 {
                let sum: f64 = (0..5)
                    .map(|k| values[k] * vectors[row][k] * vectors[column][k])
                    .sum();
                assert!((sum - matrix.get(row, column)).abs() < 1e-15);
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
}
