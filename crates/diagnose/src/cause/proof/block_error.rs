//! Held-out readings of a channel of a run beside what was predicted of them, and the odds of two predictions.
//!
//! No model is exact, and how large its error is, is not known before: of readings that were held out, the error of each channel
//! of each run has on each scale of time a size of its own, which is at least the noise. The odds of two predictions are then, scale
//! by scale, the ratio of their mean squares to the power of half the readings that tell by themselves: an error that goes on for
//! the whole run is one of these, one that stands at an edge alone is three, and one that is below the noise of a reading still
//! shows in the sum of all. Where the noise is all that is left, these are the odds of the likelihood.

use ieap_numerics::sums::dot;

use crate::readings::group::{Block, RunGroup};

/// Held-out readings of one channel of one run beside what was predicted of them, in units of the noise, on each scale of time from
/// neighbours to the whole run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BlockError {
    scales: Vec<Scale>,
}

/// The errors on one scale of time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Scale {
    errors: f64,
    /// Mean of their squares, in that of the noise.
    square: f64,
    /// Mean fourth power over what it is of normal errors with these squares, beyond chance: 1 where all are of one size, a third of
    /// their number where one is all that there is.
    apart: f64,
}

impl Scale {
    fn of(errors: &[f64]) -> Scale {
        let count = errors.len() as f64;
        let mean = |power: i32| errors.iter().map(|v| v.powi(power)).sum::<f64>() / count;
        let square = mean(2);
        Scale {
            errors: count,
            square,
            apart: (mean(4) / (3.0 * square * square).max(f64::MIN_POSITIVE) - by_chance(count)).max(1.0),
        }
    }

    /// Never less than the noise.
    fn size(self) -> f64 {
        self.square.max(1.0)
    }
}

/// How much larger the ratio of [`Scale::apart`] is of so many normal errors by two standard deviations of chance.
fn by_chance(count: f64) -> f64 {
    2.0 * (24.0 / count).sqrt() / 3.0
}

impl BlockError {
    /// Of the readings that are wanted by their row in the group; none of none.
    pub(crate) fn of(
        group: &RunGroup,
        block: &Block,
        fitted: &[f64],
        wanted: &dyn Fn(usize) -> bool,
    ) -> Option<BlockError> {
        let mut left = Vec::new();
        group.channel(block)?.residuals(fitted, &mut left);
        let rows = left.iter().enumerate();
        let kept: Vec<f64> = rows
            .filter(|(k, _)| wanted(block.first + k))
            .map(|(_, v)| *v)
            .collect();
        BlockError::new(kept)
    }

    /// Of errors in units of the noise; none of none.
    pub(crate) fn new(errors: Vec<f64>) -> Option<BlockError> {
        let square = dot(&errors, &errors);
        (square > 0.0 && square.is_finite()).then(|| BlockError {
            scales: scales(errors),
        })
    }

    /// Logarithm of the odds of this prediction over another one of the same readings.
    pub(crate) fn log_odds(&self, other: &BlockError) -> f64 {
        let pairs = self.scales.iter().zip(&other.scales);
        pairs
            .map(|(own, other)| {
                let by_themselves = own.errors / own.apart.max(other.apart);
                0.5 * by_themselves * (other.size() / own.size()).ln()
            })
            .sum()
    }
}

/// Errors on each scale of time: differences of neighbours, of sums of neighbours, and so on, and the sum of all (Haar's wavelets,
/// so that noise of one size has that size on every scale).
fn scales(mut values: Vec<f64>) -> Vec<Scale> {
    let mut found = Vec::new();
    while values.len() > 1 {
        let pairs = values.chunks_exact(2);
        let apart: Vec<f64> = pairs.map(|pair| (pair[0] - pair[1]) / 2.0_f64.sqrt()).collect();
        found.push(Scale::of(&apart));
        // One without a neighbour stands for itself.
        let together = |pair: &[f64]| pair.iter().sum::<f64>() / (pair.len() as f64).sqrt();
        values = values.chunks(2).map(together).collect();
    }
    found.extend((!values.is_empty()).then(|| Scale::of(&values)));
    found
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    fn noise() -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        (0..512).map(|_| StandardNormal.sample(&mut random)).collect()
    }

    fn log_odds_of(before: impl Fn(f64) -> f64, after: impl Fn(f64) -> f64) -> f64 {
        let error = |of: &dyn Fn(f64) -> f64| BlockError {
            scales: scales(noise().into_iter().map(of).collect()),
        };
        error(&after).log_odds(&error(&before))
    }

    /// In noise alone the odds are those of the likelihood; of an error that goes on for the whole run one reading tells.
    #[test]
    fn a_gain_counts_by_the_readings_that_tell_by_themselves() {
        let in_noise = log_odds_of(|v| 3.0 * 1.02 * v, |v| 3.0 * v);
        assert!((in_noise - 512.0 * 1.02_f64.ln()).abs() < 0.2, "{in_noise}");
        let for_all = log_odds_of(|_| 10.0, |_| 1.0);
        assert!((for_all - 10.0_f64.ln()).abs() < 1e-9, "{for_all}");
        assert!(log_odds_of(|_| 1.0, |_| 10.0) < 0.0);
    }

    /// A third of the noise of one reading, throughout, is seven times that of their sum.
    #[test]
    fn an_offset_below_the_noise_of_a_reading_counts_as_one_that_is_seen() {
        let found = log_odds_of(|v| v + 0.33, |v| v);
        assert!(found > 1.0 && found < 3.0, "{found}");
        assert!(log_odds_of(|v| v, |v| v).abs() < 1e-12);
    }

    /// A twentieth less of an error that one reading has decides nothing, however many readings there are.
    #[test]
    fn what_stands_at_an_edge_alone_counts_as_few() {
        let spike = |size: f64| log_odds_at(|k| if k == 0 { size } else { 0.0 });
        fn log_odds_at(of: impl Fn(usize) -> f64) -> BlockError {
            BlockError {
                scales: scales((0..512).map(of).collect()),
            }
        }
        let found = spike(950.0).log_odds(&spike(1000.0));
        assert!(found > 0.0 && found < 1.5, "{found}");
    }
}
