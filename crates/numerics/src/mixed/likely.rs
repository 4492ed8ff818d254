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

    /// Logarithm of the restricted likelihood with components of these variances, without its constant.
    pub fn log_likelihood(&self, variances: &[f64], room: &mut Room) -> f64 {
        let (log_determinant, taken) = self.of_components(variances, room);
        self.log_likelihood - 0.5 * (log_determinant - taken)
    }

    /// Square of what is left with components of these variances, each reading in its error.
    pub fn square_beside(&self, variances: &[f64]) -> f64 {
        self.square - self.of_components(variances, &mut Room::default()).1
    }

    /// What components of these variances add to the logarithm of the determinant, and what they take from the square.
    fn of_components(&self, variances: &[f64], room: &mut Room) -> (f64, f64) {
        self.write_inner(variances, 0, room);
        let Some(log_determinant) = room.eliminate() else {
            return (f64::NAN, f64::NAN);
        };
        let pull = room.rows().map(|row| row[row.len() - 1]);
        (log_determinant, pull.map(|own| own * own).sum())
    }

    /// What is known with components of these variances; none where they are no numbers.
    pub fn with(&self, variances: &[f64], room: &mut Room) -> Option<Likely> {
        let fixed = self.coefficients.len();
        let mut likely = Likely {
            coefficients: self.coefficients.clone(),
            covariance: self.covariance.clone(),
        };
        self.write_inner(variances, fixed, room);
        room.eliminate()?;
        for row in room.rows() {
            let (pull, through) = (row[row.len() - 1], &row[row.len() - 1 - fixed..row.len() - 1]);
            let coefficients = likely.coefficients.iter_mut().zip(through);
            coefficients.for_each(|(own, through)| *own -= through * pull);
            likely.covariance.add_square(1.0, through);
        }
        Some(likely)
    }

    /// Writes `1 + G^1/2 S G^1/2` of the columns whose variances are not nothing, and behind each row what goes through it to so
    /// many fixed columns, and what pulls at it.
    fn write_inner(&self, variances: &[f64], fixed: usize, room: &mut Room) {
        room.of_columns(&self.rows.component_of, variances);
        room.width = room.columns.len() + fixed + 1;
        room.entries.clear();
        for (at, (&column, root)) in room.columns.iter().zip(&room.roots).enumerate() {
            let own = self.own.row(column);
            let others = room.columns.iter().zip(&room.roots);
            room.entries
                .extend(others.map(|(other, of)| root * own[*other] * of));
            let begin = room.entries.len() - room.columns.len();
            room.entries[begin + at] += 1.0;
            let through = self.through[column].iter().take(fixed);
            room.entries.extend(through.map(|own| root * own));
            room.entries.push(root * self.towards[column]);
        }
    }
}

/// Room for what is worked out at one place of the scatters, used again at the next: rows of a matrix with what stands behind them.
#[derive(Default)]
pub(super) struct Room {
    /// Columns of components that are not nothing, with the roots of their variances.
    columns: Vec<usize>,
    roots: Vec<f64>,
    entries: Vec<f64>,
    width: usize,
}

impl Room {
    fn of_columns(&mut self, component_of: &[usize], variances: &[f64]) {
        self.columns.clear();
        self.roots.clear();
        for (column, of) in component_of.iter().enumerate() {
            let root = variances[*of].max(0.0).sqrt();
            if root > 0.0 {
                self.columns.push(column);
                self.roots.push(root);
            }
        }
    }

    fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.entries.chunks_exact(self.width)
    }

    /// Makes of the matrix the transpose of its Cholesky factor `L`, of what stands behind it the solution of `L x = right`; the
    /// logarithm of the determinant, or none where a pivot is no positive number.
    fn eliminate(&mut self) -> Option<f64> {
        let mut log_determinant = 0.0;
        for at in 0..self.columns.len() {
            let (before, below) = self.entries.split_at_mut((at + 1) * self.width);
            let own = &mut before[at * self.width..][at..];
            let pivot = own[0];
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            log_determinant += pivot.ln();
            let root = pivot.sqrt().recip();
            own.iter_mut().for_each(|entry| *entry *= root);
            for (k, row) in below.chunks_exact_mut(self.width).enumerate() {
                let factor = own[k + 1];
                let rest = row[at + k + 1..].iter_mut().zip(&own[k + 1..]);
                rest.for_each(|(entry, own)| *entry -= factor * own);
            }
        }
        Some(log_determinant)
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
        let mut room = Room::default();
        room.of_columns(&self.rows.component_of, variances);
        let (columns, roots) = (&room.columns, &room.roots);
        let inner = Symmetric::from_fn(columns.len(), |a, b| {
            f64::from(u8::from(a == b)) + roots[a] * self.own.get(columns[a], columns[b]) * roots[b]
        });
        let inverse = inner.inverse(0.0);
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
