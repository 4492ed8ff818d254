//! Inner products of design columns with each other and with the measured values, block by block.

use super::decay::{BLOCK, Column};
use super::sums;
use super::symmetric::Symmetric;

/// Most columns of a design.
pub const CAPACITY: usize = 10;

/// X'X, X'y and y'y of least squares. Summing block by block also keeps rounding small.
#[derive(Debug, Clone)]
pub struct Gram {
    /// X'X.
    pub matrix: Symmetric,
    /// X'y.
    pub right: [f64; CAPACITY],
    /// y'y.
    pub square: f64,
}

impl Gram {
    /// Empty sums for `columns` columns.
    pub fn new(columns: usize) -> Gram {
        Gram {
            matrix: Symmetric::zero(columns),
            right: [0.0; CAPACITY],
            square: 0.0,
        }
    }

    /// Adds the first `len` entries of a block; those up to the next multiple of eight must be zero.
    pub fn add_first(&mut self, len: usize, columns: &[Column], y: &Column) {
        let len = len.next_multiple_of(8).min(BLOCK);
        let dot = |a: &Column, b: &Column| sums::dot(&a[..len], &b[..len]);
        for (row, left) in columns.iter().enumerate() {
            for (column, right) in columns[..=row].iter().enumerate() {
                let sum = self.matrix.get(row, column) + dot(left, right);
                self.matrix.set(row, column, sum);
            }
            self.right[row] += dot(left, y);
        }
        self.square += dot(y, y);
    }

    /// The sums for the other columns with the last one's coefficient eliminated at its best value.
    pub fn eliminate_last(&self) -> Gram {
        let last = self.matrix.order() - 1;
        let own = self.matrix.get(last, last);
        let mut rest = Gram::new(last);
        rest.matrix = Symmetric::from_fn(last, |row, column| {
            self.matrix.get(row, column) - self.matrix.get(row, last) * self.matrix.get(column, last) / own
        });
        for k in 0..last {
            rest.right[k] = self.right[k] - self.matrix.get(k, last) * self.right[last] / own;
        }
        rest.square = self.square - self.right[last] * self.right[last] / own;
        rest
    }

    /// Sum of squared residuals for the coefficients `x`, which solve the normal equations where not zero.
    pub fn residual_square(&self, x: &[f64]) -> f64 {
        let explained: f64 = x.iter().zip(&self.right).map(|(x, right)| x * right).sum();
        (self.square - explained).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_and_residual_of_a_straight_line() {
        let ones = [1.0; BLOCK];
        let line: Column = std::array::from_fn(|k| k as f64);
        let y: Column = std::array::from_fn(|k| 2.0 + 3.0 * k as f64 + if k % 2 == 0 { 0.5 } else { -0.5 });
        let mut gram = Gram::new(2);
        gram.add_first(BLOCK, &[ones, line], &y);
        assert_eq!(gram.matrix.get(1, 0), 2016.0);
        let x = gram.matrix.cholesky(1e-12).unwrap().solve(&gram.right);
        let direct: f64 = (0..BLOCK).map(|k| (y[k] - x[0] - x[1] * line[k]).powi(2)).sum();
        assert!((gram.residual_square(&x) / direct - 1.0).abs() < 1e-9);
        let rest = gram.eliminate_last();
        let first = [rest.right[0] / rest.matrix.get(0, 0)];
        assert!((first[0] - x[0]).abs() < 1e-9);
        assert!((rest.residual_square(&first) / direct - 1.0).abs() < 1e-9);
    }
}
