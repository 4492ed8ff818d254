//! Values of one parameter beside the columns of the covariates: what a question is asked of.

use std::collections::BTreeMap;

use super::covariate::Covariate;
use super::design::{Level, Rows};
use super::values::Values;
use ieap_numerics::grouped::{Grouped, dot};
use ieap_numerics::symmetric::Symmetric;

/// Rows with a value, and what else is known of them.
#[derive(Debug, Clone)]
pub struct Table {
    /// Values on their scale.
    pub y: Vec<f64>,
    /// Variances by the fits.
    pub variance: Vec<f64>,
    /// Group of each row, none skipped.
    pub group: Vec<usize>,
    /// Sample of each row, none skipped.
    pub sample: Vec<usize>,
    /// Facts that each row stands for.
    pub members: Vec<Vec<usize>>,
    /// Columns of the covariates, as in [`Rows::columns`].
    pub columns: BTreeMap<Covariate, Vec<Vec<f64>>>,
}

impl Table {
    /// Values of the runs, or means of the samples once what differs within them (`within`) is allowed for.
    pub fn new(values: &Values, rows: &Rows, within: &Rows) -> Table {
        match rows.level {
            Level::Within => Table::of_runs(values, rows),
            Level::Between => Table::of_samples(values, rows, within),
        }
    }

    fn of_runs(values: &Values, rows: &Rows) -> Table {
        let place_of: BTreeMap<usize, usize> =
            rows.members.iter().enumerate().map(|(k, m)| (m[0], k)).collect();
        let kept: Vec<usize> = values
            .values
            .iter()
            .filter_map(|v| place_of.get(&v.place).copied())
            .collect();
        let group = renumbered(kept.iter().map(|&k| rows.group[k]));
        Table {
            y: values.values.iter().map(|value| value.y).collect(),
            variance: values.values.iter().map(|value| value.variance).collect(),
            sample: group.clone(),
            group,
            members: kept.iter().map(|&k| rows.members[k].clone()).collect(),
            columns: part(&rows.columns, &kept),
        }
    }

    fn of_samples(values: &Values, rows: &Rows, within: &Rows) -> Table {
        let runs = Table::of_runs(values, within);
        let y = without_columns(&runs);
        let mut kept = Vec::new();
        let (mut means, mut variances) = (Vec::new(), Vec::new());
        for (k, members) in rows.members.iter().enumerate() {
            let own: Vec<usize> = (0..y.len())
                .filter(|&row| members.contains(&runs.members[row][0]))
                .collect();
            if own.is_empty() {
                continue;
            }
            let count = own.len() as f64;
            kept.push(k);
            means.push(own.iter().map(|&row| y[row]).sum::<f64>() / count);
            variances.push(own.iter().map(|&row| runs.variance[row]).sum::<f64>() / (count * count));
        }
        Table {
            group: vec![0; kept.len()],
            sample: (0..kept.len()).collect(),
            members: kept.iter().map(|&k| rows.members[k].clone()).collect(),
            columns: part(&rows.columns, &kept),
            y: means,
            variance: variances,
        }
    }

    /// Columns of these covariates, one after another.
    pub fn columns_of(&self, covariates: &[Covariate]) -> Vec<Vec<f64>> {
        covariates
            .iter()
            .flat_map(|covariate| self.columns.get(covariate).cloned().unwrap_or_default())
            .collect()
    }
}

fn part(columns: &BTreeMap<Covariate, Vec<Vec<f64>>>, kept: &[usize]) -> BTreeMap<Covariate, Vec<Vec<f64>>> {
    let pick = |column: &Vec<f64>| kept.iter().map(|&k| column[k]).collect();
    columns
        .iter()
        .map(|(&covariate, columns)| (covariate, columns.iter().map(pick).collect()))
        .collect()
}

/// Numbers without gaps, in the order in which the given ones rise.
fn renumbered(numbers: impl Iterator<Item = usize>) -> Vec<usize> {
    let numbers: Vec<usize> = numbers.collect();
    let mut distinct = numbers.clone();
    distinct.sort_unstable();
    distinct.dedup();
    numbers
        .iter()
        .map(|number| distinct.binary_search(number).unwrap_or(0))
        .collect()
}

/// Values less what the covariates within samples make of them, brought to the columns' means.
fn without_columns(runs: &Table) -> Vec<f64> {
    let mut model = Grouped::new(&vec![1.0; runs.y.len()], &runs.group, &[]);
    let columns: Vec<&Vec<f64>> = runs
        .columns
        .values()
        .flatten()
        .filter(|column| model.freedom() > 2 && model.take_out(column))
        .collect();
    let owned: Vec<Vec<f64>> = columns.into_iter().cloned().collect();
    let (slopes, _) = coefficients(&runs.y, &vec![1.0; runs.y.len()], &runs.group, &owned);
    let mut y = runs.y.clone();
    for (column, slope) in owned.iter().zip(slopes) {
        let mean = column.iter().sum::<f64>() / column.len() as f64;
        for (y, x) in y.iter_mut().zip(column) {
            *y -= slope * (x - mean);
        }
    }
    y
}

/// Coefficients of `columns` beside an intercept for each group, and the inverse of their normal matrix. Columns must
/// be independent.
pub fn coefficients(
    y: &[f64],
    variance: &[f64],
    group: &[usize],
    columns: &[Vec<f64>],
) -> (Vec<f64>, Symmetric) {
    let groups = Grouped::new(variance, group, &[]);
    let left: Vec<Vec<f64>> = columns.iter().map(|column| groups.residual(column)).collect();
    let target = groups.residual(y);
    let mut normal = Symmetric::zero(columns.len());
    for (row, a) in left.iter().enumerate() {
        for (column, b) in left.iter().enumerate().take(row + 1) {
            normal.add(row, column, dot(a, b));
        }
    }
    let right: Vec<f64> = left.iter().map(|column| dot(column, &target)).collect();
    (normal.solve(&right, 1e-12), normal.inverse(1e-12))
}
