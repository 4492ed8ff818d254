//! The smooth part of a channel: a free sum of exponentials per segment, and what it leaves. Where the voltage moves all the
//! time there is beside it a free answer to the voltage.

use ieap_domain::{Drive, Level};

use crate::joint::policy::{CLOSEST_SHAPES_LOG, MOST_SHAPES, POWERS, READINGS_PER_ANSWER};
use crate::sampled::Sampled;

/// Orthonormal smooth shapes per span, and what they leave.
pub(super) struct Smooth {
    pub(super) shapes: Vec<Vec<Vec<f64>>>,
    pub(super) level: Vec<f64>,
    pub(super) rest: Vec<f64>,
}

impl Smooth {
    pub(super) fn of(sampled: &Sampled) -> Smooth {
        let mut smooth = Smooth {
            shapes: Vec::new(),
            level: vec![0.0; sampled.len()],
            rest: sampled.values.to_vec(),
        };
        for span in &sampled.spans {
            let elapsed_s = &sampled.elapsed_s[span.first..span.end];
            let shapes = match (&span.segment, &sampled.course) {
                (None, _) => orthonormal(vec![vec![1.0; elapsed_s.len()]]),
                (Some(_), None) => orthonormal(decays(elapsed_s)),
                (Some(_), Some(drive)) => {
                    let answers = answers(drive, &sampled.time_s[span.first..span.end], elapsed_s);
                    orthonormal([decays(elapsed_s), answers].concat())
                }
            };
            let rest = &mut smooth.rest[span.first..span.end];
            let level = &mut smooth.level[span.first..span.end];
            for shape in &shapes {
                let part = inner(shape, rest);
                for ((rest, level), s) in rest.iter_mut().zip(level.iter_mut()).zip(shape) {
                    *rest -= part * s;
                    *level += part * s;
                }
            }
            smooth.shapes.push(shapes);
        }
        smooth
    }

    pub(super) fn terms(&self) -> f64 {
        self.shapes.iter().map(Vec::len).sum::<usize>() as f64
    }
}

/// A constant and exponentials whose time constants are spread over the segment.
fn decays(elapsed_s: &[f64]) -> Vec<Vec<f64>> {
    let n = elapsed_s.len();
    let mut columns = vec![vec![1.0; n]];
    for tau_s in time_constants_s(elapsed_s, n / 8, MOST_SHAPES) {
        columns.push(elapsed_s.iter().map(|t| (-t / tau_s).exp()).collect());
    }
    columns
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

/// Gram and Schmidt, twice; dependent columns fall out.
fn orthonormal(columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut found: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let before = inner(&column, &column).sqrt();
        for _ in 0..2 {
            for shape in &found {
                let part = inner(shape, &column);
                column.iter_mut().zip(shape).for_each(|(c, s)| *c -= part * s);
            }
        }
        let norm = inner(&column, &column).sqrt();
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
