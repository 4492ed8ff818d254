//! The smooth part of a channel: a free sum of exponentials per segment, and what it leaves.

use crate::sampled::Sampled;

/// Exponentials of the smooth part per segment, at most, and the closest they lie in the logarithm of time.
const SHAPES: usize = 16;
const CLOSEST: f64 = 0.6;

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
            let shapes = if span.segment.is_some() {
                shapes(elapsed_s)
            } else {
                orthonormal(vec![vec![1.0; elapsed_s.len()]])
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
fn shapes(elapsed_s: &[f64]) -> Vec<Vec<f64>> {
    let n = elapsed_s.len();
    let longest_s = elapsed_s.last().copied().unwrap_or(0.0);
    let step_s = elapsed_s
        .windows(3)
        .map(|three| (three[2] - three[0]) / 2.0)
        .fold(f64::INFINITY, f64::min);
    let mut columns = vec![vec![1.0; n]];
    if n >= 6 && longest_s > 0.0 && step_s > 0.0 {
        let (fast, slow) = ((step_s * 2.0).ln(), (longest_s / 1.5).ln());
        let room = ((slow - fast) / CLOSEST).max(0.0) as usize + 1;
        let count = (n / 8).min(room).clamp(2, SHAPES);
        for k in 0..count {
            let tau_s = (slow + (fast - slow) * k as f64 / (count - 1) as f64).exp();
            columns.push(elapsed_s.iter().map(|t| (-t / tau_s).exp()).collect());
        }
    }
    orthonormal(columns)
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
