//! Few places that stand for the readings of a span where these follow each other evenly: inner products with what is smooth
//! stay what they are.
//!
//! Where noise is of one size and memory, e^(-rate t) made white is itself times a number, but for the first readings, which
//! have no whole past. So a column is known at the nodes of a Gauss rule for each stretch without going through the readings.

use ieap_numerics::decay::even_step;
use ieap_numerics::discrete_gauss::compress;

use crate::sampled::Span;

use super::policy::{GONE_AT, STRETCH};
use super::whitening::{Steady, Whitener};

/// Places of a span's readings.
#[derive(Debug)]
pub(super) struct Nodes {
    /// Times since the first reading, s, of those at the beginning, which stand for themselves.
    beginning_s: Vec<f64>,
    step_s: f64,
    /// Times since the first reading, s, and the root of the number of readings that each stands for.
    at: Vec<(f64, f64)>,
}

impl Nodes {
    /// The nodes of readings at these times since the first of them, of which so many stand for themselves, and what the
    /// `values` are there; none where the readings are uneven.
    pub(super) fn of(elapsed_s: &[f64], beginning: usize, values: &[f64]) -> Option<(Nodes, Vec<f64>)> {
        let step_s = match elapsed_s {
            [] | [_] => 0.0,
            [first, second] => second - first,
            more => even_step(more)?,
        };
        let beginning = beginning.min(elapsed_s.len());
        let mut nodes = Nodes {
            beginning_s: elapsed_s[..beginning].to_vec(),
            step_s,
            at: Vec::new(),
        };
        let mut short = values[..beginning].to_vec();
        let mut start = beginning;
        while start < elapsed_s.len() {
            let later = &elapsed_s[start..];
            let end = start + later.partition_point(|&t| t <= STRETCH * later[0]).max(1);
            nodes.stretch(&elapsed_s[start..end], &values[start..end], &mut short);
            start = end;
        }
        Some((nodes, short))
    }

    /// Adds the readings of a stretch: by nodes, or themselves where they are few.
    fn stretch(&mut self, elapsed_s: &[f64], values: &[f64], short: &mut Vec<f64>) {
        match compress(elapsed_s, values, Some(self.step_s)) {
            Some(found) => {
                for ((at_s, weight), value) in found.at.iter().zip(found.weights).zip(found.values) {
                    let root = weight.sqrt();
                    self.at.push((*at_s, root));
                    short.push(root * value);
                }
            }
            None => {
                self.at.extend(elapsed_s.iter().map(|at_s| (*at_s, 1.0)));
                short.extend(values);
            }
        }
    }

    /// e^(-rate t) at the nodes, made white by a rule that is `steady` behind the beginning.
    pub(super) fn white_column(
        &self,
        rate_per_s: f64,
        span: &Span,
        whitener: &Whitener,
        steady: &Steady,
    ) -> Vec<f64> {
        let mut beginning = self.at_beginning(rate_per_s);
        whitener.whiten(span, &mut beginning);
        self.column(rate_per_s, beginning, steady.gain(rate_per_s * self.step_s))
    }

    /// e^(-rate t) at the nodes so many readings before; at the beginning nothing is read before the first.
    pub(super) fn column_before(&self, rate_per_s: f64, readings: usize) -> Vec<f64> {
        let mut beginning = self.at_beginning(rate_per_s);
        beginning.rotate_right(readings);
        beginning[..readings].fill(0.0);
        let gain = (rate_per_s * self.step_s * readings as f64).exp();
        self.column(rate_per_s, beginning, gain)
    }

    fn at_beginning(&self, rate_per_s: f64) -> Vec<f64> {
        self.beginning_s
            .iter()
            .map(|at_s| (-rate_per_s * at_s).exp())
            .collect()
    }

    /// A column that begins so, and goes on with `gain` times the exponential.
    fn column(&self, rate_per_s: f64, mut column: Vec<f64>, gain: f64) -> Vec<f64> {
        // What it is made of is as large as the exponential at the last reading of the beginning.
        let past_s = self.step_s * self.beginning_s.len() as f64;
        let seen = self
            .at
            .partition_point(|(at_s, _)| rate_per_s * (at_s - past_s) < GONE_AT);
        let later = self.at[..seen].iter();
        column.extend(later.map(|(at_s, root)| root * gain * (-rate_per_s * at_s).exp()));
        column.resize(self.beginning_s.len() + self.at.len(), 0.0);
        column
    }
}
