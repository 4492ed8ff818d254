//! The largest difference of a parameter between names: instruments, operators, batches.

use super::covariate::Covariate;
use super::facts::RunFacts;
use super::fitted::Interval;
use super::table::{Table, coefficients};
use ieap_numerics::grouped::{Grouped, dot};
use ieap_numerics::student::quantile_95;

/// The two names that lie farthest apart.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Jump {
    /// Name with the lower value.
    pub from: String,
    /// Name with the higher value.
    pub to: String,
    /// Logarithm of the ratio, or difference on a plain scale.
    pub size: Interval,
}

/// The largest difference between the names of a covariate beside `nuisance`; none where nothing is left free.
pub fn largest(
    facts: &[RunFacts],
    table: &Table,
    covariate: Covariate,
    variance: &[f64],
    nuisance: &[Vec<f64>],
) -> Option<Jump> {
    let mut names: Vec<&str> = table
        .members
        .iter()
        .flatten()
        .filter_map(|&place| facts[place].names.get(&covariate).map(String::as_str))
        .collect();
    names.sort_unstable();
    names.dedup();
    let own = table.columns.get(&covariate)?;
    // Names that only runs without a value have leave an empty column.
    let mut model = Grouped::new(variance, &table.group, &[]);
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for column in nuisance {
        if model.take_out(column) {
            columns.push(column.clone());
        }
    }
    let before = columns.len();
    let mut places = Vec::new();
    for (k, column) in own.iter().enumerate() {
        if model.take_out(column) {
            columns.push(column.clone());
            places.push(k + 1);
        }
    }
    if model.freedom() == 0 || places.is_empty() || names.len() <= own.len() {
        return None;
    }
    let (slopes, inverse) = coefficients(&table.y, variance, &table.group, &columns);
    let left = model.residual(&table.y);
    let spread = (dot(&left, &left) / model.freedom() as f64).max(1.0);
    // The first name is the reference of all others.
    let level = |k: usize| if k == 0 { 0.0 } else { slopes[before + k - 1] };
    let count = places.len() + 1;
    let lowest = (0..count).min_by(|&a, &b| level(a).total_cmp(&level(b)))?;
    let highest = (0..count).max_by(|&a, &b| level(a).total_cmp(&level(b)))?;
    let mut contrast = vec![0.0; columns.len()];
    if highest > 0 {
        contrast[before + highest - 1] += 1.0;
    }
    if lowest > 0 {
        contrast[before + lowest - 1] -= 1.0;
    }
    let error = (inverse.form(&contrast, &contrast) * spread).sqrt();
    let reach = quantile_95(model.freedom() as f64) * error;
    let value = level(highest) - level(lowest);
    let name = |k: usize| match k {
        0 => names[0].to_owned(),
        k => names[places[k - 1]].to_owned(),
    };
    Some(Jump {
        from: name(lowest),
        to: name(highest),
        size: Interval {
            value,
            low_95: Some(value - reach),
            high_95: Some(value + reach),
        },
    })
}
