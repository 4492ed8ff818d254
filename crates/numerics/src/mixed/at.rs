//! A mixed model at given variances: its likelihood, what that says of the variances, and what the errors need.

use super::block::{Block, blocks};
use super::model::MixedModel;
use crate::dense::Matrix;
use crate::symmetric::Symmetric;

/// Pivot, part of the diagonal, below which `X` has lost a direction.
const LOST: f64 = 1e-11;

/// What the fixed part leaves of a block ([`Block::residuals`]).
type Residuals = (Vec<f64>, [f64; 2]);

/// What is known at given variances without the curvature of the likelihood, which costs most and is not asked where that is less
/// than it was.
pub struct Likely<'a> {
    model: &'a MixedModel,
    blocks: Vec<(Block<'a>, Residuals)>,
    /// What is fixed.
    pub coefficients: Vec<f64>,
    /// Its covariance by these variances.
    pub covariance: Symmetric,
    /// Logarithm of the restricted likelihood, without its constant.
    pub log_likelihood: f64,
}

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

impl<'a> Likely<'a> {
    /// None where `X` loses a direction.
    pub fn of(model: &'a MixedModel, variances: &[f64]) -> Option<Likely<'a>> {
        let fixed = model.units.first()?.fixed.len();
        let blocks: Vec<Block> = blocks(model, variances)?.into_iter().flatten().collect();
        let mut normal = Matrix::zero(fixed, fixed);
        let mut right = vec![0.0; fixed];
        for block in &blocks {
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
        let mut log_likelihood = -0.5 * normal.log_determinant();
        let mut with_residuals = Vec::with_capacity(blocks.len());
        for block in blocks {
            let residuals = block.residuals(&coefficients);
            log_likelihood -= 0.5 * (block.log_determinant + residuals.1[0]);
            with_residuals.push((block, residuals));
        }
        Some(Likely {
            model,
            blocks: with_residuals,
            coefficients,
            covariance,
            log_likelihood,
        })
    }
}

impl At {
    /// None where `X` loses a direction.
    pub fn of(model: &MixedModel, variances: &[f64]) -> Option<At> {
        Some(At::whole(Likely::of(model, variances)?))
    }

    /// With the rest.
    pub fn whole(likely: Likely) -> At {
        let (fixed, parts) = (likely.coefficients.len(), likely.model.components() + 1);
        let mut at = At {
            log_likelihood: likely.log_likelihood,
            score: vec![0.0; parts],
            information: Symmetric::zero(parts),
            by_one: vec![Matrix::zero(fixed, fixed); parts],
            by_two: vec![vec![Matrix::zero(fixed, fixed); parts]; parts],
            coefficients: likely.coefficients,
            covariance: likely.covariance,
        };
        let mut traces = vec![vec![0.0; parts]; parts];
        for (block, residuals) in &likely.blocks {
            at.add(likely.model, (block, residuals), &mut traces);
        }
        at.finish(&traces);
        at
    }

    /// Adds what one block says; the trace of `V^-1 V_r V^-1 V_s` goes into `traces`.
    fn add(&mut self, model: &MixedModel, (block, residuals): (&Block, &Residuals), traces: &mut [Vec<f64>]) {
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
        let (by_random, off_square) = residuals;
        let curved = block.curved();
        self.score[of_readings] += 0.5 * (off_square[1] - curved.traces[0]);
        self.by_one[of_readings].add_all(&curved.second.part(0..fixed, 0..fixed));
        self.by_two[of_readings][of_readings].add_all(&curved.third);
        traces[of_readings][of_readings] += curved.traces[1];
        let all: Vec<Vec<usize>> = (0..of_readings).map(columns).collect();
        let first: Vec<Matrix> = all.iter().map(|of| crossed(&block.first, of)).collect();
        for (r, own) in all.iter().enumerate() {
            let square: f64 = own.iter().map(|&k| by_random[k - fixed].powi(2)).sum();
            let trace: f64 = own.iter().map(|&k| block.first.get(k, k)).sum();
            self.score[r] += 0.5 * (square - trace);
            self.by_one[r].add_all(&first[r].times(&first[r].transposed()));
            let with_readings = first[r].times(&crossed(&curved.second, own).transposed());
            self.by_two[of_readings][r].add_all(&with_readings.transposed());
            self.by_two[r][of_readings].add_all(&with_readings);
            let squares: f64 = own.iter().map(|&k| curved.second.get(k, k)).sum();
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
