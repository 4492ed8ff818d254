//! Least squares in a box for as many parameters as a group of runs has.

use super::levenberg::Stop;

/// A square symmetric matrix of any order, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Dense {
    order: usize,
    entries: Vec<f64>,
}

impl Dense {
    /// All entries zero.
    pub fn zero(order: usize) -> Dense {
        Dense {
            order,
            entries: vec![0.0; order * order],
        }
    }

    /// Number of rows, and of columns.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The entry in `row` and `column`, both from 0.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        self.entries[row * self.order + column]
    }

    /// Adds to one entry; the caller adds to its mirror image as well.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.entries[row * self.order + column] += value;
    }

    /// Lower factor of the matrix scaled to a unit diagonal, each pivot held at `floor` at least, with the scale.
    fn factor(&self, floor: f64) -> (Dense, Vec<f64>) {
        let n = self.order;
        let root = |d: f64| {
            if d > 0.0 && d.is_finite() {
                d.sqrt().recip()
            } else {
                0.0
            }
        };
        let scale: Vec<f64> = (0..n).map(|k| root(self.get(k, k))).collect();
        let mut factor = Dense::zero(n);
        for row in 0..n {
            for column in 0..=row {
                let known: f64 = (0..column)
                    .map(|k| factor.get(row, k) * factor.get(column, k))
                    .sum();
                let rest = self.get(row, column) * scale[row] * scale[column] - known;
                let value = if row == column {
                    rest.max(floor).sqrt()
                } else {
                    rest / factor.get(column, column)
                };
                factor.entries[row * n + column] = value;
            }
        }
        (factor, scale)
    }

    /// Solution of `A x = right`; directions that the matrix loses are held at the relative pivot `floor`.
    pub fn solve(&self, right: &[f64], floor: f64) -> Vec<f64> {
        let (factor, scale) = self.factor(floor);
        solve_factored(&factor, &scale, right)
    }

    /// The inverse, with directions that the matrix loses held at the relative pivot `floor`.
    pub fn inverse(&self, floor: f64) -> Dense {
        let (factor, scale) = self.factor(floor);
        let mut inverse = Dense::zero(self.order);
        let mut unit = vec![0.0; self.order];
        for column in 0..self.order {
            unit[column] = 1.0;
            let x = solve_factored(&factor, &scale, &unit);
            unit[column] = 0.0;
            for (row, value) in x.into_iter().enumerate() {
                inverse.entries[row * self.order + column] = value;
            }
        }
        inverse
    }

    /// Logarithm of the determinant.
    pub fn log_determinant(&self) -> f64 {
        let (factor, scale) = self.factor(1e-14);
        (0..self.order)
            .map(|k| 2.0 * (factor.get(k, k) / scale[k].max(f64::MIN_POSITIVE)).ln())
            .sum()
    }

    /// `x` transposed times the matrix times `y`.
    pub fn form(&self, x: &[f64], y: &[f64]) -> f64 {
        let row = |row: usize| -> f64 { (0..self.order).map(|k| self.get(row, k) * y[k]).sum() };
        (0..self.order).map(|k| x[k] * row(k)).sum()
    }
}

fn solve_factored(factor: &Dense, scale: &[f64], right: &[f64]) -> Vec<f64> {
    let n = factor.order;
    let mut x = vec![0.0; n];
    for row in 0..n {
        let known: f64 = (0..row).map(|k| factor.get(row, k) * x[k]).sum();
        x[row] = (right[row] * scale[row] - known) / factor.get(row, row);
    }
    for row in (0..n).rev() {
        let known: f64 = (row + 1..n).map(|k| factor.get(k, row) * x[k]).sum();
        x[row] = (x[row] - known) / factor.get(row, row);
    }
    x.iter().zip(scale).map(|(value, scale)| value * scale).collect()
}

/// Sum of squares and its local model at one place.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// Sum of squared weighted residuals.
    pub square: f64,
    /// J'r.
    pub descent: Vec<f64>,
    /// J'J.
    pub normal: Dense,
}

impl Slope {
    /// Of no residuals yet, for `order` parameters.
    pub fn zero(order: usize) -> Slope {
        Slope {
            square: 0.0,
            descent: vec![0.0; order],
            normal: Dense::zero(order),
        }
    }
}

/// Where a search ended.
#[derive(Debug, Clone)]
pub struct Bottom {
    /// The parameters there.
    pub at: Vec<f64>,
    /// Sum of squares and its derivatives there.
    pub slope: Slope,
    /// How often the residuals were calculated.
    pub evaluations: u64,
    /// Why it ended.
    pub stop: Stop,
}

/// Lowers the sum of squares from `start` inside `low..=high` by damped Gauss-Newton steps; settles where a
/// further step would lower it by less than `settle` (absolute, in units of the weighted sum).
pub fn descend(
    start: &[f64],
    low: &[f64],
    high: &[f64],
    limit: u64,
    settle: f64,
    mut evaluate: impl FnMut(&[f64]) -> Slope,
) -> Bottom {
    let inside = |k: usize, value: f64| value.max(low[k]).min(high[k]);
    let mut at: Vec<f64> = start.iter().enumerate().map(|(k, &v)| inside(k, v)).collect();
    let mut slope = evaluate(&at);
    let (mut evaluations, mut damping) = (1, 1e-4);
    let stop = loop {
        if !slope.square.is_finite() {
            break Stop::NotFinite;
        }
        let (trial, expected) = step(&at, &slope, low, high, damping);
        if expected <= settle {
            break Stop::Converged;
        }
        if evaluations >= limit {
            break Stop::EvaluationLimit;
        }
        let there = evaluate(&trial);
        evaluations += 1;
        if there.square < slope.square {
            (at, slope) = (trial, there);
            damping = (damping * 0.1_f64).max(1e-10);
        } else {
            damping = damping.max(1e-6) * 10.0;
            if damping > 1e10 {
                break Stop::NoDescent;
            }
        }
    };
    Bottom {
        at,
        slope,
        evaluations,
        stop,
    }
}

/// The damped step and the fall of the sum of squares that it promises. A coordinate that would leave the box
/// goes to its bound, and the others are solved anew with it there.
fn step(at: &[f64], slope: &Slope, low: &[f64], high: &[f64], damping: f64) -> (Vec<f64>, f64) {
    let held = |k: usize| {
        (at[k] <= low[k] && slope.descent[k] <= 0.0) || (at[k] >= high[k] && slope.descent[k] >= 0.0)
    };
    let mut free: Vec<usize> = (0..at.len())
        .filter(|&k| !held(k) && slope.normal.get(k, k) > 0.0)
        .collect();
    let mut taken = vec![0.0; at.len()];
    while !free.is_empty() {
        let mut part = Dense::zero(free.len());
        for (row, &k) in free.iter().enumerate() {
            for (column, &l) in free.iter().enumerate() {
                let stretch = if row == column { 1.0 + damping } else { 1.0 };
                part.add(row, column, slope.normal.get(k, l) * stretch);
            }
        }
        let fixed = |k: usize| -> f64 { (0..at.len()).map(|l| slope.normal.get(k, l) * taken[l]).sum() };
        let descent: Vec<f64> = free.iter().map(|&k| slope.descent[k] - fixed(k)).collect();
        let wanted = part.solve(&descent, 1e-14);
        let outside = |&j: &usize| {
            let k = free[j];
            !(at[k] + wanted[j] >= low[k] && at[k] + wanted[j] <= high[k])
        };
        let Some(j) = (0..free.len()).find(outside) else {
            for (value, &k) in wanted.iter().zip(&free) {
                taken[k] = *value;
            }
            break;
        };
        let k = free.remove(j);
        taken[k] = (at[k] + wanted[j]).max(low[k]).min(high[k]) - at[k];
    }
    let trial = at.iter().zip(&taken).map(|(a, t)| a + t).enumerate();
    let trial = trial.map(|(k, v)| v.max(low[k]).min(high[k])).collect();
    let linear: f64 = slope.descent.iter().zip(&taken).map(|(d, t)| d * t).sum();
    let expected = 2.0 * linear - slope.normal.form(&taken, &taken);
    (trial, if expected > 0.0 { expected } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hilbert(n: usize) -> Dense {
        let mut matrix = Dense::zero(n);
        for row in 0..n {
            for column in 0..n {
                matrix.add(row, column, 1.0 / (row + column + 1) as f64);
            }
        }
        matrix
    }

    #[test]
    fn inverse_and_determinant_of_hilbert_matrices() {
        // det H_3 = 1/2160; the inverse of a Hilbert matrix has whole numbers.
        assert!((hilbert(3).log_determinant() + 2160.0_f64.ln()).abs() < 1e-10);
        let inverse = hilbert(4).inverse(1e-14);
        assert!(
            (inverse.get(0, 0) / 16.0 - 1.0).abs() < 1e-9 && (inverse.get(2, 3) / -4200.0 - 1.0).abs() < 1e-9
        );
    }

    #[test]
    fn a_valley_with_a_wall() {
        let valley = |at: &[f64]| {
            let residuals = [10.0 * (at[1] - at[0] * at[0]), 1.0 - at[0]];
            let jacobian = [[-20.0 * at[0], 10.0], [-1.0, 0.0]];
            let mut slope = Slope::zero(2);
            for r in 0..2 {
                slope.square += residuals[r] * residuals[r];
                for a in 0..2 {
                    slope.descent[a] -= jacobian[r][a] * residuals[r];
                    for b in 0..2 {
                        slope.normal.add(a, b, jacobian[r][a] * jacobian[r][b]);
                    }
                }
            }
            slope
        };
        let free = descend(&[-1.2, 1.0], &[-5.0; 2], &[5.0; 2], 200, 1e-14, valley);
        assert!(
            (free.at[0] - 1.0).abs() < 1e-5 && (free.at[1] - 1.0).abs() < 1e-5,
            "{free:?}"
        );
        let walled = descend(&[-1.2, 1.0], &[-5.0; 2], &[0.5, 5.0], 200, 1e-14, valley);
        assert!(
            (walled.at[0] - 0.5).abs() < 1e-9 && (walled.at[1] - 0.25).abs() < 1e-5,
            "{walled:?}"
        );
    }
}
