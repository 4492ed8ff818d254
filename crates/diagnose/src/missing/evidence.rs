//! What a law with random weights says of residuals, in closed form.

use crate::cause::evidence::{Column, Process, SIZES, grid, log_mean};
use crate::fitting::tangent::Tangent;

/// The evidence of a law.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Evidence {
    /// Logarithm over that of nothing.
    pub(crate) log: f64,
    /// Precisions of the weights before any reading that are most probable.
    pub(crate) precisions: Vec<f64>,
}

/// Products of the columns of all weights, after a refit of the base.
pub(crate) fn process(columns: &[Vec<f64>], tangent: &Tangent, residuals: &[f64]) -> Process {
    let whole = |column: &Vec<f64>| Column::of(vec![(0, column.clone())]);
    Process::of(&columns.iter().map(whole).collect::<Vec<_>>(), tangent, residuals)
}

/// The evidence: of weights of one size, and of columns of one length, whichever; none where a refit takes up everything.
pub(crate) fn evidence(process: &Process) -> Option<Evidence> {
    if process.is_nothing() {
        return None;
    }
    let squares = process.squares();
    let most = squares.iter().copied().fold(0.0, f64::max);
    let even = vec![1.0; squares.len()];
    let lengths = squares
        .iter()
        .map(|square| square.max(1e-9 * most).sqrt())
        .collect();
    let of = |units: Vec<f64>| {
        let own = process.in_units(&units);
        let whole: f64 = own.squares().iter().sum();
        let own = own.of_unit_size()?;
        let at = |size: f64| {
            let (fall, width) = own.parts(size);
            let unit_size = |unit: &f64| (unit * whole.sqrt() / size).powi(2);
            Evidence {
                log: fall + width,
                precisions: units.iter().map(unit_size).collect(),
            }
        };
        Some(grid(SIZES).map(at).collect::<Vec<_>>())
    };
    let all: Vec<Evidence> = [even, lengths].into_iter().filter_map(of).flatten().collect();
    let logs: Vec<f64> = all.iter().map(|own| own.log).collect();
    let best = all.into_iter().max_by(|a, b| a.log.total_cmp(&b.log))?;
    Some(Evidence {
        log: log_mean(&logs),
        ..best
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One column: whichever way it is scaled, a Gaussian of one number.
    #[test]
    fn one_column_is_one_number() {
        let own = process(&[vec![3.0, 4.0, 0.0]], &Tangent::default(), &[18.0, 24.0, 1.0]);
        let expected: Vec<f64> = grid(SIZES)
            .map(|size| {
                let variance = 1.0 + size * size;
                0.5 * (900.0 * (1.0 - 1.0 / variance) - variance.ln())
            })
            .collect();
        let found = evidence(&own).unwrap();
        assert!((found.log - log_mean(&expected)).abs() < 1e-9);
        let (weights, fall) = own.most_probable(&[1e-12]);
        assert!((weights[0] - 6.0).abs() < 1e-9 && (fall - 900.0).abs() < 1e-6);
        assert!(evidence(&process(&[vec![0.0; 3]], &Tangent::default(), &[1.0; 3])).is_none());
    }

    /// A law that is the base's own parameter under another name is none, whatever rounding leaves of it.
    #[test]
    fn what_a_refit_takes_up_is_nothing() {
        let own: Vec<f64> = (0..50).map(|k| (-0.07 * f64::from(k)).exp()).collect();
        let other: Vec<f64> = (0..50).map(|k| 1.0 / (1.0 + f64::from(k))).collect();
        let both = |a: f64, b: f64| {
            own.iter()
                .zip(&other)
                .map(|(x, y)| a * x + b * y)
                .collect::<Vec<f64>>()
        };
        let tangent = Tangent::of(&[own.clone(), other.clone()]);
        let columns = [both(3.0, 1e-3), both(20.0, 0.7), vec![1e-10; 50]];
        let residuals: Vec<f64> = (0..50).map(|k| f64::from(k % 7) - 3.0).collect();
        assert!(evidence(&process(&columns, &tangent, &residuals)).is_none());
    }
}
