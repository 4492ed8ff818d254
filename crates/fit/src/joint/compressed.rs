//! Readings of a channel condensed to a few numbers that lose nothing a sum of exponentials could tell.
//!
//! In every segment of a drive current and curvature are sums of exponentials, whatever the circuit and wherever the edge before
//! the readings was, which only rescales them. The whitened readings are projected on exponentials of the time since the first of
//! them whose rates lie close on a logarithmic grid; one of any other rate follows by interpolation. A residual then costs
//! microseconds, however long the record.

use ieap_numerics::decay::{BLOCK, Block, Decay, blocks};
use ieap_numerics::sums::{add, dot};

use crate::sampled::{Sampled, Span};

use super::kinds::KindsOfNoise;
use super::nodes::Nodes;
use super::whitening::Whitener;

/// Spacing of the grid of rates in logarithms, and nodes that an interpolation uses: its error is 1e-9 of the signal. (At 1/3 and
/// 12 it is 4e-6, which moved estimates of quiet readings by up to half of their error.)
const SPACING: f64 = 1.0 / 6.0;
const STENCIL: usize = 14;
/// Nodes at most.
const MOST_NODES: usize = 240;
/// Fastest rate on the grid times the shortest interval: faster ones are gone at the second reading.
const FASTEST: f64 = 20.0;
/// Slowest rate on the grid times the length of the segment: of slower ones readings are parabolas in the rate.
const SLOWEST: f64 = 2e-3;
/// Width of a group of whitened readings in parts of the time since the first of its segment. Of a group mean, slope and bend
/// are kept: the rest moves an estimate by some 1e-6 of its error.
const GROUP_WIDTH: f64 = 0.02;
/// Shapes of a group that are kept, and the least norm of one that is no combination of the others.
const SHAPES: usize = 3;
const LEAST_NORM: f64 = 1e-6;
/// Columns smaller than this part of the largest are combinations of the others.
const DEPENDENT: f64 = 1e-8;

/// One exponential of a segment's response: `amplitude e^(-rate t)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mode {
    pub(crate) rate_per_s: f64,
    pub(crate) amplitude: f64,
}

impl Mode {
    /// What is left of it so much later.
    pub(crate) fn die(&mut self, lag_s: f64) {
        self.amplitude *= (-self.rate_per_s * lag_s).exp();
    }
}

/// A channel's readings in condensed form.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Compressed {
    pub(crate) spans: Vec<CompressedSpan>,
}

/// Readings of one segment.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CompressedSpan {
    pub(crate) segment: Option<usize>,
    /// Time of the first reading, s.
    pub(crate) first_s: f64,
    rows: usize,
    slowest: f64,
    nodes: usize,
    /// Column by column: the constant, then the exponentials from slow to fast.
    design: Vec<f64>,
    target: Vec<f64>,
}

impl Compressed {
    pub(crate) fn new(sampled: &Sampled, whitener: &Whitener) -> Compressed {
        let span = |span: &Span| CompressedSpan::new(sampled, span, whitener);
        Compressed {
            spans: sampled.spans.iter().map(span).collect(),
        }
    }
}

impl Compressed {
    /// By the means that the kinds of noise were told from, whitened by what they are together; readings are in units of
    /// `scale`.
    pub(crate) fn by_means(sampled: &Sampled, noise: &KindsOfNoise, scale: &[f64]) -> Compressed {
        let of_span = |(place, span): (usize, &Span)| {
            CompressedSpan::with(sampled, span, |elapsed_s, rates| {
                noise.white_columns(
                    place,
                    &sampled.values[span.first..span.end],
                    scale,
                    elapsed_s,
                    rates,
                )
            })
        };
        Compressed {
            spans: sampled.spans.iter().enumerate().map(of_span).collect(),
        }
    }
}

impl CompressedSpan {
    fn new(sampled: &Sampled, span: &Span, whitener: &Whitener) -> CompressedSpan {
        CompressedSpan::with(sampled, span, |elapsed_s, rates| {
            condensed(sampled, span, whitener, elapsed_s, rates)
        })
    }

    fn with(
        sampled: &Sampled,
        span: &Span,
        condensed: impl FnOnce(&[f64], &[f64]) -> (Vec<Vec<f64>>, Vec<f64>),
    ) -> CompressedSpan {
        let first_s = sampled.time_s[span.first];
        let elapsed_s: Vec<f64> = sampled.time_s[span.first..span.end]
            .iter()
            .map(|t| t - first_s)
            .collect();
        let longest_s = elapsed_s[elapsed_s.len() - 1];
        let step_s = elapsed_s
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|step| *step > 0.0)
            .fold(longest_s, f64::min);
        let slowest = (SLOWEST / longest_s).ln();
        let nodes = if span.segment.is_some() && longest_s > 0.0 {
            let fastest = (FASTEST / step_s).ln();
            (((fastest - slowest) / SPACING).ceil() as usize + 2).clamp(STENCIL, MOST_NODES)
        } else {
            0
        };
        let rates = (0..nodes).map(|node| (slowest + SPACING * node as f64).exp());
        let rates: Vec<f64> = std::iter::once(0.0).chain(rates).collect();
        let (columns, target) = condensed(&elapsed_s, &rates);
        let (design, target) = reduced(columns, target);
        CompressedSpan {
            segment: span.segment,
            first_s,
            rows: target.len(),
            slowest,
            nodes,
            design,
            target,
        }
    }

    /// Appends target minus response, where the response is a constant plus modes from the first reading on.
    pub(crate) fn residuals(&self, constant: f64, modes: &[Mode], out: &mut Vec<f64>) {
        let first = out.len();
        out.extend_from_slice(&self.target);
        let out = &mut out[first..];
        let mut constant = constant;
        for mode in modes.iter().filter(|mode| mode.amplitude != 0.0) {
            constant += self.take_mode(mode, out);
        }
        add(out, -constant, &self.design[..self.rows]);
    }

    /// Takes a mode off; gives the part of it that is constant.
    fn take_mode(&self, mode: &Mode, out: &mut [f64]) -> f64 {
        if self.nodes == 0 {
            return mode.amplitude;
        }
        let place = (mode.rate_per_s.ln() - self.slowest) / SPACING;
        if place < 0.0 {
            // A parabola over the rate: through the constant at 0 and the two slowest nodes.
            let (rate, next) = ((place * SPACING).exp(), SPACING.exp());
            let first = rate * (next - rate) / (next - 1.0);
            let second = rate * (rate - 1.0) / (next * (next - 1.0));
            add(out, -mode.amplitude * first, self.node(0));
            add(out, -mode.amplitude * second, self.node(1));
            return mode.amplitude * (1.0 - first - second);
        }
        let place = place.min((self.nodes - 1) as f64);
        let first = (place as usize)
            .saturating_sub(STENCIL / 2 - 1)
            .min(self.nodes - STENCIL);
        for (k, weight) in lagrange(place - first as f64).into_iter().enumerate() {
            add(out, -mode.amplitude * weight, self.node(first + k));
        }
        0.0
    }

    fn node(&self, node: usize) -> &[f64] {
        &self.design[(node + 1) * self.rows..(node + 2) * self.rows]
    }
}

/// Weights of even nodes 0, 1, ... for the value at `x` (barycentric form).
fn lagrange(x: f64) -> [f64; STENCIL] {
    let nearest = x.round();
    let mut weights = [0.0; STENCIL];
    if (x - nearest).abs() < 1e-12 {
        weights[nearest as usize] = 1.0;
        return weights;
    }
    let (mut binomial, mut sum) = (1.0, 0.0);
    for (k, weight) in weights.iter_mut().enumerate() {
        *weight = binomial / (x - k as f64);
        sum += *weight;
        binomial *= -((STENCIL - 1 - k) as f64) / (k + 1) as f64;
    }
    weights.iter_mut().for_each(|weight| *weight /= sum);
    weights
}

/// e^(-rate t) of every rate, and the readings, made white and short: by nodes where one rule holds for all readings, else by
/// groups.
fn condensed(
    sampled: &Sampled,
    span: &Span,
    whitener: &Whitener,
    elapsed_s: &[f64],
    rates_per_s: &[f64],
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let white = |mut column: Vec<f64>| {
        whitener.whiten(span, &mut column);
        column
    };
    let values = white(sampled.values[span.first..span.end].to_vec());
    if let Some(steady) = whitener.steady(span)
        && let Some((nodes, target)) = Nodes::of(elapsed_s, steady.coefficients.len(), &values)
    {
        let column = |rate: &f64| nodes.white_column(*rate, span, whitener, &steady);
        return (rates_per_s.iter().map(column).collect(), target);
    }
    let groups = groups(elapsed_s, span, whitener);
    let blocks = blocks(elapsed_s, 0, elapsed_s.len());
    let column = |rate: &f64| grouped(&white(decay(*rate, &blocks, elapsed_s)), &groups);
    (
        rates_per_s.iter().map(column).collect(),
        grouped(&values, &groups),
    )
}

/// e^(-rate t) at all readings.
fn decay(rate_per_s: f64, blocks: &[Block], elapsed_s: &[f64]) -> Vec<f64> {
    let (mut decay, mut own) = (Decay::new(rate_per_s), [0.0; BLOCK]);
    let mut column = Vec::with_capacity(elapsed_s.len());
    for block in blocks {
        decay.fill(block, elapsed_s, &mut own);
        column.extend_from_slice(&own[..block.len]);
    }
    column
}

/// Consecutive readings over which whitened columns are parabolas.
struct Group {
    end: usize,
    /// Orthonormal polynomials of the time over its readings, up to the second order.
    shapes: Vec<Vec<f64>>,
}

impl Group {
    fn of(elapsed_s: &[f64], start: usize, end: usize) -> Group {
        let own = &elapsed_s[start..end];
        let (from_s, length_s) = (own[0], own[own.len() - 1] - own[0]);
        let mut shapes: Vec<Vec<f64>> = Vec::with_capacity(SHAPES);
        for order in 0..SHAPES.min(own.len()) as i32 {
            let place = |t: &f64| (2.0 * (t - from_s) / length_s.max(f64::MIN_POSITIVE) - 1.0).powi(order);
            let mut shape: Vec<f64> = own.iter().map(place).collect();
            for before in &shapes {
                let part = dot(before, &shape);
                add(&mut shape, -part, before);
            }
            let norm = dot(&shape, &shape).sqrt();
            if norm > LEAST_NORM {
                shapes.push(shape.iter().map(|v| v / norm).collect());
            }
        }
        Group { end, shapes }
    }
}

fn groups(elapsed_s: &[f64], span: &Span, whitener: &Whitener) -> Vec<Group> {
    let mut groups = Vec::new();
    let mut start = 0;
    for k in 1..=elapsed_s.len() {
        let joins = k < elapsed_s.len()
            && whitener.is_even(span.first, span.first + k)
            && (span.segment.is_none() || elapsed_s[k] <= elapsed_s[start] * (1.0 + GROUP_WIDTH));
        if !joins {
            groups.push(Group::of(elapsed_s, start, k));
            start = k;
        }
    }
    groups
}

/// What each group holds of its shapes: white noise stays white and of unit size.
fn grouped(column: &[f64], groups: &[Group]) -> Vec<f64> {
    let mut start = 0;
    let mut rows = Vec::with_capacity(SHAPES * groups.len());
    for group in groups {
        let own = &column[start..group.end];
        rows.extend(group.shapes.iter().map(|shape| dot(shape, own)));
        start = group.end;
    }
    rows
}

/// The same columns and target in coordinates of the space that the columns span (Gram and Schmidt, largest
/// column first).
fn reduced(mut columns: Vec<Vec<f64>>, mut target: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut kept = Vec::new();
    let mut squares: Vec<f64> = columns.iter().map(|column| dot(column, column)).collect();
    let mut largest: Option<f64> = None;
    while rows.len() < target.len() {
        let each = squares.iter().enumerate();
        let Some((pivot, &expected)) = each.max_by(|a, b| a.1.total_cmp(b.1)) else {
            break;
        };
        let square = dot(&columns[pivot], &columns[pivot]);
        if square < 0.5 * expected {
            // What is left of it was smaller than the rounding of what was taken off.
            squares[pivot] = square;
            continue;
        }
        let norm = square.sqrt();
        let most = *largest.get_or_insert(norm);
        if norm.is_nan() || norm <= DEPENDENT * most || norm.is_infinite() {
            break;
        }
        let direction: Vec<f64> = columns[pivot].iter().map(|value| value / norm).collect();
        let mut row = Vec::with_capacity(columns.len());
        for (column, square) in columns.iter_mut().zip(&mut squares) {
            let part = dot(&direction, column);
            add(column, -part, &direction);
            *square -= part * part;
            row.push(part);
        }
        let part = dot(&direction, &target);
        add(&mut target, -part, &direction);
        kept.push(part);
        rows.push(row);
    }
    let count = columns.len();
    let design = (0..count)
        .flat_map(|column| rows.iter().map(move |row| row[column]))
        .collect();
    (design, kept)
}

#[cfg(test)]
mod tests {
    use super::super::whitening::Autocorrelation;
    use super::*;
    use ieap_domain::{Channel, Drive, Quantity};

    /// Over noise of every kind: of one size and short memory, of a long one, of sizes that differ, and at uneven times.
    #[test]
    fn condensed_residuals_are_those_of_all_readings() {
        let even: Vec<f64> = (0..3000).map(|k| 0.5 * f64::from(k)).collect();
        let uneven: Vec<f64> = even.iter().map(|t| t + 0.1 * (3.0 * t).sin()).collect();
        let growing: Vec<f64> = even.iter().map(|t| 1e-3 * (1.0 + (-t / 300.0).exp())).collect();
        let same = vec![1e-3; 3000];
        for order in [vec![], vec![0.6], vec![0.4, -0.2, 0.3]] {
            assert_is_that_of_all(&even, &same, Autocorrelation::Order(order));
        }
        assert_is_that_of_all(&even, &growing, Autocorrelation::Order(vec![0.6]));
        let time = Autocorrelation::Time {
            correlation_time_s: 1.0,
        };
        assert_is_that_of_all(&uneven, &same, Autocorrelation::Order(vec![]));
        assert_is_that_of_all(&even, &same, time);
    }

    #[track_caller]
    fn assert_is_that_of_all(time_s: &[f64], sd: &[f64], autocorrelation: Autocorrelation) {
        let time_s: std::sync::Arc<[f64]> = time_s.into();
        let value =
            |t: f64| 0.2 + 1.3 * (-t / 7.7).exp() - 0.4 * (-t / 333.0).exp() + 0.1 * (-t * 1e-6).exp();
        let values: Vec<f64> = time_s.iter().map(|&t| value(t)).collect();
        let channel = Channel::new(Quantity::Current, time_s, values.into());
        let sampled = Sampled::new(&channel, &Drive::step(1.0), false);
        let whitener = Whitener::new(&sampled, sd, &autocorrelation);
        let span = &Compressed::new(&sampled, &whitener).spans[0];
        let mode = |rate_per_s: f64, amplitude| Mode {
            rate_per_s,
            amplitude,
        };
        let mut left = Vec::new();
        let exact = [mode(1.0 / 7.7, 1.3), mode(1.0 / 333.0, -0.4), mode(1e-6, 0.1)];
        span.residuals(0.2, &exact, &mut left);
        let square = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
        let mut signal = sampled.values.to_vec();
        whitener.whiten(&sampled.spans[0], &mut signal);
        let error = (square(&left) / square(&signal)).sqrt();
        assert!(error < 1e-8, "{error}");
        // A wrong rate leaves what it leaves of all readings.
        left.clear();
        span.residuals(0.2, &[mode(1.0 / 8.7, 1.3), exact[1], exact[2]], &mut left);
        let mut whole: Vec<f64> = sampled
            .time_s
            .iter()
            .map(|&t| 1.3 * ((-t / 7.7).exp() - (-t / 8.7).exp()))
            .collect();
        whitener.whiten(&sampled.spans[0], &mut whole);
        assert!(
            (square(&left) / square(&whole) - 1.0).abs() < 1e-9,
            "{} {}",
            square(&left),
            square(&whole)
        );
    }
}
