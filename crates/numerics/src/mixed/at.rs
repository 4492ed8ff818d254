//! A mixed model at given variances: its likelihood, what that says of the variances, and what the errors need.

use super::model::{MixedModel, Unit};
use crate::dense::Matrix;
use crate::grouped::dot;
use crate::symmetric::Symmetric;

/// Pivot, part of the diagonal, below which `X` has lost a direction.
const LOST: f64 = 1e-11;
/// Least variance of a reading, part of the largest: its inverse must stay a number.
const LEAST_PART: f64 = 1e-12;

/// All that is known at given variances.
pub struct At {
    /// What is fixed.
    pub coefficients: Vec<f64>,
    /// Its covariance by these variances.
    pub covariance: Symmetric,
    /// Logarithm of the restricted likelihood, without its constant.
    pub log_likelihood: f64,
    /// Its derivative by each variance.
    pub score: Vec<f64>,
    /// Its expected curvature.
    pub information: Symmetric,
    /// `X' V^-1 V_r V^-1 X` for each variance.
    pub by_one: Vec<Matrix>,
    /// `X' V^-1 V_r V^-1 V_s V^-1 X` for each pair.
    pub by_two: Vec<Vec<Matrix>>,
}

/// Sums over the readings of a unit: of powers of their inverse variances, and of these times the value and its square. A
/// reading that counts as `k` adds what `k` readings like it would, for any `k`.
struct Sums {
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
    fn off(&self, power: usize, at: f64) -> f64 {
        self.value[power - 1] - self.weight[power - 1] * at
    }

    /// Sum of `w^power (y - at)^2`.
    fn off_square(&self, power: usize, at: f64) -> f64 {
        let k = power - 1;
        self.square[k] - 2.0 * self.value[k] * at + self.weight[k] * at * at
    }
}

/// A block: `V^-1` times its columns of `X` and `Z` as combinations of them, for `V^-1 = D - D Z M Z' D`.
pub(super) struct Block<'a> {
    units: Vec<(&'a Unit, Sums)>,
    /// `Z' D Z`.
    random: Matrix,
    /// `X' D Z`.
    pub crossed: Matrix,
    /// `M`.
    pub middle: Matrix,
    /// `[X Z]' V^-1 [X Z]`, then with `V^-2`.
    first: Matrix,
    second: Matrix,
    /// `X' V^-3 X`.
    third: Matrix,
    /// `[X Z]' D y`.
    values: Vec<f64>,
    log_determinant: f64,
    /// Traces of `V^-1` and `V^-2`.
    traces: [f64; 2],
}

impl<'a> Block<'a> {
    fn of(units: Vec<(&'a Unit, Sums)>, fixed: usize, roots: &[f64]) -> Block<'a> {
        let (random, all) = (roots.len(), fixed + roots.len());
        let sum = |power: usize| {
            let mut sum = Matrix::zero(all, all);
            for (unit, sums) in &units {
                let row: Vec<(usize, f64)> = entries(unit).collect();
                for &(a, left) in &row {
                    for &(b, right) in &row {
                        sum.add(a, b, sums.weight[power - 1] * left * right);
                    }
                }
            }
            sum
        };
        let [one, two, three] = [1, 2, 3].map(sum);
        let own = one.part(fixed..all, fixed..all);
        let unit = |row, column| f64::from(u8::from(row == column));
        let within = Symmetric::from_fn(random, |a, b| unit(a, b) + roots[a] * own.get(a, b) * roots[b]);
        let inverse = within.inverse(0.0);
        let middle = Matrix::from_fn(random, random, |a, b| roots[a] * inverse.get(a, b) * roots[b]);
        let taken = middle.times(&one.part(fixed..all, 0..all));
        let left = Matrix::from_fn(all, all, |row, column| {
            unit(row, column)
                - if row < fixed {
                    0.0
                } else {
                    taken.get(row - fixed, column)
                }
        });
        let crossed = two.part(fixed..all, 0..all).times(&left);
        let cubed = left.transposed().times(&three.times(&left));
        let lost = crossed.transposed().times(&middle.times(&crossed));
        let mut values = vec![0.0; all];
        for (unit, sums) in &units {
            entries(unit).for_each(|(k, entry)| values[k] += entry * sums.value[0]);
        }
        let [squares, cubes] = [&two, &three].map(|sum| sum.part(fixed..all, fixed..all));
        let weight = |power: usize| units.iter().map(|(_, sums)| sums.weight[power - 1]).sum::<f64>();
        let twice = middle.times(&squares);
        let log_variance: f64 = units.iter().map(|(_, sums)| sums.log_variance).sum();
        Block {
            traces: [
                weight(1) - middle.trace_with(&squares),
                weight(2) - 2.0 * middle.trace_with(&cubes) + twice.trace_with(&twice),
            ],
            log_determinant: log_variance + if random > 0 { within.log_determinant() } else { 0.0 },
            first: one.times(&left),
            second: left.transposed().times(&two.times(&left)),
            third: Matrix::from_fn(fixed, fixed, |a, b| cubed.get(a, b) - lost.get(a, b)),
            random: own,
            crossed: one.part(0..fixed, fixed..all),
            middle,
            values,
            units,
        }
    }
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

impl At {
    /// None where `X` loses a direction.
    pub fn of(model: &MixedModel, variances: &[f64]) -> Option<At> {
        let fixed = model.units.first()?.fixed.len();
        let blocks: Vec<Block> = blocks(model, variances)?.into_iter().flatten().collect();
        At::summed(model, &blocks, fixed)
    }

    fn summed(model: &MixedModel, blocks: &[Block], fixed: usize) -> Option<At> {
        let mut normal = Matrix::zero(fixed, fixed);
        let mut right = vec![0.0; fixed];
        for block in blocks {
            normal.add_all(&block.first.part(0..fixed, 0..fixed));
            let random = block.middle.times_vector(&block.values[fixed..]);
            let taken = block.crossed.times_vector(&random);
            for (k, sum) in right.iter_mut().enumerate() {
                *sum += block.values[k] - taken.get(k).copied().unwrap_or(0.0);
            }
        }
        let normal = normal.symmetric();
        normal.cholesky(LOST)?;
        let covariance = normal.inverse(LOST);
        let coefficients = covariance.times(&right);
        let parts = model.components() + 1;
        let mut at = At {
            log_likelihood: -0.5 * normal.log_determinant(),
            score: vec![0.0; parts],
            information: Symmetric::zero(parts),
            by_one: vec![Matrix::zero(fixed, fixed); parts],
            by_two: vec![vec![Matrix::zero(fixed, fixed); parts]; parts],
            coefficients,
            covariance,
        };
        let mut traces = vec![vec![0.0; parts]; parts];
        for block in blocks {
            at.add(model, block, &mut traces);
        }
        at.finish(&traces);
        Some(at)
    }

    /// Adds what one block says; the trace of `V^-1 V_r V^-1 V_s` goes into `traces`.
    fn add(&mut self, model: &MixedModel, block: &Block, traces: &mut [Vec<f64>]) {
        let fixed = self.coefficients.len();
        let of_readings = self.score.len() - 1;
        let columns = |component: usize| -> Vec<usize> {
            let of = model.component_of.iter().enumerate();
            of.filter(|(_, of)| **of == component)
                .map(|(k, _)| fixed + k)
                .collect()
        };
        let crossed = |from: &Matrix, of: &[usize]| {
            Matrix::from_fn(fixed, of.len(), |row, column| from.get(row, of[column]))
        };
        let (by_random, off_square) = self.residuals(block);
        self.score[of_readings] += 0.5 * (off_square[1] - block.traces[0]);
        self.log_likelihood -= 0.5 * (block.log_determinant + off_square[0]);
        self.by_one[of_readings].add_all(&block.second.part(0..fixed, 0..fixed));
        self.by_two[of_readings][of_readings].add_all(&block.third);
        traces[of_readings][of_readings] += block.traces[1];
        let all: Vec<Vec<usize>> = (0..of_readings).map(columns).collect();
        let first: Vec<Matrix> = all.iter().map(|of| crossed(&block.first, of)).collect();
        for (r, own) in all.iter().enumerate() {
            let square: f64 = own.iter().map(|&k| by_random[k - fixed].powi(2)).sum();
            let trace: f64 = own.iter().map(|&k| block.first.get(k, k)).sum();
            self.score[r] += 0.5 * (square - trace);
            self.by_one[r].add_all(&first[r].times(&first[r].transposed()));
            let with_readings = first[r].times(&crossed(&block.second, own).transposed());
            self.by_two[of_readings][r].add_all(&with_readings.transposed());
            self.by_two[r][of_readings].add_all(&with_readings);
            let squares: f64 = own.iter().map(|&k| block.second.get(k, k)).sum();
            traces[r][of_readings] += squares;
            traces[of_readings][r] += squares;
            for (s, other) in all.iter().enumerate() {
                let between =
                    Matrix::from_fn(own.len(), other.len(), |a, b| block.first.get(own[a], other[b]));
                traces[r][s] += between.trace_with(&between.transposed());
                self.by_two[r][s].add_all(&first[r].times(&between.times(&first[s].transposed())));
            }
        }
    }

    /// `Z' D r` for what the fixed part leaves of a block, and what is left to chance in it: `M` times that.
    pub(super) fn by_chance(&self, block: &Block) -> (Vec<f64>, Vec<f64>) {
        let mut off = vec![0.0; block.middle.count_rows()];
        for (unit, sums) in &block.units {
            let left = sums.off(1, dot(&unit.fixed, &self.coefficients));
            off.iter_mut()
                .zip(&unit.random)
                .for_each(|(sum, z)| *sum += z * left);
        }
        let taken = block.middle.times_vector(&off);
        (off, taken)
    }

    /// `Z' V^-1 r`, and `r' V^-1 r` and `r' V^-2 r`, for what the fixed part leaves of a block.
    fn residuals(&self, block: &Block) -> (Vec<f64>, [f64; 2]) {
        let said = |unit: &Unit| dot(&unit.fixed, &self.coefficients);
        let (off, taken) = self.by_chance(block);
        let mut squares = [0.0; 2];
        for (unit, sums) in &block.units {
            let own = dot(&unit.random, &taken);
            squares[0] += sums.off_square(1, said(unit));
            squares[1] += sums.off_square(2, said(unit) + own);
        }
        squares[0] -= off.iter().zip(&taken).map(|(a, b)| a * b).sum::<f64>();
        let back = block.random.times_vector(&taken);
        (off.iter().zip(back).map(|(a, b)| a - b).collect(), squares)
    }

    /// Takes from traces and scores what the fixed part costs.
    fn finish(&mut self, traces: &[Vec<f64>]) {
        let covariance = Matrix::from(&self.covariance);
        let weighed: Vec<Matrix> = self.by_one.iter().map(|one| covariance.times(one)).collect();
        for (score, weighed) in self.score.iter_mut().zip(&weighed) {
            *score += 0.5 * weighed.trace();
        }
        let parts = self.score.len();
        self.information = Symmetric::from_fn(parts, |r, s| {
            let once = covariance.trace_with(&self.by_two[r][s]);
            0.5 * (traces[r][s] - 2.0 * once + weighed[r].trace_with(&weighed[s]))
        });
    }
}
