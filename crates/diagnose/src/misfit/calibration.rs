//! What the p of a misfit is worth: the whole procedure simulated on readings in which nothing is wrong.
//!
//! The null distribution takes the noise as known up to its size. In truth its memory was found in the same residuals,
//! which makes small p too frequent where the memory is long. So noise like that of the group is drawn, refitted, its
//! size and memory found again, and asked the same questions; the normal scores of the p that come out say how the
//! group's own must be read (Beran 1987 calls it prepivoting).

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use ieap_fit::{FoundAgain, NoiseAgain, Pair, Scaled};
use ieap_numerics::interrupt;
use ieap_numerics::sums::{dot, mean, standard_deviation};
use ieap_numerics::symmetric::Symmetric;

use crate::fitting::tangent::Tangent;
use crate::misfit::null::Null;
use crate::misfit::policy::{
    CALIBRATION_DRAWS, CALIBRATION_PRODUCTS, FEWEST_CALIBRATION_DRAWS, SMALL_IN_ANY_CASE,
};
use crate::misfit::residual_bins::ResidualBin;
use crate::misfit::signature::{Direction, Signature};
use crate::readings::group::RunGroup;

/// Part of the largest pivot below which a column of the tangent counts as one of the others: it is orthonormal but for
/// how the noise differs.
const SINGULAR: f64 = 1e-12;
/// Set apart from other uses of the same seed.
const STREAM: u64 = 1 << 40;

/// How normal scores of p lie where nothing is wrong: mean and standard deviation, 0 and 1 for a perfect p, known from
/// so many draws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Calibration {
    mean: f64,
    standard_deviation: f64,
    draws: f64,
}

/// What is asked.
pub(crate) struct Asked<'a> {
    pub(crate) group: &'a RunGroup<'a>,
    pub(crate) null: &'a Null,
    pub(crate) tangent: &'a Tangent,
    pub(crate) signatures: &'a [Signature],
    pub(crate) directions: &'a [Direction],
    pub(crate) bins: &'a [ResidualBin],
    pub(crate) seed: u64,
}

impl Calibration {
    /// By simulation; the outcome does not depend on the number of threads.
    pub(crate) fn of(asked: &Asked) -> Calibration {
        let simulation = Simulation::new(asked);
        let products = asked.group.rows() as f64 * asked.directions.len().max(1) as f64;
        let draws =
            ((CALIBRATION_PRODUCTS / products) as usize).clamp(FEWEST_CALIBRATION_DRAWS, CALIBRATION_DRAWS);
        let normal = Normal::standard();
        let scores: Vec<f64> = (0..draws as u64)
            .into_par_iter()
            .map(|draw| normal.inverse_cdf(simulation.p(asked, draw).clamp(1e-12, 1.0 - 1e-12)))
            .collect();
        Calibration {
            mean: mean(&scores),
            standard_deviation: standard_deviation(&scores).max(0.1),
            draws: scores.len() as f64,
        }
    }

    /// Whether a p is so small that it need not be calibrated.
    pub(crate) fn is_needless(p: f64) -> bool {
        p < SMALL_IN_ANY_CASE
    }

    /// The probability of so small a p where nothing is wrong: that a further score, of a normal distribution known from
    /// the draws, is as low.
    pub(crate) fn calibrated(&self, p: f64) -> f64 {
        let score = Normal::standard().inverse_cdf(p.clamp(1e-300, 1.0 - 1e-12));
        let error = self.standard_deviation * (1.0 + 1.0 / self.draws).sqrt();
        let ratio = (score - self.mean) / error;
        StudentsT::new(0.0, 1.0, self.draws - 1.0).map_or(p, |t| t.cdf(ratio))
    }
}

/// What all draws share: series in the units of the readings, what finds the noise, and what inner products are in it.
struct Simulation {
    again: Vec<NoiseAgain>,
    tangent: Vec<Vec<f64>>,
    candidates: Vec<Vec<f64>>,
    /// Of every candidate: its square, and its products with the tangent.
    squares: Vec<Product>,
    absorbed: Vec<Vec<Product>>,
    /// Products of the tangent with itself.
    normal: Vec<Vec<Product>>,
}

/// An inner product of two series, by blocks.
type Product = Vec<Pair>;

impl Simulation {
    fn new(asked: &Asked) -> Simulation {
        let group = asked.group;
        let again: Vec<NoiseAgain> = group
            .blocks
            .iter()
            .filter_map(|block| group.channel(block))
            .map(|channel| channel.noise_again())
            .collect();
        let raw = |white: &[f64]| coloured(group, white.to_vec());
        let tangent: Vec<Vec<f64>> = asked.tangent.basis().iter().map(|column| raw(column)).collect();
        let candidates: Vec<Vec<f64>> = asked
            .directions
            .par_iter()
            .map(|direction| raw(asked.signatures[direction.signature].change()))
            .collect();
        let each = |series: &[f64]| -> Vec<Scaled> {
            let blocks = group.blocks.iter().zip(&again);
            blocks
                .map(|(block, again)| again.scaled(&series[block.first..block.end]))
                .collect()
        };
        let product = |a: &[Scaled], b: &[Scaled]| -> Product {
            let blocks = again.iter().zip(a.iter().zip(b));
            blocks.map(|(again, (a, b))| again.pair(a, b)).collect()
        };
        let scaled: Vec<Vec<Scaled>> = tangent.iter().map(|column| each(column)).collect();
        let with_all = |a: &[Scaled]| -> Vec<Product> { scaled.iter().map(|b| product(a, b)).collect() };
        let (squares, absorbed) = candidates
            .par_iter()
            .map(|candidate| {
                let own = each(candidate);
                (product(&own, &own), with_all(&own))
            })
            .unzip();
        let normal = scaled.iter().map(|a| with_all(a)).collect();
        Simulation {
            squares,
            absorbed,
            normal,
            again,
            tangent,
            candidates,
        }
    }

    /// The p of one group in which nothing is wrong.
    fn p(&self, asked: &Asked, draw: u64) -> f64 {
        interrupt::check();
        let group = asked.group;
        let mut generator = ChaCha8Rng::seed_from_u64(asked.seed);
        generator.set_stream(STREAM + draw);
        let mut noise: Vec<f64> = (0..group.rows())
            .map(|_| StandardNormal.sample(&mut generator))
            .collect();
        asked.tangent.remove(&mut noise);
        let rest = coloured(group, noise);
        let found = self.found(group, &rest);
        let whitened = |raw: &[f64]| -> Vec<f64> {
            let mut series = raw.to_vec();
            for (block, found) in group.blocks.iter().zip(&found) {
                found.whiten(&mut series[block.first..block.end]);
            }
            series
        };
        let transposed = |mut series: Vec<f64>| -> Vec<f64> {
            for (block, found) in group.blocks.iter().zip(&found) {
                found.transpose(&mut series[block.first..block.end]);
            }
            series
        };
        let tangent: Tangent = Tangent::of(&self.tangent.iter().map(|raw| whitened(raw)).collect::<Vec<_>>());
        let mut residuals = whitened(&rest);
        tangent.remove(&mut residuals);
        let means: Vec<f64> = asked
            .bins
            .iter()
            .zip(asked.null.uses_bin())
            .filter(|(_, used)| *used)
            .map(|(bin, _)| mean_of(bin, &residuals, &tangent))
            .collect();
        let answer = transposed(residuals);
        let product = |pairs: &Product| -> f64 {
            let blocks = found.iter().zip(pairs);
            blocks.map(|(found, pair)| found.product(pair)).sum()
        };
        let normal = Symmetric::from_fn(self.normal.len(), |a, b| product(&self.normal[a][b]));
        let inverse = normal.inverse(SINGULAR);
        let gain = |(place, direction): (usize, &Direction)| {
            let absorbed: Vec<f64> = self.absorbed[place].iter().map(&product).collect();
            let square = product(&self.squares[place]) - inverse.form(&absorbed, &absorbed);
            let z = dot(&answer, &self.candidates[place]);
            if square > 0.0 && (z > 0.0 || !direction.one_sided) {
                z * z / square
            } else {
                0.0
            }
        };
        let gains: Vec<f64> = asked.directions.iter().enumerate().map(gain).collect();
        asked.null.p_of_simulated(&means, &gains, &mut generator)
    }

    /// The noise of every channel found again in simulated residuals.
    fn found(&self, group: &RunGroup, rest: &[f64]) -> Vec<FoundAgain> {
        let of = |place: usize| {
            let block = &group.blocks[place];
            (&self.again[place], &rest[block.first..block.end])
        };
        let mut found: Vec<Option<FoundAgain>> = group.blocks.iter().map(|_| None).collect();
        for kind in 0..2 {
            let is_sharing = |place: &usize| {
                let block = &group.blocks[*place];
                block.channel == kind && group.channel(block).is_some_and(|channel| channel.is_shared())
            };
            let sharing: Vec<usize> = (0..group.blocks.len()).filter(is_sharing).collect();
            let all: Vec<(&NoiseAgain, &[f64])> = sharing.iter().map(|&place| of(place)).collect();
            for (&place, own) in sharing.iter().zip(NoiseAgain::find_shared(&all)) {
                found[place] = Some(own);
            }
        }
        let each = found.into_iter().enumerate();
        each.map(|(place, own)| {
            own.unwrap_or_else(|| {
                let (again, rest) = of(place);
                again.find(rest)
            })
        })
        .collect()
    }
}

/// White series in the units of the readings.
fn coloured(group: &RunGroup, mut series: Vec<f64>) -> Vec<f64> {
    for block in &group.blocks {
        if let Some(channel) = group.channel(block) {
            channel.colour(&mut series[block.first..block.end]);
        }
    }
    series
}

/// Mean of refitted residuals over a bin, in its standard errors.
fn mean_of(bin: &ResidualBin, residuals: &[f64], tangent: &Tangent) -> f64 {
    let absorbed: f64 = tangent
        .basis()
        .iter()
        .map(|column| bin.over(column).powi(2))
        .sum();
    bin.over(residuals) / (1.0 - absorbed).max(1e-3).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_perfect_p_stays_and_a_shifted_one_is_put_back() {
        let many = |mean, standard_deviation| Calibration {
            mean,
            standard_deviation,
            draws: 1e6,
        };
        for p in [0.001, 0.05, 0.5, 0.9] {
            assert!((many(0.0, 1.0).calibrated(p) / p - 1.0).abs() < 1e-3, "{p}");
        }
        // Where clean readings give scores half a deviation too high, a score of -1.145 is one of -1.645.
        let p = Normal::standard().cdf(-1.144_854);
        assert!((many(0.5, 1.0).calibrated(p) - 0.05).abs() < 1e-4);
        // Few draws leave the tail uncertain.
        let few = Calibration {
            draws: 30.0,
            ..many(0.0, 1.0)
        };
        assert!(few.calibrated(0.001) > 0.002);
    }
}
