//! What columns with random coefficients say of residuals, in closed form.

use ieap_numerics::sums::dot;
use ieap_numerics::symmetric::Symmetric;

use super::policy::{GRID, SIZES};
use crate::fitting::tangent::Tangent;

/// Products of columns, after a refit of the base, with each other and with the residuals.
pub(crate) struct Products {
    gram: Symmetric,
    with_residuals: Vec<f64>,
}

/// The evidence of a process.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Evidence {
    /// Logarithm over that of nothing.
    pub(crate) log: f64,
    /// Precisions of the coefficients before any reading that are most probable.
    pub(crate) precisions: Vec<f64>,
}

impl Products {
    pub(crate) fn of(columns: &[Vec<f64>], tangent: &Tangent, residuals: &[f64]) -> Products {
        let basis = tangent.basis();
        let mut left = residuals.to_vec();
        tangent.remove(&mut left);
        let absorbed: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| basis.iter().map(|q| dot(column, q)).collect())
            .collect();
        Products {
            gram: Symmetric::from_fn(columns.len(), |a, b| {
                dot(&columns[a], &columns[b]) - dot(&absorbed[a], &absorbed[b])
            }),
            with_residuals: columns.iter().map(|column| dot(column, &left)).collect(),
        }
    }

    /// Squares of the columns' lengths after the refit.
    pub(crate) fn squares(&self) -> Vec<f64> {
        (0..self.gram.order())
            .map(|k| self.gram.get(k, k).max(0.0))
            .collect()
    }

    /// The coefficients that are most probable with these precisions, and what they make the penalised sum of squares fall by.
    pub(crate) fn most_probable(&self, precisions: &[f64]) -> (Vec<f64>, f64) {
        let mut normal = self.gram.clone();
        for (k, precision) in precisions.iter().enumerate() {
            normal.add(k, k, *precision);
        }
        let found = normal.solve(&self.with_residuals, 1e-14);
        let fall = dot(&found, &self.with_residuals);
        (found, fall)
    }

    /// The evidence: of coefficients of one size, and of columns of one length, whichever; none where a refit takes up
    /// everything.
    pub(crate) fn evidence(&self) -> Option<Evidence> {
        let squares = self.squares();
        let most = squares.iter().copied().fold(0.0, f64::max);
        if !(most > 1e-12 && most.is_finite()) {
            return None;
        }
        let even = vec![1.0; squares.len()];
        let lengths = squares
            .iter()
            .map(|square| square.max(1e-9 * most).sqrt())
            .collect();
        let of = |units: Vec<f64>| {
            let gram = Symmetric::from_fn(units.len(), |a, b| self.gram.get(a, b) / (units[a] * units[b]));
            let pulls: Vec<f64> = (self.with_residuals.iter().zip(&units))
                .map(|(b, unit)| b / unit)
                .collect();
            let whole: f64 = (0..units.len()).map(|k| gram.get(k, k)).sum();
            let at = |size: f64| {
                let part = size / whole.sqrt();
                let normal = Symmetric::from_fn(units.len(), |a, b| {
                    part * part * gram.get(a, b) + f64::from(u8::from(a == b))
                });
                let right: Vec<f64> = pulls.iter().map(|pull| part * pull).collect();
                let explained = dot(&normal.solve(&right, 1e-14), &right);
                Evidence {
                    log: 0.5 * (explained - normal.log_determinant()),
                    precisions: units.iter().map(|unit| (unit / part).powi(2)).collect(),
                }
            };
            grid().map(at).collect::<Vec<_>>()
        };
        let all: Vec<Evidence> = [even, lengths].into_iter().flat_map(of).collect();
        let logs: Vec<f64> = all.iter().map(|own| own.log).collect();
        let best = all.into_iter().max_by(|a, b| a.log.total_cmp(&b.log))?;
        Some(Evidence {
            log: log_mean(&logs),
            ..best
        })
    }
}

/// Sizes that are thought of.
pub(crate) fn grid() -> impl Iterator<Item = f64> {
    let step = (SIZES.1 / SIZES.0).ln() / (GRID - 1) as f64;
    (0..GRID).map(move |k| SIZES.0 * (step * k as f64).exp())
}

/// Logarithm of the mean of what has these logarithms.
pub(crate) fn log_mean(logs: &[f64]) -> f64 {
    log_sum(logs.iter().copied()) - (logs.len() as f64).ln()
}

/// Logarithm of the sum of what has these logarithms.
pub(crate) fn log_sum(logs: impl Iterator<Item = f64> + Clone) -> f64 {
    let most = logs.clone().fold(f64::NEG_INFINITY, f64::max);
    if most.is_finite() {
        most + logs.map(|log| (log - most).exp()).sum::<f64>().ln()
    } else {
        f64::NEG_INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One column: whichever way it is scaled, a Gaussian of one number.
    #[test]
    fn one_column_is_one_number() {
        let column = vec![3.0, 4.0, 0.0];
        let residuals = [18.0, 24.0, 1.0];
        let products = Products::of(&[column], &Tangent::default(), &residuals);
        let expected: Vec<f64> = grid()
            .map(|size| {
                let variance = 1.0 + size * size;
                0.5 * (900.0 * (1.0 - 1.0 / variance) - variance.ln())
            })
            .collect();
        let found = products.evidence().unwrap();
        assert!((found.log - log_mean(&expected)).abs() < 1e-9);
        let (weights, fall) = products.most_probable(&[1e-12]);
        assert!((weights[0] - 6.0).abs() < 1e-9 && (fall - 900.0).abs() < 1e-6);
    }
}
