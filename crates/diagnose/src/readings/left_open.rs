//! What is not known of a run beyond the model of its group, taken out of whitened residuals: a change that an edge in another
//! place between its two readings would make, or a parameter that scatters from run to run, says nothing against the model.

use ieap_numerics::sums::{self, dot};

/// Changes of a run's whitened rows by one standard deviation of what is not known of it, integrated out: their part of the
/// residuals has the variance of the noise and of these together, and is brought back to that of the noise.
#[derive(Debug, Clone, Default)]
pub(crate) struct LeftOpen {
    /// Unit directions, with the part of each that is taken out.
    directions: Vec<(Vec<f64>, f64)>,
}

/// A change below this square, in variances of the noise, is not worth its row by row subtraction.
const NEGLIGIBLE: f64 = 1e-4;

impl LeftOpen {
    /// From the change of all rows by one standard deviation of each.
    pub(crate) fn of(changes: impl Iterator<Item = Vec<f64>>) -> LeftOpen {
        let mut open = LeftOpen::default();
        for mut change in changes {
            open.take_out(&mut change);
            let square = dot(&change, &change);
            if square > NEGLIGIBLE && square.is_finite() {
                let norm = square.sqrt();
                change.iter_mut().for_each(|value| *value /= norm);
                open.directions
                    .push((change, 1.0 - (1.0 + square).sqrt().recip()));
            }
        }
        open
    }

    /// Brings the residuals of the run back to the variance of the noise.
    pub(crate) fn take_out(&self, rows: &mut [f64]) {
        for (direction, part) in &self.directions {
            add(-part, direction, rows);
        }
    }

    /// Gives back what was taken out.
    pub(crate) fn put_back(&self, rows: &mut [f64]) {
        for (direction, part) in self.directions.iter().rev() {
            add(part / (1.0 - part), direction, rows);
        }
    }
}

/// Adds so many times what the rows hold of a unit direction.
fn add(times: f64, direction: &[f64], rows: &mut [f64]) {
    let of_rows = times * dot(direction, rows);
    sums::add(rows, of_rows, direction);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whitening W of the covariance V = 1 + sum of d d' must give W V W' = 1.
    #[test]
    fn what_is_left_has_the_variance_of_the_noise() {
        let changes = [vec![3.0, 1.0, 0.0, -2.0], vec![2.0, 2.0, 0.5, 1.0], vec![0.0; 4]];
        let open = LeftOpen::of(changes.iter().cloned());
        assert_eq!(open.directions.len(), 2);
        let n = 4;
        let covariance = |a: usize, b: usize| {
            let shared: f64 = changes.iter().map(|d| d[a] * d[b]).sum();
            shared + f64::from(u8::from(a == b))
        };
        let rows = |matrix: Vec<Vec<f64>>| -> Vec<Vec<f64>> {
            let columns = (0..n).map(|c| {
                let mut column: Vec<f64> = (0..n).map(|r| matrix[r][c]).collect();
                open.take_out(&mut column);
                column
            });
            columns.collect()
        };
        let covariance = (0..n)
            .map(|a| (0..n).map(|b| covariance(a, b)).collect())
            .collect();
        for (a, row) in rows(rows(covariance)).iter().enumerate() {
            for (b, value) in row.iter().enumerate() {
                assert!(
                    (value - f64::from(u8::from(a == b))).abs() < 1e-12,
                    "{a} {b}: {value}"
                );
            }
        }
    }

    #[test]
    fn what_is_taken_out_is_put_back() {
        let open = LeftOpen::of([vec![3.0, 1.0, 0.0], vec![20.0, 2.0, 0.5]].into_iter());
        let mut rows = vec![1.0, -2.0, 0.5];
        open.take_out(&mut rows);
        assert!((rows[0] - 1.0).abs() > 0.1);
        open.put_back(&mut rows);
        for (row, before) in rows.iter().zip([1.0, -2.0, 0.5]) {
            assert!((row - before).abs() < 1e-12, "{rows:?}");
        }
    }
}
