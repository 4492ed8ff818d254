//! Sums of values times polynomials over evenly spaced readings; many readings are first reduced by parabolas.

use super::recurrence::NODES;
use super::recurrence::Recurrence;
use crate::sums;

/// Places whose polynomials are computed together.
const LANES: usize = 32;
/// Parts into which many readings are cut at first; a parabola describes a response over each of them: with
/// e^(-rate t) over a 64th of an octave it leaves less than 3e-8.
const PARTS: usize = 64;
/// Readings in a part from which on three nodes for it are cheaper.
const PART_READINGS: usize = 6;

/// `SUM_j p_k(t_j) y_j` over evenly spaced readings.
pub(super) fn even_sums(recurrence: &Recurrence, values: &[f64]) -> [f64; NODES] {
    let step = 2.0 / (values.len() - 1) as f64;
    let mut sums = PolynomialSums::new(recurrence);
    let length = values.len() / PARTS;
    let (many, rest) = if length >= PART_READINGS {
        values.split_at(values.len() / length * length)
    } else {
        values.split_at(0)
    };
    if let Some(part) = Part::new(length).filter(|_| !many.is_empty()) {
        for (number, values) in many.chunks_exact(length).enumerate() {
            let centre = (number * length) as f64 + 0.5 * (length - 1) as f64;
            for (offset, value) in part.stand_for(values) {
                sums.add((centre + offset) * step - 1.0, value);
            }
        }
    }
    for (number, value) in rest.iter().enumerate() {
        sums.add((many.len() + number) as f64 * step - 1.0, *value);
    }
    sums.finish()
}

/// Three nodes for `length` evenly spaced readings.
struct Part {
    /// Places of the readings about their centre, in steps, and the parabola orthogonal to constant and line.
    line: Vec<f64>,
    bend: Vec<f64>,
    /// Place of the outer nodes.
    outer: f64,
    /// Values at the middle and the outer node of each unit polynomial, times the node's weight.
    middle: [f64; 2],
    side: [f64; 3],
}

impl Part {
    fn new(length: usize) -> Option<Part> {
        let n = length as f64;
        if length < 3 {
            return None;
        }
        let line: Vec<f64> = (0..length).map(|k| k as f64 - 0.5 * (n - 1.0)).collect();
        let mean = (n * n - 1.0) / 12.0;
        let bend: Vec<f64> = line.iter().map(|x| x * x - mean).collect();
        let (square, fourth) = (sums::dot(&line, &line), sums::dot(&bend, &bend));
        // Zero of the discrete Chebyshev polynomial of degree three.
        let outer = ((3.0 * n * n - 7.0) / 20.0).sqrt();
        let weight = |x: f64| {
            let b = x * x - mean;
            (1.0 / n + x * x / square + b * b / fourth).recip()
        };
        let (inside, outside) = (weight(0.0), weight(outer));
        Some(Part {
            line,
            bend,
            outer,
            middle: [inside / n, -inside * mean / fourth],
            side: [
                outside / n,
                outside * outer / square,
                outside * (outer * outer - mean) / fourth,
            ],
        })
    }

    /// Places about the centre, in steps, and what stands there for the readings.
    fn stand_for(&self, values: &[f64]) -> [(f64, f64); 3] {
        let (mut constant, mut line, mut bend) = (0.0, 0.0, 0.0);
        for ((y, x), b) in values.iter().zip(&self.line).zip(&self.bend) {
            constant += y;
            line += x * y;
            bend += b * y;
        }
        let even = self.side[0] * constant + self.side[2] * bend;
        let odd = self.side[1] * line;
        [
            (-self.outer, even - odd),
            (0.0, self.middle[0] * constant + self.middle[1] * bend),
            (self.outer, even + odd),
        ]
    }
}

/// Sums of the polynomials at places times values, many places at a time.
struct PolynomialSums {
    inverse: [f64; NODES],
    ratio: [f64; NODES],
    constant: f64,
    at: [f64; LANES],
    values: [f64; LANES],
    waiting: usize,
    sums: [f64; NODES],
}

impl PolynomialSums {
    fn new(recurrence: &Recurrence) -> PolynomialSums {
        let inverse: [f64; NODES] = std::array::from_fn(|k| recurrence.b[k].recip());
        PolynomialSums {
            inverse,
            ratio: std::array::from_fn(|k| {
                if k > 1 {
                    recurrence.b[k - 1] * inverse[k]
                } else {
                    0.0
                }
            }),
            constant: recurrence.constant,
            at: [0.0; LANES],
            values: [0.0; LANES],
            waiting: 0,
            sums: [0.0; NODES],
        }
    }

    #[inline]
    fn add(&mut self, at: f64, value: f64) {
        self.at[self.waiting] = at;
        self.values[self.waiting] = value;
        self.waiting += 1;
        if self.waiting == LANES {
            self.settle();
        }
    }

    fn settle(&mut self) {
        let (mut last, mut now) = ([0.0; LANES], [self.constant; LANES]);
        for k in 0..NODES {
            if k > 0 {
                let (inverse, ratio) = (self.inverse[k], self.ratio[k]);
                for j in 0..LANES {
                    let next = self.at[j] * now[j] * inverse - ratio * last[j];
                    last[j] = now[j];
                    now[j] = next;
                }
            }
            let mut lanes = [0.0; 4];
            for j in (0..LANES).step_by(4) {
                for lane in 0..4 {
                    lanes[lane] += now[j + lane] * self.values[j + lane];
                }
            }
            self.sums[k] += (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
        }
        self.waiting = 0;
    }

    fn finish(mut self) -> [f64; NODES] {
        self.values[self.waiting..].fill(0.0);
        self.settle();
        self.sums
    }
}
