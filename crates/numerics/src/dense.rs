//! Rectangular matrices, as far as sums over blocks of a mixed model need them.

use super::sums::add;
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
        let mut entries = Vec::with_capacity(rows * columns);
        for row in 0..rows {
            entries.extend((0..columns).map(|column| entry(row, column)));
        }
        Matrix {
            rows,
            columns,
            entries,
        }
    }

    /// The entry in `row` and `column`, both from 0.
    #[inline]
    pub fn get(&self, row: usize, column: usize) -> f64 {
        self.entries[row * self.columns + column]
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.entries[row * self.columns..(row + 1) * self.columns]
    }

    /// The entries of a row, to change them.
    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.entries[row * self.columns..(row + 1) * self.columns]
    }

    /// Adds another matrix of the same size.
    pub fn add_all(&mut self, other: &Matrix) {
        for (own, other) in self.entries.iter_mut().zip(&other.entries) {
            *own += other;
        }
    }

    /// The rows and columns in these ranges.
    pub fn part(&self, rows: std::ops::Range<usize>, columns: std::ops::Range<usize>) -> Matrix {
        let mut entries = Vec::with_capacity(rows.len() * columns.len());
        for row in rows.clone() {
            entries.extend_from_slice(&self.row(row)[columns.clone()]);
        }
        Matrix {
            rows: rows.len(),
            columns: columns.len(),
            entries,
        }
    }

    /// Rows for columns.
    pub fn transposed(&self) -> Matrix {
        Matrix::from_fn(self.columns, self.rows, |row, column| self.get(column, row))
    }

    /// Product with another matrix.
    pub fn times(&self, other: &Matrix) -> Matrix {
        let mut product = Matrix::zero(self.rows, other.columns);
        product.add_product(self, other);
        product
    }

    /// Adds the product of two others.
    pub fn add_product(&mut self, one: &Matrix, other: &Matrix) {
        for row in 0..self.rows {
            let of_row = self.row_mut(row);
            for (middle, &factor) in one.row(row).iter().enumerate() {
                if factor != 0.0 {
                    add(of_row, factor, other.row(middle));
                }
            }
        }
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

    /// Number of columns.
    pub fn count_columns(&self) -> usize {
        self.columns
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
