//! Readings of one channel, sorted by drive segment and cut into blocks for fast evaluation.

use crate::domain::{Channel, Drive, Level};
use crate::numerics::correlation::Autoregression;
use crate::numerics::decay::{BLOCK, Block, Column, blocks};

/// Consecutive readings within one segment of the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    /// Segment of the drive; none before the first one.
    pub(super) segment: Option<usize>,
    /// Index of the first reading.
    pub(super) first: usize,
    /// Index behind the last reading.
    pub(super) end: usize,
}

/// Readings that a fit uses.
#[derive(Debug, Clone)]
pub(super) struct Sampled {
    /// Time of each reading, s; of a group its mean.
    pub(super) time_s: Vec<f64>,
    /// Time since the start of the reading's segment, s.
    pub(super) elapsed_s: Vec<f64>,
    /// Measured values.
    pub(super) values: Vec<f64>,
    /// Square root of the number of readings behind each value, where they are groups.
    root_weights: Option<Vec<f64>>,
    /// Readings by segment.
    pub(super) spans: Vec<Span>,
    /// Blocks with their segments.
    pub(super) blocks: Vec<(Option<usize>, Block)>,
}

/// The mean before the step is off zero where it is this many standard errors from zero.
const OFFSET_EVIDENCE: f64 = 4.0;
/// Readings at or beyond this size are none: their squares would not be numbers.
const LARGEST: f64 = 1e100;
/// Width of a group of readings in parts of the time since the start of its segment.
const GROUP_WIDTH: f64 = 0.1;

impl Sampled {
    /// Readings of `channel` that are finite and not excluded; those taken while the circuit was open only
    /// where `with_open_circuit`.
    pub(super) fn new(channel: &Channel, drive: &Drive, with_open_circuit: bool) -> Sampled {
        let mut sampled = Sampled {
            time_s: Vec::with_capacity(channel.len()),
            elapsed_s: Vec::with_capacity(channel.len()),
            values: Vec::with_capacity(channel.len()),
            root_weights: None,
            spans: Vec::new(),
            blocks: Vec::new(),
        };
        let (time_s, values) = channel.included();
        let mut next = 0;
        for segment in std::iter::once(None).chain((0..drive.segments.len()).map(Some)) {
            let until = segment.map_or(0, |index| index + 1);
            let end_s = drive
                .segments
                .get(until)
                .map_or(f64::INFINITY, |segment| segment.start_s);
            let end = next + time_s[next..].partition_point(|&t| t < end_s);
            let open = segment.is_some_and(|index| drive.segments[index].level == Level::OpenCircuit);
            if !open || with_open_circuit {
                let start_s = segment.map_or(0.0, |index| drive.segments[index].start_s);
                sampled.take(segment, start_s, &time_s[next..end], &values[next..end]);
            }
            next = end;
        }
        sampled.cut();
        sampled
    }

    fn take(&mut self, segment: Option<usize>, start_s: f64, time_s: &[f64], values: &[f64]) {
        let first = self.values.len();
        for (&t, &value) in time_s.iter().zip(values) {
            if t.is_finite() && value.abs() < LARGEST {
                self.time_s.push(t);
                self.elapsed_s.push(t - start_s);
                self.values.push(value);
            }
        }
        let end = self.values.len();
        if end > first {
            self.spans.push(Span { segment, first, end });
        }
    }

    fn cut(&mut self) {
        for span in &self.spans {
            let found = blocks(&self.elapsed_s, span.first, span.end);
            self.blocks
                .extend(found.into_iter().map(|block| (span.segment, block)));
        }
    }

    /// Number of readings.
    pub(super) fn len(&self) -> usize {
        self.values.len()
    }

    /// Number of readings from the first segment on.
    pub(super) fn after_step(&self) -> usize {
        self.len() - self.before_step()
    }

    /// Number of readings before the first segment.
    pub(super) fn before_step(&self) -> usize {
        self.spans
            .first()
            .filter(|span| span.segment.is_none())
            .map_or(0, |span| span.end)
    }

    /// Whether the mean before the step differs from zero beyond its own error.
    pub(super) fn rests_off_zero(&self) -> bool {
        let before = &self.values[..self.before_step()];
        if before.len() < 4 {
            return false;
        }
        let count = before.len() as f64;
        let mean = before.iter().sum::<f64>() / count;
        let (mut square, mut product, mut last) = (0.0, 0.0, 0.0);
        for value in before {
            let e = value - mean;
            square += e * e;
            product += e * last;
            last = e;
        }
        let noise = Autoregression::from_sums(square, product, count, 1.0);
        let variance = noise.long_run_variance().max(noise.variance) / count;
        mean.abs() > OFFSET_EVIDENCE * variance.sqrt() && mean != 0.0
    }

    /// Shortest mean spacing of three readings in a row, and longest time since a segment's start, s.
    pub(super) fn time_scales_s(&self) -> (f64, f64) {
        let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
        for span in self.spans.iter().filter(|span| span.segment.is_some()) {
            let elapsed_s = &self.elapsed_s[span.first..span.end];
            let spacings = elapsed_s.windows(3).map(|three| (three[2] - three[0]) / 2.0);
            shortest = spacings.fold(shortest, f64::min);
            longest = longest.max(elapsed_s[elapsed_s.len() - 1]);
        }
        (shortest, longest)
    }

    /// The same readings in groups whose width grows with the time since the segment's start: enough to find
    /// where the minimum lies, not to tell its exact place.
    pub(super) fn grouped(&self) -> Sampled {
        let mut grouped = Sampled {
            time_s: Vec::new(),
            elapsed_s: Vec::new(),
            values: Vec::new(),
            root_weights: None,
            spans: Vec::new(),
            blocks: Vec::new(),
        };
        let mut root_weights = Vec::new();
        for span in &self.spans {
            let first = grouped.len();
            let mut start = span.first;
            while start < span.end {
                let limit = match span.segment {
                    Some(_) => self.elapsed_s[start] * (1.0 + GROUP_WIDTH),
                    None => f64::INFINITY,
                };
                let beyond = self.elapsed_s[start..span.end].iter().position(|&t| t > limit);
                let end = beyond.map_or(span.end, |count| start + count.max(1));
                let count = (end - start) as f64;
                let mean = |column: &[f64]| column[start..end].iter().sum::<f64>() / count;
                grouped.time_s.push(mean(&self.time_s));
                grouped.elapsed_s.push(mean(&self.elapsed_s));
                grouped.values.push(mean(&self.values));
                root_weights.push(count.sqrt());
                start = end;
            }
            grouped.spans.push(Span {
                segment: span.segment,
                first,
                end: grouped.len(),
            });
        }
        grouped.root_weights = Some(root_weights);
        grouped.cut();
        grouped
    }

    /// At most about `most` readings: of every longer span its beginning and its end, as spans of their own.
    pub(super) fn ends(&self, most: usize) -> Sampled {
        let mut kept = Sampled {
            time_s: Vec::new(),
            elapsed_s: Vec::new(),
            values: Vec::new(),
            root_weights: None,
            spans: Vec::new(),
            blocks: Vec::new(),
        };
        for span in &self.spans {
            let half = ((span.end - span.first) * most / self.len().max(1) / 2).max(32);
            let parts = if span.end - span.first <= 2 * half {
                vec![(span.first, span.end)]
            } else {
                vec![(span.first, span.first + half), (span.end - half, span.end)]
            };
            for (from, to) in parts {
                let first = kept.len();
                kept.time_s.extend_from_slice(&self.time_s[from..to]);
                kept.elapsed_s.extend_from_slice(&self.elapsed_s[from..to]);
                kept.values.extend_from_slice(&self.values[from..to]);
                kept.spans.push(Span {
                    segment: span.segment,
                    first,
                    end: kept.len(),
                });
            }
        }
        kept.cut();
        kept
    }

    /// Measured values of a block, weighted like the columns.
    pub(super) fn fill_values(&self, block: &Block, out: &mut Column) {
        out[..block.len].copy_from_slice(&self.values[block.first..block.first + block.len]);
        out[block.len..].fill(0.0);
        self.weigh(block, out);
    }

    /// Multiplies a column by the square roots of the weights.
    pub(super) fn weigh(&self, block: &Block, column: &mut Column) {
        if let Some(root_weights) = &self.root_weights {
            for (value, weight) in column
                .iter_mut()
                .zip(&root_weights[block.first..block.first + block.len])
            {
                *value *= weight;
            }
        }
    }

    /// Sum of the squared values, each as often as it stands for readings.
    pub(super) fn weighted_square(&self) -> f64 {
        match &self.root_weights {
            None => self.values.iter().map(|v| v * v).sum(),
            Some(weights) => self
                .values
                .iter()
                .zip(weights)
                .map(|(v, w)| (v * w).powi(2))
                .sum(),
        }
    }

    /// 1 at every reading of the block.
    pub(super) fn ones(block: &Block) -> Column {
        std::array::from_fn(|k| if k < block.len { 1.0 } else { 0.0 })
    }

    /// Stretches without a jump, from the first segment on; those before it where there are few later ones.
    pub(super) fn smooth_stretches(&self) -> Vec<&[f64]> {
        let later = self.after_step() >= BLOCK.min(self.before_step());
        (self.spans.iter())
            .filter(|span| span.segment.is_some() == later)
            .map(|span| &self.values[span.first..span.end])
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Quantity, Segment};

    fn channel(n: usize) -> Channel {
        let time_s = (0..n).map(|k| k as f64 - 10.0).collect();
        let values = (0..n)
            .map(|k| if k == 20 { f64::NAN } else { k as f64 })
            .collect();
        let mut channel = Channel::new(Quantity::Current, time_s, values);
        channel.excluded = [15].into();
        channel
    }

    #[test]
    fn readings_fall_into_their_segments() {
        let mut drive = Drive::step(1.0);
        drive.segments.push(Segment {
            start_s: 40.0,
            level: Level::OpenCircuit,
        });
        let closed = Sampled::new(&channel(100), &drive, false);
        assert_eq!((closed.before_step(), closed.after_step()), (10, 38));
        assert_eq!(closed.spans[1].segment, Some(0));
        let all = Sampled::new(&channel(100), &drive, true);
        assert_eq!(all.len(), 98);
        assert_eq!(all.elapsed_s[all.spans[2].first], 0.0);
        assert_eq!(all.blocks.iter().map(|(_, block)| block.len).sum::<usize>(), 98);
    }

    #[test]
    fn groups_keep_the_sum_of_the_readings() {
        let sampled = Sampled::new(&channel(1000), &Drive::step(1.0), false);
        let grouped = sampled.grouped();
        assert!(grouped.len() < 150, "{}", grouped.len());
        let weights = grouped.root_weights.as_ref().unwrap();
        let sum: f64 = grouped.values.iter().zip(weights).map(|(v, w)| v * w * w).sum();
        assert!((sum / sampled.values.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
