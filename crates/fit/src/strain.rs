//! The spring strain that the stored charge leaves, and its derivative with respect to the relaxation rate,
//! over the readings of a curvature channel.

use ieap_model::lumped::SegmentResponse;
use ieap_model::relaxation::spring_response;
use ieap_numerics::decay::{BLOCK, Block, Column, Decay};
use ieap_numerics::gram::{CAPACITY, Gram};
use ieap_numerics::least_squares::Local;
use ieap_numerics::symmetric::Symmetric;

use super::sampled::{Remainder, Sampled};

/// Relative distance of lambda from a charging rate below which h is evaluated reading by reading.
const NEAR: f64 = 1e-3;

/// The strain response per unit coupling and its derivative, block by block.
#[derive(Clone, Copy)]
pub(super) struct Strain<'a> {
    pub(super) responses: &'a [SegmentResponse],
    pub(super) area_cm2: f64,
    pub(super) sampled: &'a Sampled,
    pub(super) with_offset: bool,
    /// What the modes leave at every reading, where it was computed for many uses.
    pub(super) charged: Option<&'a Charged>,
}

/// e^(-rate t) of every mode, block after block.
pub(super) struct Charged {
    columns: Vec<Column>,
    /// Where each block's columns start.
    starts: Vec<usize>,
}

impl Charged {
    /// Of the modes `responses` at the readings.
    pub(super) fn new(responses: &[SegmentResponse], sampled: &Sampled) -> Charged {
        let (mut columns, mut starts) = (Vec::new(), Vec::with_capacity(sampled.blocks.len()));
        for (segment, block) in &sampled.blocks {
            starts.push(columns.len());
            let rates = segment.map_or(&[][..], |index| &responses[index].rates_per_s);
            for &rate in rates {
                let mut column = [0.0; BLOCK];
                Decay::new(rate).fill(block, &sampled.elapsed_s, &mut column);
                columns.push(column);
            }
        }
        Charged { columns, starts }
    }
}

/// Strain at one moment and its derivative with respect to lambda.
#[derive(Clone, Copy)]
struct At {
    strain: f64,
    slope: f64,
}

impl Strain<'_> {
    /// Strain at the start of every segment.
    fn starts(&self, rate_per_s: f64) -> Vec<At> {
        let mut now = At {
            strain: 0.0,
            slope: 0.0,
        };
        let mut starts = Vec::with_capacity(self.responses.len());
        for (index, response) in self.responses.iter().enumerate() {
            starts.push(now);
            if let Some(next) = self.responses.get(index + 1) {
                now = later(response, now, next.start_s - response.start_s, rate_per_s);
            }
        }
        starts
    }

    /// Columns of every block: strain, its derivative, ones where an offset is fitted; all times the area.
    pub(super) fn each_block(&self, rate_per_s: f64, mut visit: impl FnMut(&Block, &[Column], &Column)) {
        let starts = self.starts(rate_per_s);
        let mut relaxing = Decay::new(rate_per_s);
        let mut charging: Vec<Decay> = Vec::new();
        let mut current = None;
        let mut columns = vec![[0.0; BLOCK]; if self.with_offset { 3 } else { 2 }];
        let mut y = [0.0; BLOCK];
        for (number, (segment, block)) in self.sampled.blocks.iter().enumerate() {
            columns[0].fill(0.0);
            columns[1].fill(0.0);
            if let Some(index) = *segment {
                let response = &self.responses[index];
                if current != Some(index) {
                    current = Some(index);
                    charging = response
                        .rates_per_s
                        .iter()
                        .map(|&rate| Decay::new(rate))
                        .collect();
                }
                self.fill(
                    block,
                    response,
                    starts[index],
                    rate_per_s,
                    self.charged
                        .map(|charged| &charged.columns[charged.starts[number]..]),
                    &mut relaxing,
                    &mut charging,
                    &mut columns,
                );
            }
            if self.with_offset {
                columns[2] = Sampled::ones(block);
            }
            for column in &mut columns {
                self.sampled.weigh(block, column);
            }
            self.sampled.fill_values(block, &mut y);
            visit(block, &columns, &y);
        }
    }

    #[allow(clippy::too_many_arguments)] // One call; the buffers are kept between blocks for speed.
    fn fill(
        &self,
        block: &Block,
        response: &SegmentResponse,
        start: At,
        rate_per_s: f64,
        known: Option<&[Column]>,
        relaxing: &mut Decay,
        charging: &mut [Decay],
        columns: &mut [Column],
    ) {
        let elapsed_s = &self.sampled.elapsed_s[block.first..block.first + block.len];
        let (strain, slope) = columns.split_at_mut(1);
        let (strain, slope) = (&mut strain[0], &mut slope[0]);
        let mut relaxed = [0.0; BLOCK];
        relaxing.fill(block, &self.sampled.elapsed_s, &mut relaxed);
        for (k, &t) in elapsed_s.iter().enumerate() {
            strain[k] = self.area_cm2 * start.strain * relaxed[k];
            slope[k] = self.area_cm2 * (start.slope - t * start.strain) * relaxed[k];
        }
        let mut charged = [0.0; BLOCK];
        let modes = response
            .rates_per_s
            .iter()
            .zip(&response.charge_amplitudes_c_per_cm2);
        for (mode, ((&mode_rate, amplitude), decay)) in modes.zip(charging).enumerate() {
            let scale = -self.area_cm2 * amplitude;
            let apart = rate_per_s - mode_rate;
            if apart.abs() <= NEAR * mode_rate {
                for (k, &t) in elapsed_s.iter().enumerate() {
                    let (value, derivative) = spring(t, mode_rate, rate_per_s);
                    strain[k] += scale * value;
                    slope[k] += scale * derivative;
                }
                continue;
            }
            if mode_rate == 0.0 {
                continue;
            }
            let charged = match known {
                Some(columns) => &columns[mode],
                None => {
                    decay.fill(block, &self.sampled.elapsed_s, &mut charged);
                    &charged
                }
            };
            let per_apart = apart.recip();
            for (k, &t) in elapsed_s.iter().enumerate() {
                let value = mode_rate * (charged[k] - relaxed[k]) * per_apart;
                strain[k] += scale * value;
                slope[k] += scale * (mode_rate * t * relaxed[k] - value) * per_apart;
            }
        }
    }

    pub(super) fn gram(&self, rate_per_s: f64) -> Gram {
        let mut gram = Gram::new(if self.with_offset { 3 } else { 2 });
        self.each_block(rate_per_s, |block, columns, y| {
            gram.add_first(block.len, columns, y)
        });
        gram.square = self.sampled.square();
        gram
    }

    /// Sum of squares with the coupling (and offset) eliminated, from the residuals themselves.
    pub(super) fn projected_square(&self, rate_per_s: f64) -> f64 {
        let (x, _) = self.solve(&self.gram(rate_per_s));
        let mut left = Remainder::default();
        self.each_block(rate_per_s, |block, columns, y| {
            left.add(&y[..block.len], |k| {
                let offset = columns.get(2).map_or(0.0, |ones| x[2] * ones[k]);
                x[0] * columns[0][k] + offset
            });
        });
        left.square(self.sampled)
    }

    /// Coefficients of strain and offset, and the sum of squares they leave.
    pub(super) fn solve(&self, gram: &Gram) -> ([f64; CAPACITY], f64) {
        let keep: &[usize] = if self.with_offset { &[0, 2] } else { &[0] };
        let mut x = [0.0; CAPACITY];
        let right: Vec<f64> = keep.iter().map(|&k| gram.right[k]).collect();
        if let Some(factor) = gram.matrix.part(keep).cholesky(1e-14) {
            let solution = factor.solve(&right);
            for (value, &k) in solution.iter().zip(keep) {
                x[k] = *value;
            }
        }
        (x, gram.residual_square(&x))
    }

    /// Sum of squares with the coupling (and offset) eliminated; the coordinate is lambda times `unit_s`.
    pub(super) fn projected(&self, rate_per_s: f64, unit_s: f64) -> Local {
        let gram = self.gram(rate_per_s);
        let (x, square) = self.solve(&gram);
        let residual = gram.matrix.times(&x);
        let keep: &[usize] = if self.with_offset { &[0, 2] } else { &[0] };
        let coupling: Vec<f64> = keep.iter().map(|&k| gram.matrix.get(k, 1)).collect();
        let explained = gram.matrix.part(keep).cholesky(0.0).map_or(0.0, |factor| {
            let solved = factor.solve(&coupling);
            coupling.iter().zip(solved).map(|(a, b)| a * b).sum()
        });
        let scale = x[0] / unit_s;
        Local {
            square,
            descent: vec![scale * (gram.right[1] - residual[1])],
            normal: Symmetric::from_fn(1, |_, _| {
                scale * scale * (gram.matrix.get(1, 1) - explained).max(0.0)
            }),
        }
    }
}

/// Strain and its derivative `elapsed_s` later within a segment.
fn later(response: &SegmentResponse, start: At, elapsed_s: f64, rate_per_s: f64) -> At {
    let left = (-rate_per_s * elapsed_s).exp();
    let mut now = At {
        strain: start.strain * left,
        slope: (start.slope - elapsed_s * start.strain) * left,
    };
    let modes = response
        .rates_per_s
        .iter()
        .zip(&response.charge_amplitudes_c_per_cm2);
    for (&mode_rate, amplitude) in modes {
        let (value, derivative) = spring(elapsed_s, mode_rate, rate_per_s);
        now.strain -= amplitude * value;
        now.slope -= amplitude * derivative;
    }
    now
}

/// The spring response g and its derivative with respect to lambda; near the removable singularity the
/// derivative is a difference, elsewhere `(r t e^(-lambda t) - g) / (lambda - r)`.
fn spring(elapsed_s: f64, mode_rate: f64, rate_per_s: f64) -> (f64, f64) {
    let value = spring_response(elapsed_s, mode_rate, rate_per_s);
    let apart = rate_per_s - mode_rate;
    if apart.abs() > NEAR * mode_rate {
        let relaxed = (-rate_per_s * elapsed_s).exp();
        return (value, (mode_rate * elapsed_s * relaxed - value) / apart);
    }
    let step = 1e-4 * mode_rate;
    if step == 0.0 {
        return (value, 0.0);
    }
    let above = spring_response(elapsed_s, mode_rate, rate_per_s + step);
    let below = spring_response(elapsed_s, mode_rate, rate_per_s - step);
    (value, (above - below) / (2.0 * step))
}
