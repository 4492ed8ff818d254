//! A block of a mixed model at given variances: what its readings say of what is fixed and of what is left to chance.

use super::model::{MixedModel, Unit};
use crate::dense::Matrix;
use crate::sums::{add, dot};
use crate::symmetric::Symmetric;

/// Least variance of a reading, part of the largest: its inverse must stay a number.
const LEAST_PART: f64 = 1e-12;

/// Sums over the readings of a unit: of powers of their inverse variances, and of these times the value and its square. A
/// reading that counts as `k` adds what `k` readings like it would, for any `k`.
pub(super) struct Sums {
    weight: [f64; 3],
    value: [f64; 2],
    square: [f64; 2],
    log_variance: f64,
}

impl Sums {
    fn of(unit: &Unit, shared: f64, least: f64) -> Sums {
        let mut sums = Sums {
            weight: [0.0; 3],
            value: [0.0; 2],
            square: [0.0; 2],
            log_variance: 0.0,
        };
        for reading in &unit.readings {
            let variance = (shared + reading.variance).max(least);
            let (w, y, count) = (variance.recip(), reading.value, reading.weight);
            sums.log_variance += count * variance.ln();
            for (power, sum) in sums.weight.iter_mut().enumerate() {
                *sum += count * w.powi(power as i32 + 1);
            }
            for power in 0..2 {
                sums.value[power] += count * w.powi(power as i32 + 1) * y;
                sums.square[power] += count * w.powi(power as i32 + 1) * y * y;
            }
        }
        sums
    }

    /// Sum of `w^power (y - at)`.
    pub fn off(&self, power: usize, at: f64) -> f64 {
        self.value[power - 1] - self.weight[power - 1] * at
    }

    /// Sum of `w^power (y - at)^2`.
    pub fn off_square(&self, power: usize, at: f64) -> f64 {
        let k = power - 1;
        self.square[k] - 2.0 * self.value[k] * at + self.weight[k] * at * at
    }
}

/// `[X Z]` without what is taken to chance: `1 - M' Z' D [X Z]` in the rows of `Z`, and one in those of `X`, which stands for
/// itself.
struct Left {
    fixed: usize,
    of_random: Matrix,
}

impl Left {
    /// `of` times this.
    fn after(&self, of: &Matrix) -> Matrix {
        let (rows, all) = (of.count_rows(), self.of_random.count_columns());
        let own = |row, column| {
            if column < self.fixed {
                of.get(row, column)
            } else {
                0.0
            }
        };
        let mut product = Matrix::from_fn(rows, all, own);
        product.add_product(&of.part(0..rows, self.fixed..all), &self.of_random);
        product
    }

    /// The transpose of this times `of`.
    fn before(&self, of: &Matrix) -> Matrix {
        let (all, columns) = (self.of_random.count_columns(), of.count_columns());
        let own = |row, column| {
            if row < self.fixed {
                of.get(row, column)
            } else {
                0.0
            }
        };
        let mut product = Matrix::from_fn(all, columns, own);
        product.add_product(
            &self.of_random.transposed(),
            &of.part(self.fixed..all, 0..columns),
        );
        product
    }
}

/// A block: `V^-1` times its columns of `X` and `Z` as combinations of them, for `V^-1 = D - D Z M Z' D`.
pub(super) struct Block<'a> {
    pub units: Vec<(&'a Unit, Sums)>,
    /// `Z' D Z`.
    pub random: Matrix,
    /// `X' D Z`.
    pub crossed: Matrix,
    /// `M`.
    pub middle: Matrix,
    left: Left,
    /// `[X Z]' V^-1 [X Z]`.
    pub first: Matrix,
    /// `[X Z]' D y`.
    pub values: Vec<f64>,
    pub log_determinant: f64,
}

/// What errors and the curvature of the likelihood need of a block.
pub(super) struct Curved {
    /// `[X Z]' V^-2 [X Z]`.
    pub second: Matrix,
    /// `X' V^-3 X`.
    pub third: Matrix,
    /// Traces of `V^-1` and `V^-2`.
    pub traces: [f64; 2],
}

impl<'a> Block<'a> {
    fn of(units: Vec<(&'a Unit, Sums)>, fixed: usize, roots: &[f64]) -> Block<'a> {
        let (random, all) = (roots.len(), fixed + roots.len());
        let one = weighed(&units, all, 1);
        let own = one.part(fixed..all, fixed..all);
        let unit = |row, column| f64::from(u8::from(row == column));
        let within = Symmetric::from_fn(random, |a, b| unit(a, b) + roots[a] * own.get(a, b) * roots[b]);
        let inverse = within.inverse(0.0);
        let middle = Matrix::from_fn(random, random, |a, b| roots[a] * inverse.get(a, b) * roots[b]);
        let taken = middle.times(&one.part(fixed..all, 0..all));
        let of_random = |row, column| unit(fixed + row, column) - taken.get(row, column);
        let left = Left {
            fixed,
            of_random: Matrix::from_fn(random, all, of_random),
        };
        let mut values = vec![0.0; all];
        for (unit, sums) in &units {
            entries(unit).for_each(|(k, entry)| values[k] += entry * sums.value[0]);
        }
        let log_variance: f64 = units.iter().map(|(_, sums)| sums.log_variance).sum();
        Block {
            log_determinant: log_variance + if random > 0 { within.log_determinant() } else { 0.0 },
            first: left.after(&one),
            random: own,
            crossed: one.part(0..fixed, fixed..all),
            middle,
            left,
            values,
            units,
        }
    }

    /// The rest.
    pub fn curved(&self) -> Curved {
        let (units, middle, left) = (&self.units, &self.middle, &self.left);
        let (fixed, all) = (left.fixed, self.values.len());
        let [two, three] = [2, 3].map(|power| weighed(units, all, power));
        let crossed = left.after(&two.part(fixed..all, 0..all));
        let cubed = left.before(&left.after(&three));
        let lost = crossed.transposed().times(&middle.times(&crossed));
        let [squares, cubes] = [&two, &three].map(|sum| sum.part(fixed..all, fixed..all));
        let weight = |power: usize| units.iter().map(|(_, sums)| sums.weight[power - 1]).sum::<f64>();
        let twice = middle.times(&squares);
        Curved {
            traces: [
                weight(1) - middle.trace_with(&squares),
                weight(2) - 2.0 * middle.trace_with(&cubes) + twice.trace_with(&twice),
            ],
            second: left.before(&left.after(&two)),
            third: Matrix::from_fn(fixed, fixed, |a, b| cubed.get(a, b) - lost.get(a, b)),
        }
    }

    /// `Z' D r` for what the fixed part leaves, and what is left to chance: `M` times that.
    pub fn by_chance(&self, coefficients: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut off = vec![0.0; self.middle.count_rows()];
        for (unit, sums) in &self.units {
            let left = sums.off(1, dot(&unit.fixed, coefficients));
            add(&mut off, left, &unit.random);
        }
        let taken = self.middle.times_vector(&off);
        (off, taken)
    }

    /// `Z' V^-1 r`, and `r' V^-1 r` and `r' V^-2 r`, for what the fixed part leaves.
    pub fn residuals(&self, coefficients: &[f64]) -> (Vec<f64>, [f64; 2]) {
        let said = |unit: &Unit| dot(&unit.fixed, coefficients);
        let (off, taken) = self.by_chance(coefficients);
        let mut squares = [0.0; 2];
        for (unit, sums) in &self.units {
            let own = dot(&unit.random, &taken);
            squares[0] += sums.off_square(1, said(unit));
            squares[1] += sums.off_square(2, said(unit) + own);
        }
        squares[0] -= dot(&off, &taken);
        let back = self.random.times_vector(&taken);
        (off.iter().zip(back).map(|(a, b)| a - b).collect(), squares)
    }
}

/// `[X Z]' D^power [X Z]` of some units.
fn weighed(units: &[(&Unit, Sums)], all: usize, power: usize) -> Matrix {
    let mut sum = Matrix::zero(all, all);
    for (unit, sums) in units {
        let row: Vec<(usize, f64)> = entries(unit).collect();
        for &(a, left) in &row {
            let left = sums.weight[power - 1] * left;
            let of_row = sum.row_mut(a);
            row.iter().for_each(|&(b, right)| of_row[b] += left * right);
        }
    }
    sum
}

/// Least variance of a reading of a model at these variances.
pub(super) fn least_variance(model: &MixedModel, shared: f64) -> f64 {
    let known = model.units.iter().flat_map(|unit| &unit.readings);
    let largest = known.map(|reading| reading.variance).fold(shared, f64::max);
    (LEAST_PART * largest).max(f64::MIN_POSITIVE.sqrt())
}

/// The blocks of a model by their numbers; none where a number has no unit.
pub(super) fn blocks<'a>(model: &'a MixedModel, variances: &[f64]) -> Option<Vec<Option<Block<'a>>>> {
    let fixed = model.units.first()?.fixed.len();
    let (&shared, of_components) = variances.split_last()?;
    let least = least_variance(model, shared);
    let roots: Vec<f64> = (model.component_of.iter())
        .map(|&of| of_components[of].max(0.0).sqrt())
        .collect();
    let count = model.units.iter().map(|unit| unit.block + 1).max()?;
    let mut units: Vec<Vec<(&Unit, Sums)>> = (0..count).map(|_| Vec::new()).collect();
    for unit in &model.units {
        units[unit.block].push((unit, Sums::of(unit, shared, least)));
    }
    let block = |units: Vec<_>| (!units.is_empty()).then(|| Block::of(units, fixed, &roots));
    Some(units.into_iter().map(block).collect())
}

/// Entries of a unit's row of `[X Z]` that are not zero.
fn entries(unit: &Unit) -> impl Iterator<Item = (usize, f64)> {
    let all = unit.fixed.iter().chain(&unit.random).copied().enumerate();
    all.filter(|(_, entry)| *entry != 0.0)
}
