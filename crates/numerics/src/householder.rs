//! Least squares with any number of columns, by Householder reflections (Golub and Van Loan, Matrix Computations,
//! algorithm 5.2.1): its rounding grows with the condition of the columns, not with its square as that of the normal
//! equations does.

use super::sums;

/// Columns whose part that is their own falls below this share of their length hang on the others.
const DEPENDENT: f64 = 1e-13;

/// The coefficients that fit `readings` by `columns` of the same length; a column that hangs on earlier ones gets 0.
///
/// None where there are more columns than readings.
pub fn least_squares(columns: &[Vec<f64>], readings: &[f64]) -> Option<Vec<f64>> {
    let (rows, count) = (readings.len(), columns.len());
    if count > rows {
        return None;
    }
    let lengths: Vec<f64> = columns.iter().map(|column| length(column)).collect();
    let mut matrix: Vec<Vec<f64>> = columns.to_vec();
    let mut right = readings.to_vec();
    let mut row = 0;
    // Row of the triangle that each column took; none where it hangs on earlier ones.
    let mut rows_of = vec![None; count];
    for k in 0..count {
        let own = length(&matrix[k][row..]);
        if own <= DEPENDENT * lengths[k] {
            continue;
        }
        let mut mirror = matrix[k][row..].to_vec();
        mirror[0] += own.copysign(mirror[0]);
        let square: f64 = mirror.iter().map(|x| x * x).sum();
        for column in matrix.iter_mut().skip(k) {
            reflect(&mirror, square, &mut column[row..]);
        }
        reflect(&mirror, square, &mut right[row..]);
        rows_of[k] = Some(row);
        row += 1;
    }
    let mut solution = vec![0.0; count];
    for k in (0..count).rev() {
        let Some(row) = rows_of[k] else { continue };
        let later: f64 = (k + 1..count).map(|j| matrix[j][row] * solution[j]).sum();
        solution[k] = (right[row] - later) / matrix[k][row];
    }
    Some(solution)
}

fn length(column: &[f64]) -> f64 {
    column.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn reflect(mirror: &[f64], square: f64, column: &mut [f64]) {
    let product: f64 = mirror.iter().zip(&*column).map(|(a, b)| a * b).sum();
    sums::add(column, -2.0 * product / square, mirror);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_comes_back_though_its_powers_are_nearly_alike() {
        let x: Vec<f64> = (0..60).map(|k| 1.0 + f64::from(k) / 60.0).collect();
        let columns: Vec<Vec<f64>> = (0..9).map(|p| x.iter().map(|x| x.powi(p)).collect()).collect();
        let truth: Vec<f64> = (0..9).map(|p| 1.0 - 0.3 * f64::from(p)).collect();
        let readings: Vec<f64> = (0..x.len())
            .map(|row| (0..9).map(|p| truth[p] * columns[p][row]).sum())
            .collect();
        let found = least_squares(&columns, &readings).unwrap();
        for (found, truth) in found.iter().zip(&truth) {
            assert!((found - truth).abs() < 1e-5, "{found} {truth}");
        }
    }

    #[test]
    fn residuals_stand_at_right_angles_to_every_column() {
        let columns = vec![vec![1.0, 1.0, 1.0, 1.0], vec![0.0, 1.0, 3.0, 4.0]];
        let readings = [1.0, -2.0, 0.5, 7.0];
        let found = least_squares(&columns, &readings).unwrap();
        for column in &columns {
            let left: f64 = (0..4)
                .map(|r| column[r] * (readings[r] - found[0] * columns[0][r] - found[1] * columns[1][r]))
                .sum();
            assert!(left.abs() < 1e-12);
        }
    }

    #[test]
    fn a_column_that_hangs_on_others_gets_nothing_and_too_many_are_refused() {
        let columns = vec![vec![1.0, 2.0, 3.0], vec![2.0, 4.0, 6.0], vec![0.0, 0.0, 1.0]];
        let found = least_squares(&columns, &[1.0, 2.0, 5.0]).unwrap();
        assert_eq!(found[1], 0.0);
        assert!((found[0] - 1.0).abs() < 1e-12 && (found[2] - 2.0).abs() < 1e-12);
        assert_eq!(least_squares(&columns, &[1.0, 2.0]), None);
    }
}
