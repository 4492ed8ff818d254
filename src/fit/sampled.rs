//! Readings of one channel, sorted by drive segment and cut into blocks for fast evaluation.

use crate::domain::{Channel, Drive, Level};
use crate::numerics::correlation::Autoregression;
use crate::numerics::decay::{BLOCK, Block, Column, blocks, even_step};
use crate::numerics::discrete_gauss::{FEWEST, compress};

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
    /// Time of each reading, s.
    pub(super) time_s: Vec<f64>,
    /// Time since the start of the reading's segment, s.
    pub(super) elapsed_s: Vec<f64>,
    /// Measured values.
    pub(super) values: Vec<f64>,
    /// Square root of the number of readings behind each value, where they are compressed.
    root_weights: Option<Vec<f64>>,
    /// Sum of the squared values of all readings, also where they are compressed.
    pub(super) square: f64,
    /// Readings by segment.
    pub(super) spans: Vec<Span>,
    /// Blocks with their segments.
    pub(super) blocks: Vec<(Option<usize>, Block)>,
}

/// The mean before the step is off zero where it is this many standard errors from zero.
const OFFSET_EVIDENCE: f64 = 4.0;
/// Readings at or beyond this size are none: their squares would not be numbers.
const LARGEST: f64 = 1e100;
/// A stretch that is compressed at once ends at this multiple of the elapsed time at which it begins.
const STRETCH: f64 = 2.0;

/// Times, values and weights.
type Standing = (Vec<f64>, Vec<f64>, Vec<f64>);

impl Sampled {
    /// Readings of `channel` that are finite and not excluded; those taken while the circuit was open only
    /// where `with_open_circuit`.
    pub(super) fn new(channel: &Channel, drive: &Drive, with_open_circuit: bool) -> Sampled {
        let mut sampled = Sampled {
            time_s: Vec::with_capacity(channel.len()),
            elapsed_s: Vec::with_capacity(channel.len()),
            values: Vec::with_capacity(channel.len()),
            root_weights: None,
            square: 0.0,
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
        sampled.square = sampled.values.iter().map(|v| v * v).sum();
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

    /// A few nodes that stand for all readings: inner products with every response of the circuit and of the strip
    /// stay what they are (see `discrete_gauss`). Readings that are too few or too uneven stay themselves.
    pub(super) fn compressed(&self) -> Sampled {
        let mut compressed = Sampled {
            time_s: Vec::new(),
            elapsed_s: Vec::new(),
            values: Vec::new(),
            root_weights: None,
            square: self.square,
            spans: Vec::with_capacity(self.spans.len()),
            blocks: Vec::new(),
        };
        let mut root_weights = Vec::new();
        for span in &self.spans {
            let first = compressed.len();
            let mut start = span.first;
            while start < span.end {
                let end = self.stretch_end(span, start);
                match self.stands_for(span, start, end) {
                    Some((at, values, weights)) => {
                        compressed.elapsed_s.extend(at);
                        compressed.values.extend(values);
                        root_weights.extend(weights.into_iter().map(f64::sqrt));
                    }
                    None => {
                        compressed.elapsed_s.extend(&self.elapsed_s[start..end]);
                        compressed.values.extend(&self.values[start..end]);
                        root_weights.resize(compressed.values.len(), 1.0);
                    }
                }
                start = end;
            }
            let start_s = self.time_s[span.first] - self.elapsed_s[span.first];
            let elapsed_s = &compressed.elapsed_s[first..];
            compressed.time_s.extend(elapsed_s.iter().map(|t| start_s + t));
            compressed.spans.push(Span {
                segment: span.segment,
                first,
                end: compressed.len(),
            });
        }
        compressed.root_weights = Some(root_weights);
        compressed.cut();
        compressed
    }

    /// End of the stretch from `start` on over which a response is smooth: to twice the elapsed time. Before the
    /// first segment nothing changes.
    fn stretch_end(&self, span: &Span, start: usize) -> usize {
        if span.segment.is_none() {
            return span.end;
        }
        let limit = self.elapsed_s[start] * STRETCH;
        start
            + self.elapsed_s[start..span.end]
                .partition_point(|&t| t <= limit)
                .max(1)
    }

    /// Times, values and weights that stand for the readings `start..end`.
    fn stands_for(&self, span: &Span, start: usize, end: usize) -> Option<Standing> {
        if span.segment.is_none() {
            let count = (end - start) as f64;
            let mean = self.values[start..end].iter().sum::<f64>() / count;
            return Some((vec![self.elapsed_s[start]], vec![mean], vec![count]));
        }
        if end - start < FEWEST {
            return None;
        }
        let elapsed_s = &self.elapsed_s[start..end];
        let found = compress(elapsed_s, &self.values[start..end], even_step(elapsed_s))?;
        Some((found.at.to_vec(), found.values.to_vec(), found.weights.to_vec()))
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
    use std::sync::Arc;

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
    fn compressed_readings_keep_inner_products_with_every_decay() {
        for (n, most) in [(1000, 120), (36_000, 190)] {
            let time_s: Arc<[f64]> = (0..n).map(|k| k as f64 * 0.1 - 10.0).collect();
            let values: Arc<[f64]> = (0..n).map(|k| 1.0 + ((k * k) as f64).sin()).collect();
            let channel = Channel::new(Quantity::Current, time_s, values);
            let sampled = Sampled::new(&channel, &Drive::step(1.0), false);
            let compressed = sampled.compressed();
            assert!(compressed.len() < most, "{}", compressed.len());
            assert_eq!((compressed.before_step(), compressed.square), (1, sampled.square));
            let weights = compressed.root_weights.as_ref().unwrap();
            let after = sampled.before_step();
            let norm = sampled.square.sqrt() * (n as f64).sqrt();
            for power in -40..30 {
                let rate = 10.0_f64.powf(power as f64 / 10.0);
                let all = sampled.elapsed_s[after..].iter().zip(&sampled.values[after..]);
                let direct: f64 = all.map(|(t, y)| y * (-rate * t).exp()).sum();
                let nodes = (1..compressed.len()).map(|k| (k, weights[k] * weights[k]));
                let short: f64 = nodes
                    .map(|(k, w)| w * compressed.values[k] * (-rate * compressed.elapsed_s[k]).exp())
                    .sum();
                assert!((short - direct).abs() < 1e-9 * norm, "{rate}: {short} {direct}");
            }
        }
    }
}
