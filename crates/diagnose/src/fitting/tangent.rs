//! What the parameters of a model can take up: the span of its Jacobian.

use ieap_numerics::sums::{add, dot};

/// A column whose part beyond the columns before it is smaller than this adds nothing.
pub(crate) const DEPENDENT: f64 = 1e-7;

/// An orthonormal basis of the directions that a refit absorbs.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tangent {
    basis: Vec<Vec<f64>>,
}

impl Tangent {
    /// The span of a Jacobian's columns.
    pub(crate) fn of(jacobian: &[Vec<f64>]) -> Tangent {
        let mut tangent = Tangent::default();
        for column in jacobian {
            tangent.add(column.clone());
        }
        tangent
    }

    /// Adds a direction.
    pub(crate) fn add(&mut self, mut column: Vec<f64>) {
        let whole = dot(&column, &column).sqrt();
        if !(whole > 0.0 && whole.is_finite()) {
            return;
        }
        // Twice: the second pass removes what rounding left of the first.
        self.remove(&mut column);
        self.remove(&mut column);
        let left = dot(&column, &column).sqrt();
        if left > DEPENDENT * whole {
            column.iter_mut().for_each(|v| *v /= left);
            self.basis.push(column);
        }
    }

    /// The directions, orthonormal.
    pub(crate) fn basis(&self) -> &[Vec<f64>] {
        &self.basis
    }

    /// Takes out of `series` what lies in the span.
    pub(crate) fn remove(&self, series: &mut [f64]) {
        for direction in &self.basis {
            let part = dot(direction, series);
            add(series, -part, direction);
        }
    }
}
