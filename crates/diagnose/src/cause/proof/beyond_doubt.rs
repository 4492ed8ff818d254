//! Held-out readings beyond the doubt of what was predicted of them.
//!
//! A prediction is as uncertain as the parameters that the other readings leave open: with the slopes J of the held-out rows, in
//! units of the noise, and the normal matrix N of all others its errors have the covariance `I + J N⁻¹ J'`, in parts of what the
//! noise or the error of the model is. An error along what was left open speaks of no model: errors are made independent by the
//! inverse root of that covariance, and its determinant is what a wide prediction pays, so that none proves itself.

use ieap_numerics::sums::dot;
use ieap_numerics::symmetric::Symmetric;

use super::block_error::BlockError;
use super::predictive::{Predictive, kept};
use crate::readings::group::{Block, RunGroup};

/// Held-out readings as independent errors, and the doubt that was taken from them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BeyondDoubt {
    errors: Vec<BlockError>,
    /// Logarithm of the determinant of the covariance of the errors.
    doubt: f64,
}

impl BeyondDoubt {
    /// Of the rows that are `own` among those that are `out` of the fit that leaves these residuals.
    pub(crate) fn of(
        group: &RunGroup,
        predictive: &Predictive,
        residuals: &[f64],
        (out, own): (&[bool], &[bool]),
    ) -> BeyondDoubt {
        let others: Vec<bool> = own.iter().map(|is_own| !is_own).collect();
        let columns = predictive.columns().iter().map(|column| kept(column, &others));
        let mut errors = kept(&residuals[..group.rows()], &others);
        let columns: Vec<Vec<f64>> = columns.collect();
        let doubt = independent(&mut errors, &columns, &predictive.normal_without(out));
        let mut from = 0;
        let mut of_block = |block: &Block| {
            let count = own[block.first..block.end]
                .iter()
                .filter(|is_own| **is_own)
                .count();
            from += count;
            BlockError::new(errors[from - count..from].to_vec())
        };
        BeyondDoubt {
            errors: group.blocks.iter().filter_map(&mut of_block).collect(),
            doubt,
        }
    }

    /// Logarithm of the odds of this prediction over another one of the same readings.
    pub(crate) fn log_odds(&self, other: &BeyondDoubt) -> f64 {
        let pairs = self.errors.iter().zip(&other.errors);
        let of_errors: f64 = pairs.map(|(own, other)| own.log_odds(other)).sum();
        of_errors + 0.5 * (other.doubt - self.doubt)
    }
}

/// Makes errors of the covariance `I + J N⁻¹ J'` independent, and gives the logarithm of its determinant.
fn independent(errors: &mut [f64], columns: &[Vec<f64>], normal: &Symmetric) -> f64 {
    // Slopes along the directions in which N is 1, then those in which what they add is of one size each.
    let (precisions, directions) = normal.eigen();
    let floor = 1e-12 * precisions.iter().copied().fold(0.0, f64::max);
    let along = |columns: &[Vec<f64>], direction: &dyn Fn(usize) -> f64| {
        let mut sum = vec![0.0; errors.len()];
        for (k, column) in columns.iter().enumerate() {
            let part = direction(k);
            sum.iter_mut().zip(column).for_each(|(sum, v)| *sum += part * v);
        }
        sum
    };
    let of_one: Vec<Vec<f64>> = (0..columns.len())
        .map(|m| {
            let size = precisions[m].max(floor).max(f64::MIN_POSITIVE).sqrt();
            along(columns, &|k| directions[k][m] / size)
        })
        .collect();
    let added = Symmetric::from_fn(of_one.len(), |a, b| dot(&of_one[a], &of_one[b]));
    let (sizes, turned) = added.eigen();
    let each: Vec<Vec<f64>> = (0..of_one.len())
        .map(|m| along(&of_one, &|k| turned[k][m]))
        .collect();
    let mut determinant = 0.0;
    for (size, direction) in sizes.iter().zip(&each).filter(|(size, _)| **size > 0.0) {
        let part = ((1.0 + size).sqrt().recip() - 1.0) / size * dot(direction, errors);
        errors
            .iter_mut()
            .zip(direction)
            .for_each(|(error, v)| *error += part * v);
        determinant += size.ln_1p();
    }
    determinant
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The square of the independent errors is that by the inverse of the covariance, and the determinant is its own.
    #[test]
    fn errors_are_those_of_their_covariance() {
        let columns: Vec<Vec<f64>> = [0.3, 1.1]
            .iter()
            .map(|rate| (0..9).map(|k| (rate * f64::from(k)).cos() + rate).collect())
            .collect();
        let normal = Symmetric::from_fn(2, |a, b| if a == b { 0.5 + a as f64 } else { 0.2 });
        let inverse = normal.inverse(1e-12);
        let covariance = Symmetric::from_fn(9, |a, b| {
            let (of_a, of_b) = ([columns[0][a], columns[1][a]], [columns[0][b], columns[1][b]]);
            f64::from(u8::from(a == b)) + inverse.form(&of_a, &of_b)
        });
        let errors: Vec<f64> = (0..9).map(|k| (2.3 * f64::from(k)).sin()).collect();
        let expected = dot(&errors, &covariance.solve(&errors, 1e-14));
        let mut found = errors;
        let determinant = independent(&mut found, &columns, &normal);
        assert!((dot(&found, &found) - expected).abs() < 1e-9);
        assert!((determinant - covariance.log_determinant()).abs() < 1e-9);
    }
}
