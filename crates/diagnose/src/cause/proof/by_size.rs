//! Whether a law predicts what it has not seen better, by the size of the error and beyond its doubt.
//!
//! No model is exact, and how large its error is, is not known before: of readings that were held out, the error of each channel
//! of each run has a size of its own. The odds of two predictions are then the ratio of their mean squares, to the power of half
//! the readings that tell by themselves; an error that goes on for long is few of these. Where the noise is all that is left, these
//! are the odds of the likelihood.

use ieap_numerics::sums::dot;

use super::held_out::{HeldOut, Part, drives};
use super::later::later_parts;
use crate::cause::policy::BESIDE_PART;
use crate::fitting::fitted::Fitted;
use crate::readings::group::{Block, RunGroup};

/// Held-out readings of one channel of one run beside what was predicted of them, in units of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BlockError {
    square: f64,
    readings: f64,
    /// Readings whose errors go together.
    together: f64,
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
        (square > 0.0 && square.is_finite()).then(|| BlockError {
            square,
            readings: kept.len() as f64,
            together: together(&kept),
        })
    }

    /// Logarithm of the odds of this prediction over another one of the same readings.
    fn log_odds(&self, other: &BlockError) -> f64 {
        let independent = self.readings / self.together.max(other.together);
        0.5 * independent * (other.square / self.square).ln()
    }
}

/// How many neighbours err together, about a mean of none: the largest growth of the mean square of sums over that of as many
/// independent errors.
fn together(left: &[f64]) -> f64 {
    let square = dot(left, left);
    let mut sums = left.to_vec();
    let mut most: f64 = 1.0;
    while sums.len() > 1 {
        sums = sums.chunks(2).map(|pair| pair.iter().sum()).collect();
        most = most.max(dot(&sums, &sums) / square);
    }
    most
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
        let between = between(group, variable);
        if !between.contains(&true) {
            return log_odds(&later_parts(before, group), &later_parts(after, group));
        }
        let kept = |parts: &[Part]| -> Vec<Part> {
            let each = parts.iter().zip(&between);
            each.filter(|(_, is_between)| **is_between)
                .map(|(part, _)| part.clone())
                .collect()
        };
        log_odds(&kept(&self.before), &kept(&self.after))
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
    use super::*;

    fn error(square: f64, together: f64) -> BlockError {
        BlockError {
            square,
            readings: 600.0,
            together,
        }
    }

    /// In noise alone the odds are those of the likelihood; of an error that goes on for the whole run one reading tells.
    #[test]
    fn a_gain_counts_by_the_readings_that_tell_by_themselves() {
        let in_noise = error(600.0, 1.0).log_odds(&error(616.0, 1.0));
        assert!((in_noise - 8.0).abs() < 0.2, "{in_noise}");
        let slow = error(600.0, 1.0).log_odds(&error(60_000.0, 600.0));
        assert!((slow - 0.5 * 100.0_f64.ln()).abs() < 1e-9, "{slow}");
        assert!(error(616.0, 1.0).log_odds(&error(600.0, 1.0)) < 0.0);
    }

    #[test]
    fn what_errs_together_is_counted_once() {
        assert!((together(&[2.0; 64]) - 64.0).abs() < 1e-9);
        let changing: Vec<f64> = (0..64).map(|k| f64::from(1 - 2 * (k % 2))).collect();
        assert!((together(&changing) - 1.0).abs() < 1e-9);
    }
}
