//! Whether a law predicts what it has not seen better, by the size of the error and beyond its doubt.
//!
//! No model is exact, and how large its error is, is not known before: of readings that were held out, the error of each channel
//! of each run has on each scale of time a size of its own, which is at least the noise. The odds of two predictions are then, scale
//! by scale, the ratio of their mean squares to the power of half the readings that tell by themselves: an error that goes on for
//! the whole run is one of these, and one that is below the noise of a reading still shows in the sum of all. Where the noise is
//! all that is left, these are the odds of the likelihood.

use ieap_numerics::sums::dot;

use super::held_out::{HeldOut, Part, drives};
use super::later::later_parts;
use crate::cause::policy::BESIDE_PART;
use crate::fitting::fitted::Fitted;
use crate::readings::group::{Block, RunGroup};

/// Held-out readings of one channel of one run beside what was predicted of them, in units of the noise, on each scale of time from
/// neighbours to the whole run: how many tell by themselves, and the sum of their squares.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BlockError {
    scales: Vec<(f64, f64)>,
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
        let square = dot(&kept, &kept);
        (square > 0.0 && square.is_finite()).then(|| BlockError { scales: scales(kept) })
    }

    /// Logarithm of the odds of this prediction over another one of the same readings.
    fn log_odds(&self, other: &BlockError) -> f64 {
        let pairs = self.scales.iter().zip(&other.scales);
        let size = |(many, square): &(f64, f64)| (square / many).max(1.0);
        pairs
            .map(|(own, other)| 0.5 * own.0 * (size(other) / size(own)).ln())
            .sum()
    }
}

/// How many coefficients there are on each scale of time, and the sum of their squares: differences of neighbours, of sums of
/// neighbours, and so on, and the sum of all (Haar's wavelets, so that noise of one size has that size on every scale).
fn scales(mut values: Vec<f64>) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    while values.len() > 1 {
        let apart = values
            .chunks_exact(2)
            .map(|pair| 0.5 * (pair[0] - pair[1]).powi(2));
        found.push(((values.len() / 2) as f64, apart.sum()));
        // One without a neighbour stands for itself.
        let together = |pair: &[f64]| pair.iter().sum::<f64>() / (pair.len() as f64).sqrt();
        values = values.chunks(2).map(together).collect();
    }
    found.extend(values.first().map(|whole| (1.0, whole * whole)));
    found
}

/// Logarithm of the odds that what was held out is predicted better.
fn log_odds(before: &[Part], after: &[Part]) -> f64 {
    let of_part = |(before, after): (&Part, &Part)| {
        let pairs = before.errors.iter().zip(&after.errors);
        pairs.map(|(before, after)| after.log_odds(before)).sum::<f64>()
    };
    before.iter().zip(after).map(of_part).sum()
}

impl HeldOut {
    /// Logarithm of the odds of a law of that variable: on the drives that others lie on both sides of, or, where there are none,
    /// on the later part of every run. Beyond what the others measured no law is known, and none is judged there.
    pub(crate) fn log_odds(
        &self,
        group: &RunGroup,
        variable: Option<&str>,
        before: &Fitted,
        after: &Fitted,
    ) -> f64 {
        if group.runs.len() < 2 {
            return log_odds(&self.before, &self.after);
        }
        self.log_odds_between(group, variable)
            .unwrap_or_else(|| log_odds(&later_parts(before, group), &later_parts(after, group)))
    }

    /// The same on the drives alone that others lie on both sides of; none where there are none.
    pub(crate) fn log_odds_between(&self, group: &RunGroup, variable: Option<&str>) -> Option<f64> {
        let between = between(group, variable);
        let kept = |parts: &[Part]| -> Vec<Part> {
            let each = parts.iter().zip(&between);
            each.filter(|(_, is_between)| **is_between)
                .map(|(part, _)| part.clone())
                .collect()
        };
        let is_any = between.contains(&true);
        is_any.then(|| log_odds(&kept(&self.before), &kept(&self.after)))
    }
}

/// Of every drive that is held out, whether others lie beyond it in the variable: in time by their length, in all else by their
/// voltage, and of a law of the voltage on its other side too.
fn between(group: &RunGroup, variable: Option<&str>) -> Vec<bool> {
    let reach = |run: usize| match variable {
        Some("time_s" | "time_since_edge_s" | "time_constant_s") => group.runs[run].duration_s,
        _ => group.runs[run].drive().largest_v().abs(),
    };
    let of_drive = |out: &Vec<usize>| {
        let own = out.iter().map(|&run| reach(run)).fold(0.0, f64::max);
        let mut others = (0..group.runs.len()).filter(|run| !out.contains(run)).map(reach);
        let is_below = others.clone().any(|other| own <= (1.0 + BESIDE_PART) * other);
        is_below && (variable != Some("voltage_v") || others.any(|other| own >= (1.0 - BESIDE_PART) * other))
    };
    drives(group).iter().map(of_drive).collect()
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
}
