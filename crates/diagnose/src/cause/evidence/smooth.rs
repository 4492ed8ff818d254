//! Gaussian processes of few columns: what they explain and what they cost, in closed form.

use ieap_numerics::sums::dot;
use ieap_numerics::symmetric::Symmetric;

use super::policy::NOTHING;
use crate::fitting::tangent::{DEPENDENT, Tangent};

/// A column of whitened readings, as pieces that begin at a row.
pub(crate) struct Column {
    pieces: Vec<(usize, Vec<f64>)>,
}

impl Column {
    pub(crate) fn of(pieces: Vec<(usize, Vec<f64>)>) -> Column {
        Column { pieces }
    }

    fn with(&self, series: &[f64]) -> f64 {
        let piece = |(first, values): &(usize, Vec<f64>)| dot(values, &series[*first..first + values.len()]);
        self.pieces.iter().map(piece).sum()
    }

    fn with_column(&self, other: &Column) -> f64 {
        let mut sum = 0.0;
        for (first, values) in &self.pieces {
            if let Some((_, others)) = other.pieces.iter().find(|(begin, _)| begin == first) {
                sum += dot(values, others);
            }
        }
        sum
    }
}

/// What columns with random coefficients of one size say of residuals, after a refit.
#[derive(Clone)]
pub(crate) struct Process {
    products: Symmetric,
    with_residuals: Vec<f64>,
}

impl Process {
    pub(crate) fn of(columns: &[Column], tangent: &Tangent, residuals: &[f64]) -> Process {
        let mut left = residuals.to_vec();
        tangent.remove(&mut left);
        let absorbed: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| tangent.basis().iter().map(|q| column.with(q)).collect())
            .collect();
        let products = Symmetric::from_fn(columns.len(), |a, b| {
            columns[a].with_column(&columns[b]) - dot(&absorbed[a], &absorbed[b])
        });
        let mut process = Process {
            with_residuals: columns.iter().map(|column| column.with(&left)).collect(),
            products,
        };
        for (k, column) in columns.iter().enumerate() {
            // What is left of it is the rounding of what was taken off.
            if process.products.get(k, k) <= DEPENDENT * DEPENDENT * column.with_column(column) {
                process.forget(k);
            }
        }
        process
    }

    /// Makes a column one that acts on nothing.
    fn forget(&mut self, column: usize) {
        self.with_residuals[column] = 0.0;
        (0..self.products.order()).for_each(|other| self.products.set(column, other, 0.0));
    }

    /// The same with columns of such a size that one of amplitude `d` leaves `d` standard deviations on average; none where
    /// a refit takes up everything.
    pub(crate) fn of_unit_size(mut self) -> Option<Process> {
        let order = self.products.order();
        let trace: f64 = (0..order).map(|k| self.products.get(k, k)).sum();
        if !(trace > NOTHING && trace.is_finite()) {
            return None;
        }
        self.products = Symmetric::from_fn(order, |a, b| self.products.get(a, b) / trace);
        self.with_residuals.iter_mut().for_each(|v| *v /= trace.sqrt());
        Some(self)
    }

    /// Whether a refit takes up everything.
    pub(crate) fn is_nothing(&self) -> bool {
        self.squares().iter().sum::<f64>() <= NOTHING
    }

    /// Squares of the columns' lengths after the refit.
    pub(crate) fn squares(&self) -> Vec<f64> {
        let each = 0..self.products.order();
        each.map(|k| self.products.get(k, k).max(0.0)).collect()
    }

    /// The same with every column in parts of its unit.
    pub(crate) fn in_units(&self, units: &[f64]) -> Process {
        let scaled = |a: usize, b: usize| self.products.get(a, b) / (units[a] * units[b]);
        let each = self.with_residuals.iter().zip(units);
        Process {
            products: Symmetric::from_fn(units.len(), scaled),
            with_residuals: each.map(|(v, unit)| v / unit).collect(),
        }
    }

    /// Products of every column with the columns of these coefficients together.
    pub(crate) fn times(&self, coefficients: &[f64]) -> Vec<f64> {
        self.products.times(coefficients)
    }

    /// The coefficients that are most probable with these precisions, and what they make the penalised sum of squares fall by.
    pub(crate) fn most_probable(&self, precisions: &[f64]) -> (Vec<f64>, f64) {
        let mut normal = self.products.clone();
        for (k, precision) in precisions.iter().enumerate() {
            normal.add(k, k, *precision);
        }
        let found = normal.solve(&self.with_residuals, 1e-14);
        let fall = dot(&found, &self.with_residuals);
        (found, fall)
    }

    /// The same where every square is divided by `t`: in noise of so much larger a variance.
    pub(crate) fn broadened(&self, t: f64) -> Process {
        let order = self.products.order();
        Process {
            products: Symmetric::from_fn(order, |a, b| self.products.get(a, b) / t),
            with_residuals: self.with_residuals.iter().map(|v| v / t).collect(),
        }
    }

    /// What the likelihood gains, and what the widths cost.
    pub(crate) fn parts(&self, amplitude: f64) -> (f64, f64) {
        let order = self.products.order();
        if amplitude == 0.0 || order == 0 {
            return (0.0, 0.0);
        }
        let unit = |a, b| f64::from(u8::from(a == b));
        let precision = Symmetric::from_fn(order, |a, b| {
            amplitude * amplitude * self.products.get(a, b) + unit(a, b)
        });
        let right: Vec<f64> = self.with_residuals.iter().map(|v| amplitude * v).collect();
        let explained = dot(&precision.solve(&right, 1e-14), &right);
        (0.5 * explained, -0.5 * precision.log_determinant())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_of_one_column_is_a_gaussian_of_one_number() {
        let column = Column::of(vec![(1, vec![3.0, 4.0])]);
        let residuals = [9.0, 6.0, 8.0, -5.0];
        let process = Process::of(&[column], &Tangent::default(), &residuals);
        // y = c x + noise: the likelihood ratio of variance 1 + a^2 25 and of 1 along the unit column, at y = 10.
        let a: f64 = 0.7;
        let variance = 1.0 + a * a * 25.0;
        let expected = -0.5 * variance.ln() + 0.5 * 100.0 * (1.0 - 1.0 / variance);
        let (fall, width) = process.parts(a);
        assert!((fall + width - expected).abs() < 1e-9);
        assert_eq!(process.parts(0.0), (0.0, 0.0));
        let wide = 1.0 + a * a * 25.0 / 4.0;
        let (fall, width) = process.broadened(4.0).parts(a);
        assert!(
            (fall - 0.5 * 25.0 * (1.0 - 1.0 / wide)).abs() < 1e-9 && (width + 0.5 * wide.ln()).abs() < 1e-9
        );
    }
}
