//! Means of neighbouring readings over which no response bends: a few hundred numbers that tell slow noise as well as all readings do.

use crate::joint::policy::{BIN_WIDTH, BINS_AT_REST};
use crate::sampled::{Sampled, Span};

/// The means of a channel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bins {
    /// The readings of each, within one span.
    parts: Vec<(usize, usize)>,
    /// For every span of the channel its bins.
    pub(super) spans: Vec<(usize, usize)>,
    /// Mean time of each, s.
    pub(crate) time_s: Vec<f64>,
}

impl Bins {
    /// Behind an edge a bin is a part of the time since it, before the first one a part of the record.
    pub(crate) fn of(sampled: &Sampled) -> Bins {
        let mut bins = Bins {
            parts: Vec::new(),
            spans: Vec::with_capacity(sampled.spans.len()),
            time_s: Vec::new(),
        };
        let record_s = sampled.time_s[sampled.len() - 1] - sampled.time_s[0];
        let edges = sampled.spans.iter().filter(|span| span.segment.is_some()).count();
        for span in &sampled.spans {
            let first = bins.parts.len();
            bins.cut(
                sampled,
                span,
                record_s / BINS_AT_REST,
                BIN_WIDTH * edges.max(1) as f64,
            );
            bins.spans.push((first, bins.parts.len()));
        }
        let mean = |&(first, end): &(usize, usize)| {
            sampled.time_s[first..end].iter().sum::<f64>() / (end - first) as f64
        };
        bins.time_s = bins.parts.iter().map(mean).collect();
        bins
    }

    fn cut(&mut self, sampled: &Sampled, span: &Span, at_rest_s: f64, width: f64) {
        let elapsed_s = &sampled.elapsed_s[..span.end];
        let mut first = span.first;
        while first < span.end {
            let until_s = match span.segment {
                None => elapsed_s[first] + at_rest_s,
                Some(_) => elapsed_s[first] + width * elapsed_s[first].max(0.0),
            };
            let end = first + elapsed_s[first..].partition_point(|&t| t <= until_s).max(1);
            self.parts.push((first, end));
            first = end;
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.parts.len()
    }

    pub(super) fn parts(&self) -> &[(usize, usize)] {
        &self.parts
    }

    /// Means of a series over the readings.
    pub(crate) fn means(&self, series: &[f64]) -> Vec<f64> {
        let mean =
            |&(first, end): &(usize, usize)| series[first..end].iter().sum::<f64>() / (end - first) as f64;
        self.parts.iter().map(mean).collect()
    }
}
