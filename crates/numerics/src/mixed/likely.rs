//! A mixed model at given variances: its restricted likelihood, and what is fixed.
//!
//! What hangs on the scatter of readings alone is made once for each such scatter: with `D` their inverse variances and `P` that
//! without what is fixed, `S = Z' P Z` and `h = Z' P y` tell all that components add (Henderson's equations, the fixed part
//! taken out): `M = (G^-1 + S)^-1` for their variances `G`.

use std::collections::BTreeMap;

use super::model::{MixedModel, Unit};
use crate::sums::dot;
use crate::symmetric::Symmetric;

/// Pivot, part of the diagonal, below which `X` has lost a direction.
const LOST: f64 = 1e-11;
/// Least variance of a reading, part of the largest: its inverse must stay a number.
const LEAST_PART: f64 = 1e-12;

/// Entries of a row that are not zero, with their columns.
type Row = Vec<(usize, f64)>;

/// The rows of a model, those of `Z` with a column for each block and its own.
pub(super) struct Rows<'a> {
    units: Vec<(&'a Unit, Row, Row)>,
    fixed: usize,
    /// Component of each column of `Z`.
    component_of: Vec<usize>,
    largest_known: f64,
}

impl<'a> Rows<'a> {
    pub fn of(model: &'a MixedModel) -> Rows<'a> {
        let (mut places, mut component_of) = (BTreeMap::new(), Vec::new());
        let mut units = Vec::new();
        for unit in &model.units {
            let mut random = Row::new();
            for (column, entry) in entries(&unit.random) {
                let place = *places.entry((unit.block, column)).or_insert(component_of.len());
                if place == component_of.len() {
                    component_of.push(model.component_of[column]);
                }
                random.push((place, entry));
            }
            units.push((unit, entries(&unit.fixed).collect(), random));
        }
        let known = model.units.iter().flat_map(|unit| &unit.readings);
        Rows {
            fixed: model.units.first().map_or(0, |unit| unit.fixed.len()),
            component_of,
            largest_known: known.map(|reading| reading.variance).fold(0.0, f64::max),
            units,
        }
    }

    /// Variance of a reading where that is what all of them share.
    fn variance(&self, shared: f64, known: f64) -> f64 {
        let least = LEAST_PART * shared.max(self.largest_known);
        (shared + known).max(least).max(f64::MIN_POSITIVE.sqrt())
    }
}

fn entries(row: &[f64]) -> impl Iterator<Item = (usize, f64)> {
    row.iter().copied().enumerate().filter(|(_, entry)| *entry != 0.0)
}

/// What is known where readings share that variance.
pub(super) struct AtReadings<'r, 'a> {
    rows: &'r Rows<'a>,
    shared: f64,
    /// What is fixed, and its covariance, without components.
    coefficients: Vec<f64>,
    covariance: Symmetric,
    /// The covariance times `X' D Z`.
    through: Vec<Vec<f64>>,
    /// `S`.
    own: Symmetric,
    /// `h`.
    towards: Vec<f64>,
    log_likelihood: f64,
    /// `y' P y`.
    square: f64,
}

impl<'r, 'a> AtReadings<'r, 'a> {
    /// None where `X` loses a direction.
    pub fn of(rows: &'r Rows<'a>, shared: f64) -> Option<AtReadings<'r, 'a>> {
        let (fixed, random) = (rows.fixed, rows.component_of.len());
        let (mut normal, mut own) = (Symmetric::zero(fixed), Symmetric::zero(random));
        let mut crossed = vec![vec![0.0; fixed]; random];
        let (mut right, mut towards) = (vec![0.0; fixed], vec![0.0; random]);
        let mut log_variance = 0.0;
        for (unit, of_fixed, of_random) in &rows.units {
            let (mut weight, mut value) = (0.0, 0.0);
            for reading in &unit.readings {
                let variance = rows.variance(shared, reading.variance);
                weight += reading.weight / variance;
                value += reading.weight / variance * reading.value;
                log_variance += reading.weight * variance.ln();
            }
            for &(a, left) in of_fixed {
                right[a] += left * value;
                of_fixed
                    .iter()
                    .for_each(|&(b, entry)| normal.add(a, b, left * weight * entry));
            }
            for &(a, left) in of_random {
                towards[a] += left * value;
                let row = &mut crossed[a];
                of_fixed
                    .iter()
                    .for_each(|&(b, entry)| row[b] += left * weight * entry);
                of_random
                    .iter()
                    .for_each(|&(b, entry)| own.add(a, b, left * weight * entry));
            }
        }
        normal.cholesky(LOST)?;
        let covariance = normal.inverse(LOST);
        let coefficients = covariance.times(&right);
        let through: Vec<Vec<f64>> = crossed.iter().map(|own| covariance.times(own)).collect();
        for (a, (crossing, through)) in crossed.iter().zip(&through).enumerate() {
            towards[a] -= dot(crossing, &coefficients);
            for (b, other) in crossed.iter().enumerate() {
                own.add(a, b, -dot(through, other));
            }
        }
        let square = squares(rows, shared, &coefficients);
        Some(AtReadings {
            log_likelihood: -0.5 * (log_variance + normal.log_determinant() + square),
            rows,
            shared,
            coefficients,
            covariance,
            through,
            own,
            towards,
            square,
        })
    }

    /// Roots of the variances of components by column, of those that are not nothing.
    fn roots(&self, variances: &[f64]) -> (Vec<usize>, Vec<f64>) {
        let of = self.rows.component_of.iter().enumerate();
        let roots = of.map(|(column, of)| (column, variances[*of].max(0.0).sqrt()));
        roots.filter(|(_, root)| *root > 0.0).unzip()
    }

    /// Logarithm of the restricted likelihood with components of these variances, without its constant.
    pub fn log_likelihood(&self, variances: &[f64]) -> f64 {
        let (log_determinant, taken) = self.of_components(variances);
        self.log_likelihood - 0.5 * (log_determinant - taken)
    }

    /// Square of what is left with components of these variances, each reading in its error.
    pub fn square_beside(&self, variances: &[f64]) -> f64 {
        self.square - self.of_components(variances).1
    }

    /// What components of these variances add to the logarithm of the determinant, and what they take from the square.
    fn of_components(&self, variances: &[f64]) -> (f64, f64) {
        let (columns, roots) = self.roots(variances);
        let Some(factor) = self.inner(&columns, &roots).cholesky(0.0) else {
            return (f64::NAN, f64::NAN);
        };
        let mut taken: Vec<f64> = columns
            .iter()
            .zip(&roots)
            .map(|(k, root)| self.towards[*k] * root)
            .collect();
        factor.solve_factor(&mut taken);
        (factor.log_determinant(), dot(&taken, &taken))
    }

    /// What is known with components of these variances.
    pub fn with(&self, variances: &[f64]) -> Likely {
        let (columns, roots) = self.roots(variances);
        let factor = self.inner(&columns, &roots).cholesky(0.0).unwrap_or_default();
        let fixed = self.coefficients.len();
        // What the factor makes of each column of what goes through chance, and of what pulls at it.
        let through = |fixed: usize| {
            let own = columns
                .iter()
                .zip(&roots)
                .map(|(k, root)| root * self.through[*k][fixed]);
            let mut own: Vec<f64> = own.collect();
            factor.solve_factor(&mut own);
            own
        };
        let through: Vec<Vec<f64>> = (0..fixed).map(through).collect();
        let mut pull: Vec<f64> = columns
            .iter()
            .zip(&roots)
            .map(|(k, root)| self.towards[*k] * root)
            .collect();
        factor.solve_factor(&mut pull);
        let own = |a: usize, b: usize| self.covariance.get(a, b) + dot(&through[a], &through[b]);
        Likely {
            coefficients: (0..fixed)
                .map(|k| self.coefficients[k] - dot(&through[k], &pull))
                .collect(),
            covariance: Symmetric::from_fn(fixed, own),
        }
    }

    /// `1 + G^1/2 S G^1/2` of some columns.
    fn inner(&self, columns: &[usize], roots: &[f64]) -> Symmetric {
        let unit = |a, b| f64::from(u8::from(a == b));
        Symmetric::from_fn(columns.len(), |a, b| {
            unit(a, b) + roots[a] * self.own.get(columns[a], columns[b]) * roots[b]
        })
    }
}

/// Square of what the fixed part leaves, each reading in its error.
fn squares(rows: &Rows, shared: f64, coefficients: &[f64]) -> f64 {
    let of_unit = |(unit, fixed, _): &(&Unit, Row, Row)| -> f64 {
        let said: f64 = fixed.iter().map(|(k, entry)| entry * coefficients[*k]).sum();
        let readings = unit.readings.iter();
        readings
            .map(|own| own.weight * (own.value - said).powi(2) / rows.variance(shared, own.variance))
            .sum()
    };
    rows.units.iter().map(of_unit).sum()
}

/// What is fixed at given variances.
pub(super) struct Likely {
    pub coefficients: Vec<f64>,
    pub covariance: Symmetric,
}

impl AtReadings<'_, '_> {
    /// How far each reading stands off what the model says with it, with components of these variances, in the standard errors of
    /// what would be left without it; 0 where nothing else is said of it: by unit and place. `own_part`: of its information
    /// that must be its own.
    pub fn standings(&self, variances: &[f64], own_part: f64) -> Vec<((usize, usize), f64)> {
        let (columns, roots) = self.roots(variances);
        let inverse = self.inner(&columns, &roots).inverse(0.0);
        let mut middle = Symmetric::zero(self.towards.len());
        for (a, &row) in columns.iter().enumerate() {
            for (b, &column) in columns.iter().enumerate().take(a + 1) {
                middle.set(row, column, roots[a] * inverse.get(a, b) * roots[b]);
            }
        }
        let chance = middle.times(&self.towards);
        let mut found = Vec::new();
        for (k, (unit, fixed, random)) in self.rows.units.iter().enumerate() {
            let mut by_chance = vec![0.0; chance.len()];
            random.iter().for_each(|&(of, entry)| by_chance[of] += entry);
            for (of, own) in by_chance.iter_mut().enumerate() {
                let through = &self.through[of];
                *own -= fixed.iter().map(|(at, entry)| entry * through[*at]).sum::<f64>();
            }
            let said: f64 = fixed
                .iter()
                .map(|(of, entry)| entry * self.coefficients[*of])
                .sum();
            let said = said + dot(&by_chance, &chance);
            let taken = self.covariance.form(&unit.fixed, &unit.fixed) + middle.form(&by_chance, &by_chance);
            for (place, own) in unit.readings.iter().enumerate() {
                let weight = self.rows.variance(self.shared, own.variance).recip();
                let size = weight - weight * weight * taken;
                let off = if size > own_part * weight {
                    (weight * (own.value - said)).abs() / size.sqrt()
                } else {
                    0.0
                };
                found.push(((k, place), off));
            }
        }
        found
    }
}
