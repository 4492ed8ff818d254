//! Readings of one channel, sorted by drive segment and cut into blocks for fast evaluation.

use std::sync::Arc;

use ieap_domain::{Channel, Drive, Level, Segment};
use ieap_numerics::correlation::Autoregression;
use ieap_numerics::decay::{BLOCK, Block, Column, blocks, even_step};
use ieap_numerics::discrete_gauss::{FEWEST, compress};
use ieap_numerics::noise::{LocalScatter, local_scatter};
use ieap_numerics::sums;
use ieap_numerics::waveform;

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
    pub(super) time_s: Arc<[f64]>,
    /// Time since the start of the reading's segment, s.
    pub(super) elapsed_s: Arc<[f64]>,
    /// Measured values.
    pub(super) values: Arc<[f64]>,
    /// Square root of the number of readings behind each value, where they are compressed.
    root_weights: Option<Vec<f64>>,
    /// Sum of the squared values of the readings that these stand for, where they are compressed.
    square_of_all: Option<f64>,
    /// Readings by segment.
    pub(super) spans: Vec<Span>,
    /// Blocks with their segments.
    pub(super) blocks: Vec<(Option<usize>, Block)>,
    /// Noise without the model; none where the readings are too few or compressed.
    pub(super) scatter: Option<LocalScatter>,
    /// Whether the voltage moves all the time: spans then hold many segments, blocks one each.
    pub(super) moves: bool,
    /// The time after which a moving voltage comes back, s.
    pub(super) period_s: Option<f64>,
    /// The drive that moved it, where the readings were joined to the stretches between its edges: what they answer to.
    pub(super) course: Option<Arc<Drive>>,
    /// Whether the zero of the sensor is not known though nothing was read at rest.
    pub(super) zero_is_free: bool,
}

/// The level before the step.
pub(super) struct AtRest {
    /// Mean of the readings.
    pub(super) mean: f64,
    /// Variance of a long sum of their noise per reading.
    pub(super) long_run_variance: f64,
}

/// Readings at or beyond this size are none: their squares would not be numbers.
const LARGEST: f64 = 1e100;
/// A stretch that is compressed at once ends at this multiple of the elapsed time at which it begins.
const STRETCH: f64 = 2.0;

/// Times, values and weights.
type Standing = (Vec<f64>, Vec<f64>, Vec<f64>);

impl Sampled {
    /// Readings of `channel` that are finite and not excluded. Of what jumps with the voltage, as a current does, none that
    /// was taken while the circuit was open, and none at the very instant of an edge that does not show the jump: it is of
    /// the side before, or of neither.
    pub(super) fn new(channel: &Channel, drive: &Drive, is_continuous: bool) -> Sampled {
        let (time_s, values) = channel.included();
        let moves = drive.moves();
        let segments = std::iter::once(None).chain((0..drive.segments.len()).map(Some));
        let mut next = 0;
        let mut taken: Vec<Span> = Vec::with_capacity(drive.segments.len() + 1);
        for segment in segments {
            let until = segment.map_or(0, |index| index + 1);
            let end_s = drive
                .segments
                .get(until)
                .map_or(f64::INFINITY, |segment| segment.start_s());
            let mut first = next;
            next += time_s[next..].partition_point(|&t| t < end_s);
            let open = segment.is_some_and(|index| drive.segments[index].level == Level::OpenCircuit);
            let stated = segment.filter(|&index| drive.segments[index].edge.is_stated());
            if let Some(index) = stated.filter(|_| !is_continuous && !moves) {
                let at_instant = next > first && time_s[first] == drive.segments[index].start_s();
                let is_known_rest = index == 0 && drive.baseline_v == 0.0;
                first += usize::from(at_instant && !has_jumped(&values, first, is_known_rest));
            }
            if next > first && (!open || is_continuous) {
                let end = next;
                taken.push(Span { segment, first, end });
            }
        }
        let start_s = |span: &Span| span.segment.map_or(0.0, |index| drive.segments[index].start_s());
        let whole = taken.iter().map(|span| span.end - span.first).sum::<usize>() == values.len();
        let usable = sums::peak(&values) < LARGEST && values.iter().chain(&*time_s).all(|v| v.is_finite());
        let mut sampled = if whole && usable {
            // Nothing is left out: the channel's own columns serve.
            let elapsed_s = if taken.iter().all(|span| start_s(span) == 0.0) {
                time_s.clone()
            } else {
                let each = taken.iter().flat_map(|span| {
                    let start_s = start_s(span);
                    time_s[span.first..span.end].iter().map(move |t| t - start_s)
                });
                each.collect()
            };
            Sampled::of(time_s, elapsed_s, values, taken)
        } else {
            Sampled::picked(&time_s, &values, &taken, start_s)
        };
        if moves {
            sampled.join(&drive.edges());
            sampled.period_s = period_s(drive);
        }
        sampled.scatter = local_scatter(&sampled.smooth_stretches());
        sampled.zero_is_free = channel.open_zero.as_ref().is_some_and(|zero| zero.is_free);
        sampled
    }

    fn of(time_s: Arc<[f64]>, elapsed_s: Arc<[f64]>, values: Arc<[f64]>, spans: Vec<Span>) -> Sampled {
        let mut sampled = Sampled {
            time_s,
            elapsed_s,
            values,
            root_weights: None,
            square_of_all: None,
            spans,
            blocks: Vec::new(),
            scatter: None,
            moves: false,
            period_s: None,
            course: None,
            zero_is_free: false,
        };
        sampled.cut();
        sampled
    }

    /// Joins the spans of segments that follow each other without an edge; the blocks stay what they are.
    fn join(&mut self, edges: &[usize]) {
        self.moves = true;
        let stretch = |span: &Span| span.segment.map(|at| edges.partition_point(|&edge| edge <= at));
        let mut joined: Vec<Span> = Vec::with_capacity(edges.len() + 1);
        for span in &self.spans {
            match joined.last_mut() {
                Some(last) if stretch(last) == stretch(span) => last.end = span.end,
                _ => joined.push(*span),
            }
        }
        self.spans = joined;
    }

    /// What a fit left of the readings of a moving voltage, as a series of its own in which no voltage moves.
    pub(super) fn rest(&self, residuals: &[f64]) -> Sampled {
        let of_span = |span: &Span| {
            let times = &self.time_s[span.first..span.end];
            times.iter().map(move |t| t - times[0])
        };
        let elapsed_s = self.spans.iter().flat_map(of_span).collect();
        Sampled::of(
            self.time_s.clone(),
            elapsed_s,
            residuals.into(),
            self.spans.clone(),
        )
    }

    /// The same readings with the stretches between the edges of the drive as their segments, where its voltage moves all the
    /// time; a series in which no voltage moves stays what it is.
    pub(super) fn between_edges(self, drive: &Drive) -> Sampled {
        if !self.moves {
            return self;
        }
        Sampled {
            course: Some(Arc::new(drive.clone())),
            scatter: self.scatter.clone(),
            zero_is_free: self.zero_is_free,
            ..self.rest(&self.values)
        }
    }

    /// Whether the readings follow each other evenly, so that noise by reading order is noise by time.
    pub(super) fn is_even(&self) -> bool {
        if self.moves {
            let of_span = |span: &Span| {
                span.end - span.first < 3 || even_step(&self.time_s[span.first..span.end]).is_some()
            };
            return self.spans.iter().all(of_span);
        }
        self.blocks.iter().all(|(_, block)| block.step_s.is_some())
    }

    /// The usable readings of the spans `taken`, copied one after the other.
    fn picked(time_s: &[f64], values: &[f64], taken: &[Span], start_s: impl Fn(&Span) -> f64) -> Sampled {
        let (mut times, mut elapsed, mut kept) = (Vec::new(), Vec::new(), Vec::new());
        let mut spans = Vec::with_capacity(taken.len());
        for span in taken {
            let first = kept.len();
            for (&t, &value) in time_s[span.first..span.end]
                .iter()
                .zip(&values[span.first..span.end])
            {
                if t.is_finite() && value.abs() < LARGEST {
                    times.push(t);
                    elapsed.push(t - start_s(span));
                    kept.push(value);
                }
            }
            let end = kept.len();
            if end > first {
                spans.push(Span { first, end, ..*span });
            }
        }
        Sampled::of(times.into(), elapsed.into(), kept.into(), spans)
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

    /// Sum of the squared values of all readings, also where these are compressed.
    pub(super) fn square(&self) -> f64 {
        self.square_of_all.unwrap_or_else(|| sums::square(&self.values))
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

    /// Whether a zero is fitted: readings before the step tell it, or nothing is known of it.
    pub(super) fn tells_zero(&self) -> bool {
        self.before_step() > 0 || self.zero_is_free
    }

    /// The level before the step and the noise about it, 0 of a single reading; none without one.
    pub(super) fn at_rest(&self) -> Option<AtRest> {
        let before = &self.values[..self.before_step()];
        if before.is_empty() {
            return None;
        }
        let noise = Autoregression::of(&sums::about_mean(before), 1);
        Some(AtRest {
            mean: sums::mean(before),
            long_run_variance: noise.long_run_variance().max(noise.variance),
        })
    }

    /// Shortest mean spacing of three readings in a row, and longest time since a segment's start, s.
    pub(super) fn time_scales_s(&self) -> (f64, f64) {
        let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
        for span in self.spans.iter().filter(|span| span.segment.is_some()) {
            let elapsed_s = if self.moves {
                &self.time_s[span.first..span.end]
            } else {
                &self.elapsed_s[span.first..span.end]
            };
            if let Some(later) = elapsed_s.get(2..) {
                shortest = shortest.min(0.5 * sums::least_difference(later, elapsed_s));
            }
            let since_s = if self.moves { elapsed_s[0] } else { 0.0 };
            longest = longest.max(elapsed_s[elapsed_s.len() - 1] - since_s);
        }
        (shortest, longest)
    }

    /// A few nodes that stand for all readings: inner products with every response of the circuit and of the strip
    /// stay what they are (see `discrete_gauss`). Readings that are too few or too uneven stay themselves, and those of a
    /// moving voltage, each of which has a segment of its own.
    pub(super) fn compressed(&self) -> Sampled {
        if self.moves {
            return self.clone();
        }
        let (mut time_s, mut elapsed_s, mut values) = (Vec::new(), Vec::new(), Vec::new());
        let (mut root_weights, mut spans) = (Vec::new(), Vec::with_capacity(self.spans.len()));
        for span in &self.spans {
            let first = values.len();
            let mut start = span.first;
            while start < span.end {
                let end = self.stretch_end(span, start);
                match self.stands_for(span, start, end) {
                    Some((at, node_values, weights)) => {
                        elapsed_s.extend(at);
                        values.extend(node_values);
                        root_weights.extend(weights.into_iter().map(f64::sqrt));
                    }
                    None => {
                        elapsed_s.extend(&self.elapsed_s[start..end]);
                        values.extend(&self.values[start..end]);
                        root_weights.resize(values.len(), 1.0);
                    }
                }
                start = end;
            }
            let start_s = self.time_s[span.first] - self.elapsed_s[span.first];
            time_s.extend(elapsed_s[first..].iter().map(|t| start_s + t));
            let end = values.len();
            spans.push(Span { first, end, ..*span });
        }
        let mut compressed = Sampled::of(time_s.into(), elapsed_s.into(), values.into(), spans);
        compressed.root_weights = Some(root_weights);
        compressed.square_of_all = Some(self.square());
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
            let mean = sums::sum(&self.values[start..end]) / count;
            return Some((vec![self.elapsed_s[start]], vec![mean], vec![count]));
        }
        if end - start < FEWEST {
            return None;
        }
        let elapsed_s = &self.elapsed_s[start..end];
        let found = compress(elapsed_s, &self.values[start..end], even_step(elapsed_s))?;
        Some((found.at.to_vec(), found.values.to_vec(), found.weights.to_vec()))
    }

    /// The means over `parts`, each within one span, in the place of the readings.
    pub(super) fn averaged(&self, parts: &[Span]) -> Sampled {
        let mean = |series: &[f64], part: &Span| {
            sums::sum(&series[part.first..part.end]) / (part.end - part.first) as f64
        };
        let column = |series: &[f64]| -> Arc<[f64]> { parts.iter().map(|part| mean(series, part)).collect() };
        let mut spans: Vec<Span> = Vec::with_capacity(self.spans.len());
        for (k, part) in parts.iter().enumerate() {
            match spans.last_mut() {
                Some(last) if last.segment == part.segment => last.end = k + 1,
                _ => spans.push(Span {
                    first: k,
                    end: k + 1,
                    ..*part
                }),
            }
        }
        let mut averaged = Sampled::of(
            column(&self.time_s),
            column(&self.elapsed_s),
            column(&self.values),
            spans,
        );
        let root = |part: &Span| ((part.end - part.first) as f64).sqrt();
        averaged.root_weights = Some(parts.iter().map(root).collect());
        averaged.scatter = local_scatter(&averaged.smooth_stretches());
        averaged.zero_is_free = self.zero_is_free;
        averaged
    }

    /// Standard deviation of each value's noise, in that of the value behind which most readings stand.
    pub(super) fn spread(&self) -> Vec<f64> {
        let Some(roots) = &self.root_weights else {
            return vec![1.0; self.len()];
        };
        let most = roots.iter().copied().fold(0.0, f64::max);
        roots.iter().map(|root| most / root).collect()
    }

    /// Number of readings behind each value.
    pub(super) fn counts(&self) -> Vec<f64> {
        match &self.root_weights {
            Some(roots) => roots.iter().map(|root| root * root).collect(),
            None => vec![1.0; self.len()],
        }
    }

    /// The values for which `keep` holds.
    pub(super) fn kept(&self, keep: impl Fn(usize) -> bool) -> Sampled {
        let of_span = |span: &Span| {
            let kept: Vec<usize> = (span.first..span.end).filter(|&k| keep(k)).collect();
            (span.segment, kept)
        };
        self.taken(self.spans.iter().map(of_span))
    }

    /// At most about `most` readings: of every longer span its beginning and its end, as spans of their own.
    pub(super) fn ends(&self, most: usize) -> Sampled {
        let parts = |span: &Span| {
            let half = ((span.end - span.first) * most / self.len().max(1) / 2).max(32);
            if span.end - span.first <= 2 * half {
                vec![(span.first, span.end)]
            } else {
                vec![(span.first, span.first + half), (span.end - half, span.end)]
            }
        };
        self.stretches(parts)
    }

    /// The readings without the first `count` of each span; spans that are not longer fall out.
    pub(super) fn without_edges(&self, count: usize) -> Sampled {
        self.stretches(|span| {
            let from = span.first + count;
            if from < span.end {
                vec![(from, span.end)]
            } else {
                Vec::new()
            }
        })
    }

    /// The readings in the stretches that `parts` takes of every span, each a span of its own.
    fn stretches(&self, parts: impl Fn(&Span) -> Vec<(usize, usize)>) -> Sampled {
        let of_span = |span: &Span| {
            let segment = span.segment;
            parts(span)
                .into_iter()
                .map(move |(from, to)| (segment, (from..to).collect()))
        };
        self.taken(self.spans.iter().flat_map(of_span))
    }

    /// The readings at these places, each list a span.
    fn taken(&self, spans: impl Iterator<Item = (Option<usize>, Vec<usize>)>) -> Sampled {
        let mut places: Vec<usize> = Vec::new();
        let mut taken = Vec::new();
        for (segment, own) in spans.filter(|(_, own)| !own.is_empty()) {
            let first = places.len();
            places.extend(own);
            let end = places.len();
            taken.push(Span { segment, first, end });
        }
        let column = |series: &[f64]| -> Arc<[f64]> { places.iter().map(|&k| series[k]).collect() };
        let mut kept = Sampled {
            time_s: column(&self.time_s),
            elapsed_s: column(&self.elapsed_s),
            values: column(&self.values),
            root_weights: self.root_weights.as_ref().map(|roots| column(roots).to_vec()),
            square_of_all: None,
            spans: taken,
            blocks: Vec::new(),
            scatter: self.scatter.clone(),
            moves: self.moves,
            period_s: self.period_s,
            course: self.course.clone(),
            zero_is_free: self.zero_is_free,
        };
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

    /// Multiplies values at all readings by the square roots of the weights.
    pub(super) fn weigh_all(&self, values: &mut [f64]) {
        if let Some(root_weights) = &self.root_weights {
            values
                .iter_mut()
                .zip(root_weights)
                .for_each(|(value, weight)| *value *= weight);
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

fn period_s(drive: &Drive) -> Option<f64> {
    let levels: Option<Vec<f64>> = drive.levels().map(|(_, volts)| volts).collect();
    let starts_s: Vec<f64> = drive.segments.iter().map(Segment::start_s).collect();
    waveform::period_s(&starts_s, &levels?)
}

/// Whether the jump at an edge lies before the reading `at` that was taken at its very instant, and not behind it: beside the
/// reading before, or beside none where nothing flowed before the record.
fn has_jumped(values: &[f64], at: usize, is_known_rest: bool) -> bool {
    let before = match at.checked_sub(1) {
        Some(before) => values[before],
        None if is_known_rest => 0.0,
        None => return false,
    };
    let after = values.get(at + 1).copied().unwrap_or(values[at]);
    (values[at] - before).abs() > (after - values[at]).abs()
}

/// Sum of squared residuals over what stands for the readings.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Remainder {
    left: f64,
    values: f64,
}

impl Remainder {
    /// Adds a block of weighted values and the fitted value at each.
    pub(super) fn add(&mut self, values: &[f64], fitted: impl Fn(usize) -> f64) {
        for (k, value) in values.iter().enumerate() {
            let residual = value - fitted(k);
            self.left += residual * residual;
            self.values += value * value;
        }
    }

    /// The sum over all readings of `sampled`: what no smooth response reaches is the same for every one.
    pub(super) fn square(&self, sampled: &Sampled) -> f64 {
        self.left + (sampled.square() - self.values).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use ieap_domain::Quantity;

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
        drive.segments.push(Segment::at(40.0, Level::OpenCircuit));
        let closed = Sampled::new(&channel(100), &drive, false);
        // The reading at the very instant of the step shows no jump, and the current is none of one side.
        assert_eq!((closed.before_step(), closed.after_step()), (10, 37));
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
            assert_eq!(
                (compressed.before_step(), compressed.square()),
                (1, sampled.square())
            );
            let weights = compressed.root_weights.as_ref().unwrap();
            let after = sampled.before_step();
            let norm = sampled.square().sqrt() * (n as f64).sqrt();
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
