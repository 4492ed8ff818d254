//! The smooth part of a channel: a free sum of exponentials per segment, and what it leaves. Where the voltage moves all the
//! time there is beside it a free answer to the voltage.

use std::cell::OnceCell;

use ieap_domain::{Drive, Level};
use ieap_numerics::decay::{BLOCK, Block, Decay, blocks};

use crate::joint::policy::{CLOSEST_SHAPES_LOG, GONE_AT, MOST_SHAPES, POWERS, READINGS_PER_ANSWER};
use crate::sampled::{Sampled, Span};

use super::short_shapes::ShortShapes;

/// Smooth shapes of every span, and what they leave.
pub(super) struct Smooth {
    /// The shapes at nodes, where all readings follow each other evenly and no voltage moves.
    short: Option<Vec<ShortShapes>>,
    /// Orthonormal shapes at all readings, where they are asked for.
    whole: OnceCell<Vec<Vec<Vec<f64>>>>,
    terms: usize,
    pub(super) level: Vec<f64>,
    pub(super) rest: Vec<f64>,
}

impl Smooth {
    pub(super) fn of(sampled: &Sampled) -> Smooth {
        let mut smooth = Smooth {
            short: None,
            whole: OnceCell::new(),
            terms: 0,
            level: vec![0.0; sampled.len()],
            rest: sampled.values.to_vec(),
        };
        let short = |span: &Span| ShortShapes::of(sampled, span, &mut smooth.level[span.first..span.end]);
        smooth.short = sampled.spans.iter().map(short).collect();
        if let Some(short) = &smooth.short {
            smooth.terms = short.iter().map(ShortShapes::count).sum();
            take(&smooth.level, 1.0, &mut smooth.rest);
            return smooth;
        }
        smooth.level.fill(0.0);
        let whole = whole(sampled);
        for (span, shapes) in sampled.spans.iter().zip(&whole) {
            let rest = &mut smooth.rest[span.first..span.end];
            let level = &mut smooth.level[span.first..span.end];
            for shape in shapes {
                let part = inner(shape, rest);
                take(shape, part, rest);
                take(shape, -part, level);
            }
        }
        smooth.terms = whole.iter().map(Vec::len).sum();
        smooth.whole = OnceCell::from(whole);
        smooth
    }

    /// How many shapes there are.
    pub(super) fn terms(&self) -> f64 {
        self.terms as f64
    }

    /// Orthonormal shapes of every span of `sampled`, whose smooth part this is.
    pub(super) fn shapes(&self, sampled: &Sampled) -> &[Vec<Vec<f64>>] {
        self.whole.get_or_init(|| whole(sampled))
    }

    /// The shapes at nodes; none where there are no such.
    pub(super) fn short(&self) -> Option<&[ShortShapes]> {
        self.short.as_deref()
    }
}

/// Orthonormal shapes of every span at all readings.
fn whole(sampled: &Sampled) -> Vec<Vec<Vec<f64>>> {
    let of_span = |span: &Span| {
        let elapsed_s = &sampled.elapsed_s[span.first..span.end];
        let columns = match (&span.segment, &sampled.course) {
            (None, _) => vec![vec![1.0; elapsed_s.len()]],
            (Some(_), None) => decays(elapsed_s),
            (Some(_), Some(drive)) => {
                let answers = answers(drive, &sampled.time_s[span.first..span.end], elapsed_s);
                [decays(elapsed_s), answers].concat()
            }
        };
        orthonormal(columns, elapsed_s.len())
    };
    sampled.spans.iter().map(of_span).collect()
}

/// A constant and exponentials whose time constants are spread over the segment.
fn decays(elapsed_s: &[f64]) -> Vec<Vec<f64>> {
    let blocks = blocks(elapsed_s, 0, elapsed_s.len());
    let column = |rate: f64| {
        let mut column = vec![0.0; elapsed_s.len()];
        add_decay(1.0, rate, &blocks, elapsed_s, &mut column);
        column
    };
    rates_per_s(elapsed_s).into_iter().map(column).collect()
}

/// The rate of a constant, and those of exponentials that are spread over the segment.
pub(super) fn rates_per_s(elapsed_s: &[f64]) -> Vec<f64> {
    let spread = time_constants_s(elapsed_s, elapsed_s.len() / 8, MOST_SHAPES);
    let spread = spread.into_iter().map(f64::recip);
    std::iter::once(0.0).chain(spread).collect()
}

/// Adds `amplitude` times e^(-rate t).
pub(super) fn add_decay(
    amplitude: f64,
    rate_per_s: f64,
    blocks: &[Block],
    elapsed_s: &[f64],
    out: &mut [f64],
) {
    let (mut decay, mut own) = (Decay::new(rate_per_s), [0.0; BLOCK]);
    for block in blocks {
        if rate_per_s * elapsed_s[block.first] > GONE_AT {
            break;
        }
        decay.fill(block, elapsed_s, &mut own);
        take(&own, -amplitude, &mut out[block.first..block.first + block.len]);
    }
}

/// Takes so much of a series off another one.
pub(super) fn take(series: &[f64], by: f64, out: &mut [f64]) {
    out.iter_mut().zip(series).for_each(|(out, own)| *out -= by * own);
}

/// Time constants from the record's length down to the distance of readings, at most so many; none of too few readings.
fn time_constants_s(elapsed_s: &[f64], count: usize, most: usize) -> Vec<f64> {
    let longest_s = elapsed_s.last().copied().unwrap_or(0.0);
    let step_s = elapsed_s
        .windows(3)
        .map(|three| (three[2] - three[0]) / 2.0)
        .fold(f64::INFINITY, f64::min);
    if elapsed_s.len() < 6 || longest_s <= 0.0 || step_s <= 0.0 {
        return Vec::new();
    }
    let (fast, slow) = ((step_s * 2.0).ln(), (longest_s / 1.5).ln());
    let room = ((slow - fast) / CLOSEST_SHAPES_LOG).max(0.0) as usize + 1;
    let count = count.min(room).clamp(2, most);
    let at = |k: usize| (slow + (fast - slow) * k as f64 / (count - 1) as f64).exp();
    (0..count).map(at).collect()
}

/// What follows a moving voltage: its powers, and their means over the past that forget in so many time constants.
fn answers(drive: &Drive, time_s: &[f64], elapsed_s: &[f64]) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for (power, most) in POWERS {
        columns.push(remembered(drive, time_s, power, 0.0));
        let count = time_s.len() / READINGS_PER_ANSWER / POWERS.len();
        for tau_s in time_constants_s(elapsed_s, count, most) {
            columns.push(remembered(drive, time_s, power, tau_s));
        }
    }
    columns
}

/// The mean of a power of the voltage over the past, forgotten in `tau_s`, at times that increase; in steady state before the
/// first segment. With the circuit open the last voltage stays.
fn remembered(drive: &Drive, time_s: &[f64], power: i32, tau_s: f64) -> Vec<f64> {
    let left = |passed_s: f64| {
        if tau_s > 0.0 {
            (-passed_s / tau_s).exp()
        } else {
            0.0
        }
    };
    let mut segments = drive.segments.iter().peekable();
    let mut level = drive.baseline_v.powi(power);
    let (mut mean, mut at_s) = (level, time_s.first().copied().unwrap_or(0.0));
    let mut out = Vec::with_capacity(time_s.len());
    for &t in time_s {
        while let Some(segment) = segments.next_if(|segment| segment.start_s() <= t) {
            mean = level + (mean - level) * left((segment.start_s() - at_s).max(0.0));
            at_s = segment.start_s();
            if let Level::Voltage(volts) = segment.level {
                level = volts.powi(power);
            }
        }
        mean = level + (mean - level) * left((t - at_s).max(0.0));
        at_s = t;
        out.push(mean);
    }
    out
}

/// Columns made orthonormal over so many of their entries (Gram and Schmidt, twice); dependent ones fall out.
pub(super) fn orthonormal(columns: Vec<Vec<f64>>, over: usize) -> Vec<Vec<f64>> {
    let mut found: Vec<Vec<f64>> = Vec::new();
    let norm = |column: &[f64]| inner(&column[..over], &column[..over]).sqrt();
    for mut column in columns {
        let before = norm(&column);
        for _ in 0..2 {
            for shape in &found {
                let part = inner(&shape[..over], &column[..over]);
                take(shape, part, &mut column);
            }
        }
        let norm = norm(&column);
        if norm > 1e-6 * before && norm.is_finite() {
            column.iter_mut().for_each(|c| *c /= norm);
            found.push(column);
        }
    }
    found
}

/// Inner product in eight running sums, which the compiler turns into vector instructions.
pub(super) fn inner(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (left, right) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = left
        .remainder()
        .iter()
        .zip(right.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (left, right) in left.zip(right) {
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum += left[lane] * right[lane];
        }
    }
    sums.iter().sum::<f64>() + rest
}
