//! Zeros and drifts of instruments, what the readings at rest allow of them and no more.
//!
//! A current that is read beside its zero, or a laser that drifts, is no misfit of the model. How large either may be is learnt
//! from the readings before the drive alone, of all runs together, never from those that the model is asked about: an error of
//! the model cannot hide in them.

use ieap_fit::WhitenedChannel;
use ieap_numerics::sums::sum;

use crate::readings::group::{GroupRun, QUANTITIES, RunGroup};
use crate::readings::left_open::LeftOpen;
use crate::readings::policy::{FEWEST_AT_REST, MOST_DRIFT_PARTS, REST_BLOCKS};
use ieap_domain::range_of;

/// What the rest of a channel says of a zero and of a drift, each with its variance: in the unit of the channel, the drift over
/// the record.
struct AtRest {
    zero: (f64, f64),
    drift: (f64, f64),
}

impl RunGroup<'_> {
    /// Finds anew how zeros and drifts change the whitened rows, beside a model that gives these values.
    pub(super) fn open_zeros_beside(&mut self, fitted: &[[Vec<f64>; 2]]) {
        let mut changes: Vec<Vec<Vec<f64>>> = vec![Vec::new(); self.runs.len()];
        for kind in 0..2 {
            let each: Vec<Option<AtRest>> = (self.runs.iter().zip(fitted))
                .map(|(run, fitted)| at_rest(run, kind, &fitted[kind]))
                .collect();
            let range = self.range_of(kind);
            let [zero, drift] = sizes(&each, MOST_DRIFT_PARTS[kind] * range);
            for (run, changes) in self.runs.iter().zip(&mut changes) {
                let Some(channel) = &run.channels[kind] else {
                    continue;
                };
                let parts = parts_of_record(channel);
                // Nothing is known of a zero that nothing was read at: it may be anywhere in the range.
                let zero = if run.zero_is_free(kind) { range } else { zero };
                let mut ways = vec![vec![zero; parts.len()]];
                ways.push(parts.iter().map(|part| drift * part).collect());
                let ways = ways.into_iter().filter(|way| way.iter().any(|v| *v != 0.0));
                changes.extend(ways.map(|way| rows_of(run, kind, channel, way)));
            }
        }
        for (run, changes) in self.runs.iter_mut().zip(changes) {
            run.open_zeros = LeftOpen::of(changes.into_iter());
        }
    }

    fn range_of(&self, kind: usize) -> f64 {
        let channels = self.runs.iter().filter_map(|run| run.channels[kind].as_ref());
        channels
            .map(|channel| {
                let (low, high) = range_of(channel.values().iter().copied());
                high - low
            })
            .fold(0.0, f64::max)
    }
}

/// Standard deviations of zeros and of drifts that the rests of all runs allow; 0 where none tells.
fn sizes(each: &[Option<AtRest>], most_drift: f64) -> [f64; 2] {
    let known: Vec<&AtRest> = each.iter().flatten().collect();
    if known.is_empty() {
        return [0.0; 2];
    }
    let mean = |of: &dyn Fn(&AtRest) -> (f64, f64)| {
        let squares = known
            .iter()
            .map(|own| of(own))
            .map(|(value, variance)| value * value + variance);
        squares.sum::<f64>() / known.len() as f64
    };
    [
        mean(&|own| own.zero).sqrt(),
        mean(&|own| own.drift).sqrt().min(most_drift),
    ]
}

impl GroupRun<'_> {
    fn zero_is_free(&self, kind: usize) -> bool {
        let mut channels = self.given.input.channels.iter();
        let own = channels.find(|channel| channel.is_whole(QUANTITIES[kind]));
        own.and_then(|own| own.open_zero.as_ref())
            .is_some_and(|zero| zero.is_free)
    }
}

/// Number of readings before the drive.
fn readings_at_rest(run: &GroupRun, channel: &WhitenedChannel) -> usize {
    let start_s = run.context(0, None).start_s();
    channel.time_s().partition_point(|t| *t < start_s)
}

fn at_rest(run: &GroupRun, kind: usize, fitted: &[f64]) -> Option<AtRest> {
    let channel = run.channels[kind].as_ref()?;
    let count = readings_at_rest(run, channel);
    if count < FEWEST_AT_REST {
        return None;
    }
    let parts = &parts_of_record(channel)[..count];
    let off: Vec<f64> = (0..count).map(|k| channel.values()[k] - fitted[k]).collect();
    let n = count as f64;
    let (mean, middle) = (sum(&off) / n, sum(parts) / n);
    let square: f64 = parts.iter().map(|part| (part - middle).powi(2)).sum();
    let along = parts
        .iter()
        .zip(&off)
        .map(|(part, off)| (part - middle) * (off - mean));
    let slope = along.sum::<f64>() / square;
    let left: Vec<f64> = (off.iter().zip(parts))
        .map(|(off, part)| off - mean - slope * (part - middle))
        .collect();
    // Means of neighbours hold what memory the noise has, and nothing that the model is asked about.
    let blocks = left.chunks_exact(count / REST_BLOCKS);
    let of_mean = blocks
        .map(|block| (sum(block) / block.len() as f64).powi(2))
        .sum::<f64>()
        / (REST_BLOCKS * (REST_BLOCKS - 2)) as f64;
    (square > 0.0).then(|| AtRest {
        zero: (mean, of_mean),
        drift: (slope, of_mean * n / square),
    })
}

/// Where each reading lies in the record: 0 where the readings begin, 1 at the end.
fn parts_of_record(channel: &WhitenedChannel) -> Vec<f64> {
    let times = channel.time_s();
    let first_s = times.first().copied().unwrap_or(0.0);
    let span_s = times
        .last()
        .map_or(1.0, |last| last - first_s)
        .max(f64::MIN_POSITIVE);
    times.iter().map(|t| (t - first_s) / span_s).collect()
}

/// Change of the whitened rows of a run by a course of one channel.
fn rows_of(run: &GroupRun, kind: usize, channel: &WhitenedChannel, mut own: Vec<f64>) -> Vec<f64> {
    channel.whiten(&mut own);
    let len = |kind: usize| run.channels[kind].as_ref().map_or(0, WhitenedChannel::len);
    let mut rows = vec![0.0; if kind == 0 { 0 } else { len(0) }];
    rows.extend(own);
    rows.resize(len(0) + len(1), 0.0);
    rows
}
