//! Few places that stand for all whitened readings of a span, where these follow each other evenly and their noise is of one
//! size and one memory.
//!
//! Made white, e^(-rate t) is then itself times a number, but for the first readings, which have no whole past. So every
//! column is known at the nodes of a Gauss rule for each stretch without going through the readings.

use ieap_numerics::decay::even_step;
use ieap_numerics::discrete_gauss::compress;

use crate::sampled::Span;

use super::policy::{GONE_AT, STRETCH};
use super::whitening::{Steady, Whitener};

/// Places of a span's readings.
pub(super) struct Nodes {
    /// Times of the readings whose noise has no whole past, since the first of them, s: they stand for themselves.
    beginning_s: Vec<f64>,
    step_s: f64,
    steady: Steady,
    /// Times since the first reading, s, and the root of the number of readings that each stands for.
    at: Vec<(f64, f64)>,
}

impl Nodes {
    /// The nodes of readings at these times since the first of them, and what the whitened `values` are there; none where the
    /// readings are uneven, or their noise is.
    pub(super) fn of(
        elapsed_s: &[f64],
        span: &Span,
        whitener: &Whitener,
        values: &[f64],
    ) -> Option<(Nodes, Vec<f64>)> {
        let step_s = even_step(elapsed_s)?;
        let steady = whitener.steady(span)?;
        let beginning = steady.coefficients.len();
        let mut nodes = Nodes {
            beginning_s: elapsed_s[..beginning].to_vec(),
            step_s,
            steady,
            at: Vec::new(),
        };
        let mut target = values[..beginning].to_vec();
        let mut start = beginning;
        while start < elapsed_s.len() {
            let later = &elapsed_s[start..];
            let end = start + later.partition_point(|&t| t <= STRETCH * later[0]).max(1);
            nodes.stretch(&elapsed_s[start..end], &values[start..end], &mut target);
            start = end;
        }
        Some((nodes, target))
    }

    /// Adds the readings of a stretch: by nodes, or themselves where they are few.
    fn stretch(&mut self, elapsed_s: &[f64], values: &[f64], target: &mut Vec<f64>) {
        match compress(elapsed_s, values, Some(self.step_s)) {
            Some(found) => {
                for ((at_s, weight), value) in found.at.iter().zip(found.weights).zip(found.values) {
                    let root = weight.sqrt();
                    self.at.push((*at_s, root));
                    target.push(root * value);
                }
            }
            None => {
                self.at.extend(elapsed_s.iter().map(|at_s| (*at_s, 1.0)));
                target.extend(values);
            }
        }
    }

    /// e^(-rate t) made white, at the nodes.
    pub(super) fn column(&self, rate_per_s: f64, span: &Span, whitener: &Whitener) -> Vec<f64> {
        let exponential = |at_s: &f64| (-rate_per_s * at_s).exp();
        let mut column: Vec<f64> = self.beginning_s.iter().map(exponential).collect();
        whitener.whiten(span, &mut column);
        let gain = self.steady.gain(rate_per_s * self.step_s);
        // What is predicted is as large as the last of the readings it is predicted from.
        let past_s = self.step_s * self.beginning_s.len() as f64;
        let seen = self
            .at
            .partition_point(|(at_s, _)| rate_per_s * (at_s - past_s) < GONE_AT);
        let whitened = self.at[..seen]
            .iter()
            .map(|(at_s, root)| root * gain * exponential(at_s));
        column.extend(whitened);
        column.resize(self.beginning_s.len() + self.at.len(), 0.0);
        column
    }
}
