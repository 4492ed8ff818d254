//! Rectangular matrices, as far as sums over blocks of a mixed model need them.

use super::symmetric::Symmetric;

/// A matrix, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    entries: Vec<f64>,
}

impl Matrix {
    /// All entries zero.
    pub fn zero(rows: usize, columns: usize) -> Matrix {
        Matrix {
            rows,
            columns,
            entries: vec![0.0; rows * columns],
        }
    }

    /// The matrix whose entries `entry(row, column)` gives.
    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Matrix {
        let at = |k: usize| entry(k / columns.max(1), k % columns.max(1));
        Matrix {
            rows,
            columns,
            entries: (0..rows * columns).map(at).collect(),
        }
    }

    /// The entry in `row` and `column`, both from 0.
    #[inline]
    pub fn get(&self, row: usize, column: usize) -> f64 {
        self.entries[row * self.columns + column]
    }

    /// Adds to an entry.
    #[inline]
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.entries[row * self.columns + column] += value;
    }

    /// Adds another matrix of the same size.
    pub fn add_all(&mut self, other: &Matrix) {
        for (own, other) in self.entries.iter_mut().zip(&other.entries) {
            *own += other;
        }
    }

    /// The rows and columns in these ranges.
    pub fn part(&self, rows: std::ops::Range<usize>, columns: std::ops::Range<usize>) -> Matrix {
        Matrix::from_fn(rows.len(), columns.len(), |row, column| {
            self.get(rows.start + row, columns.start + column)
        })
    }

    /// Rows for columns.
    pub fn transposed(&self) -> Matrix {
        Matrix::from_fn(self.columns, self.rows, |row, column| self.get(column, row))
    }

    /// Product with another matrix.
    pub fn times(&self, other: &Matrix) -> Matrix {
        let mut product = Matrix::zero(self.rows, other.columns);
        for row in 0..self.rows {
            for middle in 0..self.columns {
                let factor = self.get(row, middle);
                if factor != 0.0 {
                    for column in 0..other.columns {
                        product.add(row, column, factor * other.get(middle, column));
                    }
                }
            }
        }
        product
    }

    /// Product with a vector.
    pub fn times_vector(&self, x: &[f64]) -> Vec<f64> {
        let of_row = |row: &[f64]| row.iter().zip(x).map(|(a, x)| a * x).sum();
        self.entries.chunks(self.columns.max(1)).map(of_row).collect()
    }

    /// Sum of the products of equal entries of this matrix and the transpose of the other: the trace of their product.
    pub fn trace_with(&self, other: &Matrix) -> f64 {
        let of_row = |row: usize| -> f64 {
            (0..self.columns)
                .map(|column| self.get(row, column) * other.get(column, row))
                .sum()
        };
        (0..self.rows).map(of_row).sum()
    }

    /// Number of rows.
    pub fn count_rows(&self) -> usize {
        self.rows
    }

    /// Sum of the diagonal.
    pub fn trace(&self) -> f64 {
        (0..self.rows.min(self.columns)).map(|k| self.get(k, k)).sum()
    }

    /// The mean of a square matrix and its transpose.
    pub fn symmetric(&self) -> Symmetric {
        Symmetric::from_fn(self.rows, |row, column| {
            0.5 * (self.get(row, column) + self.get(column, row))
        })
    }
}

impl From<&Symmetric> for Matrix {
    fn from(matrix: &Symmetric) -> Matrix {
        Matrix::from_fn(matrix.order(), matrix.order(), |row, column| {
            matrix.get(row, column)
        })
    }
}
