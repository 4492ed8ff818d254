//! Means of neighbouring readings in the place of a long record, and where a model is asked for the very same means.
//!
//! A mean is compared with the mean of the model over the same readings, so that nothing is condemned for being averaged;
//! what is lost is what happens within a mean. Behind every edge of the drive means begin with single readings and grow.

use std::borrow::Cow;
use std::sync::Arc;

use super::sampled::{Sampled, Span};

/// A mean reaches over at most this part of the readings since the edge; the next ones where edges are so many that their
/// beginnings would be most of what is left.
const GROWTHS: [f64; 4] = [0.1, 0.3, 1.0, f64::INFINITY];
/// Part of the time since the edge over which two nodes stand for a mean: they are exact for cubics, and off by 1e-6 of any
/// exponential that the edge began.
const BY_TWO_NODES: f64 = 0.25;

/// How means are made, and where a model is asked for them.
#[derive(Debug, Clone, Default)]
pub(super) struct Means {
    /// Times at which the model is asked, s; with the weight of each in its mean.
    nodes_s: Arc<[f64]>,
    weights: Vec<f64>,
    /// For every mean where its nodes end.
    ends: Vec<usize>,
}

impl Means {
    /// The readings themselves where they are `most` or fewer, else some `most` means; none of those of a moving voltage, each
    /// of which has a level of its own.
    pub(super) fn of(sampled: Sampled, most: usize) -> (Sampled, Option<Means>) {
        let together = sampled.len().div_ceil(most.max(1));
        if together <= 1 || sampled.moves || sampled.course.is_some() {
            return (sampled, None);
        }
        let spans = sampled.spans.len() as f64;
        let extra = |growth: f64| spans * (1.0 + (together as f64).ln()) / growth;
        let few = GROWTHS
            .into_iter()
            .find(|&growth| extra(growth) <= 0.5 * most as f64);
        let growth = few.unwrap_or(f64::INFINITY);
        let mut parts: Vec<Span> = Vec::new();
        for span in &sampled.spans {
            let growth = if span.segment.is_some() {
                growth
            } else {
                f64::INFINITY
            };
            parts.extend(cut(span, together, growth));
        }
        let mut means = Means::default();
        let mut nodes_s = Vec::new();
        for part in &parts {
            means.add_nodes(&sampled, part, &mut nodes_s);
            means.ends.push(nodes_s.len());
        }
        means.nodes_s = nodes_s.into();
        (sampled.averaged(&parts), Some(means))
    }

    fn add_nodes(&mut self, sampled: &Sampled, part: &Span, nodes_s: &mut Vec<f64>) {
        let times = &sampled.time_s[part.first..part.end];
        let count = times.len() as f64;
        let reach_s = times[times.len() - 1] - times[0];
        let is_constant = part.segment.is_none();
        if times.len() <= 2 || !is_constant && reach_s > BY_TWO_NODES * sampled.elapsed_s[part.first] {
            nodes_s.extend(times);
            self.weights.resize(nodes_s.len(), count.recip());
            return;
        }
        // The Gauss rule of two nodes over these readings.
        let middle_s = times.iter().sum::<f64>() / count;
        let moment = |power: i32| times.iter().map(|t| (t - middle_s).powi(power)).sum::<f64>() / count;
        let (square, lean) = (moment(2), moment(3));
        let half = 0.5 * lean / square;
        let root = (half * half + square).sqrt();
        let [low, high] = [half - root, half + root];
        nodes_s.extend([middle_s + low, middle_s + high]);
        self.weights.extend([high / (high - low), -low / (high - low)]);
    }

    /// Times at which a model is asked, s.
    pub(super) fn nodes_s(&self) -> &[f64] {
        &self.nodes_s
    }

    /// The means of a model's values at the nodes.
    pub(super) fn over(&self, at_nodes: &[f64]) -> Vec<f64> {
        let mut first = 0;
        let mean = |&end: &usize| {
            let nodes = first..end;
            first = end;
            let pairs = at_nodes[nodes.clone()].iter().zip(&self.weights[nodes]);
            pairs.map(|(value, weight)| value * weight).sum()
        };
        self.ends.iter().map(mean).collect()
    }

    /// Without the means for which `keep` does not hold.
    pub(super) fn kept(&self, keep: impl Fn(usize) -> bool) -> Means {
        let mut kept = Means::default();
        let mut nodes_s = Vec::new();
        for (k, &end) in self.ends.iter().enumerate().filter(|(k, _)| keep(*k)) {
            let first = k.checked_sub(1).map_or(0, |before| self.ends[before]);
            nodes_s.extend(&self.nodes_s[first..end]);
            kept.weights.extend(&self.weights[first..end]);
            kept.ends.push(nodes_s.len());
        }
        kept.nodes_s = nodes_s.into();
        kept
    }
}

/// What a model gives for readings that may be means of others.
pub(super) fn over<'v>(means: Option<&Means>, at_nodes: &'v [f64]) -> Cow<'v, [f64]> {
    means.map_or(Cow::Borrowed(at_nodes), |means| Cow::Owned(means.over(at_nodes)))
}

/// Cuts a span into parts of `together` readings at most (half as many again for a last one), which reach over at most
/// `growth` of the readings since the edge.
fn cut(span: &Span, together: usize, growth: f64) -> Vec<Span> {
    let mut parts = Vec::new();
    let mut first = span.first;
    while first < span.end {
        let since = (first - span.first) as f64;
        let size = ((growth * since).max(1.0).min(together as f64)) as usize;
        let size = if growth.is_infinite() { together } else { size };
        let mut end = first + size;
        if span.end < end + size.div_ceil(2) {
            end = span.end;
        }
        parts.push(Span { first, end, ..*span });
        first = end;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::{Channel, Drive, Level, Quantity, Segment};

    fn sampled(count: usize, step_s: f64, drive: &Drive, value: impl Fn(f64) -> f64) -> Sampled {
        let time_s: Arc<[f64]> = (0..count).map(|k| step_s * (k as f64 - 50.3)).collect();
        let values = time_s.iter().map(|&t| value(t)).collect();
        Sampled::new(&Channel::new(Quantity::Current, time_s, values), drive, false)
    }

    #[test]
    fn a_mean_of_readings_is_that_of_the_model_over_the_same_readings() {
        for (count, step_s, edges) in [(36_000, 0.1, 1), (3_600, 1.0, 2), (36_000, 0.1, 900)] {
            let lasting_s = count as f64 * step_s;
            let segment = |k: usize| {
                Segment::at(
                    lasting_s * k as f64 / edges as f64,
                    Level::Voltage((k % 2) as f64),
                )
            };
            let drive = Drive {
                baseline_v: 0.0,
                segments: (0..edges).map(segment).collect(),
            };
            let since = |t: f64| {
                t - drive
                    .segments
                    .iter()
                    .rev()
                    .find(|s| s.start_s() <= t)
                    .map_or(t, |s| s.start_s())
            };
            let value = |t: f64| match since(t) {
                _ if t < 0.0 => 0.25,
                s => (-s / 3.7).exp() + 0.3 * (-s / 88.0).exp(),
            };
            let (rows, means) = Means::of(sampled(count, step_s, &drive, value), 1500);
            let means = means.unwrap();
            let model: Vec<f64> = means.nodes_s().iter().map(|&t| value(t)).collect();
            let of_model = means.over(&model);
            let pairs = of_model.iter().zip(rows.values.iter());
            let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-6, "{count} {edges}: {worst:e}");
            assert!(rows.len() < 4000, "{count} {edges}: {}", rows.len());
        }
    }

    #[test]
    fn no_reading_is_lost_and_the_first_behind_an_edge_stand_alone() {
        let drive = Drive::step(1.0);
        let long = sampled(10_000, 0.1, &drive, |t| t);
        let sum = long.values.iter().sum::<f64>();
        let (rows, means) = Means::of(long, 1000);
        let of_rows: f64 = rows
            .values
            .iter()
            .zip(&rows.counts())
            .map(|(mean, count)| mean * count)
            .sum();
        assert!((of_rows - sum).abs() < 1e-6 * sum.abs());
        assert_eq!(rows.counts()[rows.before_step()..][..10], [1.0; 10]);
        let fewer = means.unwrap().kept(|k| k != 3);
        assert_eq!(fewer.ends.len() + 1, rows.len());
    }

    #[test]
    fn a_short_record_stays_as_it_is() {
        let (rows, means) = Means::of(sampled(600, 1.0, &Drive::step(1.0), |t| t), 1500);
        assert!(means.is_none() && rows.len() == 600);
    }
}
