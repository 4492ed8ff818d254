//! A sum of squares and its local model: what one evaluation of a problem gives.

use crate::sums;
use crate::symmetric::Symmetric;

/// Sum of squares and its local model at one place, J being the derivatives of what is taken from the readings.
#[derive(Debug, Clone, PartialEq)]
pub struct Local {
    /// Sum of squared residuals.
    pub square: f64,
    /// J'r: the direction of descent, half of the negative gradient.
    pub descent: Vec<f64>,
    /// J'J.
    pub normal: Symmetric,
}

impl Local {
    /// Of no residuals yet, for `order` coordinates.
    pub fn zero(order: usize) -> Local {
        Local {
            square: 0.0,
            descent: vec![0.0; order],
            normal: Symmetric::zero(order),
        }
    }

    /// Of a place with that sum of squares that will not be taken.
    pub fn refused(square: f64, order: usize) -> Local {
        Local {
            square,
            ..Local::zero(order)
        }
    }

    /// Adds what is known of the last coordinates before any reading: that they are 0, with this inverse of their covariance
    /// times `weight`, at the place `at`.
    pub fn add_known_before(&mut self, inverse: &Symmetric, weight: f64, at: &[f64]) {
        let first = at.len() - inverse.order();
        let pull = inverse.times(&at[first..]);
        self.square += weight * sums::dot(&pull, &at[first..]);
        for (k, pull) in pull.iter().enumerate() {
            self.descent[first + k] -= weight * pull;
            for other in 0..=k {
                let entry = self.normal.get(first + k, first + other) + weight * inverse.get(k, other);
                self.normal.set(first + k, first + other, entry);
            }
        }
    }

    /// From residuals and the columns of J.
    pub fn of(residuals: &[f64], columns: &[impl AsRef<[f64]>]) -> Local {
        let column = |k: usize| columns[k].as_ref();
        Local {
            square: sums::dot(residuals, residuals),
            descent: (0..columns.len())
                .map(|k| sums::dot(column(k), residuals))
                .collect(),
            normal: Symmetric::from_fn(columns.len(), |a, b| sums::dot(column(a), column(b))),
        }
    }
}
