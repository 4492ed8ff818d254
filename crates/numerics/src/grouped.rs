//! Weighted linear regression with an intercept for each group: what is left of a column once groups and other
//! columns are taken out.

use super::line::edge;
use super::sums::{add, dot};

/// Part of a column's square that must be left after the columns before it for it to count.
const DEPENDENT_BELOW: f64 = 1e-9;

/// Groups and columns that are taken out of readings with known relative variances.
///
/// Everything happens in whitened coordinates: a reading over its standard deviation.
#[derive(Debug, Clone)]
pub struct Grouped {
    root_weights: Vec<f64>,
    group: Vec<usize>,
    weight_of_group: Vec<f64>,
    basis: Vec<Vec<f64>>,
}

impl Grouped {
    /// `variance` of each reading, the number of its group (0 based, none skipped), and columns to take out beside
    /// the groups; columns that depend on earlier ones are left out.
    pub fn new(variance: &[f64], group: &[usize], columns: &[Vec<f64>]) -> Grouped {
        let root_weights: Vec<f64> = variance
            .iter()
            .map(|v| 1.0 / v.max(f64::MIN_POSITIVE).sqrt())
            .collect();
        let groups = group.iter().max().map_or(0, |last| last + 1);
        let mut weight_of_group = vec![0.0; groups];
        for (&g, root) in group.iter().zip(&root_weights) {
            weight_of_group[g] += root * root;
        }
        let mut grouped = Grouped {
            root_weights,
            group: group.to_vec(),
            weight_of_group,
            basis: Vec::new(),
        };
        grouped.take_out_all(columns);
        grouped
    }

    /// Takes out more columns, those that depend on earlier ones left out.
    pub fn take_out_all(&mut self, columns: &[Vec<f64>]) {
        for column in columns {
            self.take_out(column);
        }
    }

    /// Takes out one more column; tells whether it was independent of those before.
    pub fn take_out(&mut self, column: &[f64]) -> bool {
        let before: f64 = self.centred(column).iter().map(|x| x * x).sum();
        let whole: f64 = column
            .iter()
            .zip(&self.root_weights)
            .map(|(x, root)| (x * root).powi(2))
            .sum();
        let left = self.residual(column);
        let square: f64 = left.iter().map(|x| x * x).sum();
        if square <= DEPENDENT_BELOW * before.max(DEPENDENT_BELOW * whole) || square == 0.0 {
            return false;
        }
        let scale = square.sqrt().recip();
        self.basis.push(left.iter().map(|x| x * scale).collect());
        true
    }

    /// Number of readings.
    pub fn readings(&self) -> usize {
        self.group.len()
    }

    /// Number of groups and independent columns.
    pub fn rank(&self) -> usize {
        self.weight_of_group.len() + self.basis.len()
    }

    /// Readings less rank.
    pub fn freedom(&self) -> usize {
        self.readings().saturating_sub(self.rank())
    }

    /// `column` in whitened coordinates without groups and columns.
    pub fn residual(&self, column: &[f64]) -> Vec<f64> {
        let mut left = self.centred(column);
        self.remove_basis(&mut left);
        left
    }

    /// Square of what groups and columns leave of a column that is whitened already; `room` is scratch.
    pub fn square_left(&self, whitened: &[f64], room: &mut Vec<f64>) -> f64 {
        room.clear();
        room.extend_from_slice(whitened);
        self.remove_groups(room);
        // The basis is orthonormal and has no part in the groups.
        let whole: f64 = room.iter().map(|x| x * x).sum();
        let taken: f64 = self.basis.iter().map(|column| dot(column, room).powi(2)).sum();
        (whole - taken).max(0.0)
    }

    fn centred(&self, column: &[f64]) -> Vec<f64> {
        let mut whitened: Vec<f64> = column
            .iter()
            .zip(&self.root_weights)
            .map(|(x, root)| x * root)
            .collect();
        self.remove_groups(&mut whitened);
        whitened
    }

    fn remove_groups(&self, whitened: &mut [f64]) {
        let mut sums = vec![0.0; self.weight_of_group.len()];
        for ((x, root), &g) in whitened.iter().zip(&self.root_weights).zip(&self.group) {
            sums[g] += x * root;
        }
        for ((x, root), &g) in whitened.iter_mut().zip(&self.root_weights).zip(&self.group) {
            *x -= root * sums[g] / self.weight_of_group[g];
        }
    }

    fn remove_basis(&self, whitened: &mut [f64]) {
        for column in &self.basis {
            let part = dot(column, whitened);
            add(whitened, -part, column);
        }
    }
}

/// Variance that readings share beside their own `variance`, so that the weighted squares left by groups and columns
/// are what their number lets one expect (Paule and Mandel 1982); 0 where the readings' own explain them.
pub fn shared_variance(y: &[f64], variance: &[f64], group: &[usize], columns: &[Vec<f64>]) -> f64 {
    let excess = |shared: f64| {
        let total: Vec<f64> = variance.iter().map(|v| v + shared).collect();
        let model = Grouped::new(&total, group, columns);
        let square: f64 = model.residual(y).iter().map(|x| x * x).sum();
        square - model.freedom() as f64
    };
    let ones = vec![1.0; y.len()];
    let plain = Grouped::new(&ones, group, columns);
    let mean_square = match plain.freedom() {
        0 => return 0.0,
        freedom => plain.residual(y).iter().map(|x| x * x).sum::<f64>() / freedom as f64,
    };
    let floor = 1e-12 * mean_square;
    if mean_square <= 0.0 || excess(floor) <= 0.0 {
        return 0.0;
    }
    // By its logarithm: the excess falls as the shared variance grows, and is negative above the plain mean square
    // by far.
    let highest = (1e3 * mean_square).ln();
    edge(floor.ln(), highest, 50, |shared| excess(shared.exp()) > 0.0).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_and_columns_leave_nothing_of_what_they_explain() {
        let group = [0, 0, 0, 1, 1, 1];
        let x = vec![1.0, 2.0, 4.0, 1.0, 3.0, 5.0];
        let y: Vec<f64> = x
            .iter()
            .zip(group)
            .map(|(x, g)| 2.0 * x + 10.0 * g as f64)
            .collect();
        let model = Grouped::new(&[1.0, 2.0, 1.0, 0.5, 1.0, 3.0], &group, &[x.clone(), x]);
        assert_eq!((model.rank(), model.freedom()), (3, 3));
        assert!(model.residual(&y).iter().all(|left| left.abs() < 1e-9));
        let mut room = Vec::new();
        let whitened = [0.3, -1.0, 0.2, 0.9, 0.1, -0.4];
        let mut left = whitened.to_vec();
        model.remove_groups(&mut left);
        model.remove_basis(&mut left);
        let slow: f64 = left.iter().map(|x| x * x).sum();
        assert!((model.square_left(&whitened, &mut room) - slow).abs() < 1e-12);
    }

    #[test]
    fn a_column_that_groups_explain_counts_as_dependent() {
        let mut model = Grouped::new(&[1.0; 4], &[0, 0, 1, 1], &[]);
        assert!(!model.take_out(&[2.0, 2.0, 5.0, 5.0]));
        assert!(model.take_out(&[0.0, 1.0, 0.0, 0.0]));
    }

    #[test]
    fn shared_variance_is_what_is_beyond_the_readings_own() {
        // Pairs that differ by 2: variance 2 a reading, of which 0.5 is known.
        let y: Vec<f64> = (0..40).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let group: Vec<usize> = (0..40).map(|k| k / 2).collect();
        let shared = shared_variance(&y, &[0.5; 40], &group, &[]);
        assert!((shared - 1.5).abs() < 1e-6, "{shared}");
        assert_eq!(shared_variance(&y, &[3.0; 40], &group, &[]), 0.0);
    }
}
