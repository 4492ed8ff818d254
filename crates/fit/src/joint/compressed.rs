//! Readings of a channel condensed to a few numbers that lose nothing a sum of exponentials could tell.
//!
//! In every segment of a drive current and curvature are sums of exponentials, whatever the circuit. The
//! whitened readings are projected on exponentials whose rates lie close on a logarithmic grid; one of any
//! other rate follows by interpolation (its error is below 1e-5 of the signal). A residual then costs
//! microseconds, however long the record.

use crate::sampled::{Sampled, Span};

use super::whitening::Whitener;

/// Spacing of the grid of rates in logarithms.
const SPACING: f64 = 1.0 / 3.0;
/// Nodes that an interpolation uses.
const STENCIL: usize = 12;
/// Slowest rate on the grid times the length of the segment: slower ones are straight lines.
const SLOWEST: f64 = 2e-3;
/// Width of a group of whitened readings in parts of the time since the start of its segment.
const GROUP_WIDTH: f64 = 0.02;
/// Columns smaller than this part of the largest are combinations of the others.
const DEPENDENT: f64 = 1e-8;

/// One exponential of a segment's response: `amplitude e^(-rate t)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mode {
    pub(crate) rate_per_s: f64,
    pub(crate) amplitude: f64,
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

impl CompressedSpan {
    fn new(sampled: &Sampled, span: &Span, whitener: &Whitener) -> CompressedSpan {
        let elapsed_s = &sampled.elapsed_s[span.first..span.end];
        let groups = groups(elapsed_s, span, whitener);
        let white = |mut column: Vec<f64>| {
            whitener.whiten(span, &mut column);
            column
        };
        let condensed = |column: Vec<f64>| grouped(&white(column), &groups);
        let longest_s = elapsed_s[elapsed_s.len() - 1];
        let step_s = elapsed_s
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|step| *step > 0.0)
            .fold(longest_s, f64::min);
        let slowest = (SLOWEST / longest_s).ln();
        let nodes = if span.segment.is_some() && longest_s > 0.0 {
            let fastest = (12.0 / step_s).ln();
            (((fastest - slowest) / SPACING).ceil() as usize + 2).clamp(STENCIL, 120)
        } else {
            0
        };
        let mut columns = vec![condensed(vec![1.0; elapsed_s.len()])];
        for node in 0..nodes {
            let rate = (slowest + SPACING * node as f64).exp();
            columns.push(condensed(elapsed_s.iter().map(|t| (-rate * t).exp()).collect()));
        }
        let target = condensed(sampled.values[span.first..span.end].to_vec());
        let (design, target) = reduced(columns, target);
        CompressedSpan {
            segment: span.segment,
            rows: target.len(),
            slowest,
            nodes,
            design,
            target,
        }
    }

    /// Appends target minus response, where the response is a constant plus modes.
    pub(crate) fn residuals(&self, constant: f64, modes: &[Mode], out: &mut Vec<f64>) {
        let first = out.len();
        out.extend_from_slice(&self.target);
        let out = &mut out[first..];
        let mut constant = constant;
        for mode in modes.iter().filter(|mode| mode.amplitude != 0.0) {
            constant += self.take_mode(mode, out);
        }
        take(&self.design[..self.rows], constant, out);
    }

    /// Takes a mode off; gives the part of it that is constant.
    fn take_mode(&self, mode: &Mode, out: &mut [f64]) -> f64 {
        if self.nodes == 0 {
            return mode.amplitude;
        }
        let place = (mode.rate_per_s.ln() - self.slowest) / SPACING;
        if place < 0.0 {
            let share = place.min(0.0) * SPACING;
            let share = share.exp();
            take(self.node(0), mode.amplitude * share, out);
            return mode.amplitude * (1.0 - share);
        }
        let place = place.min((self.nodes - 1) as f64);
        let first = (place as usize)
            .saturating_sub(STENCIL / 2 - 1)
            .min(self.nodes - STENCIL);
        for (k, weight) in lagrange(place - first as f64).into_iter().enumerate() {
            take(self.node(first + k), mode.amplitude * weight, out);
        }
        0.0
    }

    fn node(&self, node: usize) -> &[f64] {
        &self.design[(node + 1) * self.rows..(node + 2) * self.rows]
    }
}

fn take(column: &[f64], by: f64, out: &mut [f64]) {
    for (out, value) in out.iter_mut().zip(column) {
        *out -= by * value;
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

/// Ends of groups of readings over which whitened columns hardly vary.
fn groups(elapsed_s: &[f64], span: &Span, whitener: &Whitener) -> Vec<usize> {
    let mut ends = Vec::new();
    let mut start = 0;
    for k in 1..=elapsed_s.len() {
        let joins = k < elapsed_s.len()
            && whitener.is_even(span.first, span.first + k)
            && (span.segment.is_none() || elapsed_s[k] <= elapsed_s[start] * (1.0 + GROUP_WIDTH));
        if !joins {
            ends.push(k);
            start = k;
        }
    }
    ends
}

/// Sums over the groups, divided by the roots of their sizes: white noise stays white and of unit size.
fn grouped(column: &[f64], ends: &[usize]) -> Vec<f64> {
    let mut start = 0;
    let sums = ends.iter().map(|&end| {
        let sum: f64 = column[start..end].iter().sum();
        let count = (end - start) as f64;
        start = end;
        sum / count.sqrt()
    });
    sums.collect()
}

/// The same columns and target in coordinates of the space that the columns span (Gram and Schmidt, largest
/// column first).
fn reduced(mut columns: Vec<Vec<f64>>, mut target: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut kept = Vec::new();
    let mut largest: Option<f64> = None;
    while rows.len() < target.len() {
        let norms = columns.iter().map(|column| inner(column, column).sqrt());
        let Some((pivot, norm)) = norms.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else {
            break;
        };
        let most = *largest.get_or_insert(norm);
        if norm.is_nan() || norm <= DEPENDENT * most || norm.is_infinite() {
            break;
        }
        let direction: Vec<f64> = columns[pivot].iter().map(|value| value / norm).collect();
        let mut row = Vec::with_capacity(columns.len());
        for column in &mut columns {
            let part = inner(&direction, column);
            take(&direction, part, column);
            row.push(part);
        }
        let part = inner(&direction, &target);
        take(&direction, part, &mut target);
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

    #[test]
    fn condensed_residuals_are_those_of_all_readings() {
        let time_s: std::sync::Arc<[f64]> = (0..3000).map(|k| 0.5 * f64::from(k)).collect();
        let value =
            |t: f64| 0.2 + 1.3 * (-t / 7.7).exp() - 0.4 * (-t / 333.0).exp() + 0.1 * (-t * 1e-6).exp();
        let values: Vec<f64> = time_s.iter().map(|&t| value(t)).collect();
        let channel = Channel::new(Quantity::Current, time_s, values.into());
        let sampled = Sampled::new(&channel, &Drive::step(1.0), false);
        let whitener = Whitener::new(&sampled, &vec![1e-3; 3000], &Autocorrelation::Order(vec![0.6]));
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
        assert!(error < 1e-5, "{error}");
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
            (square(&left) / square(&whole) - 1.0).abs() < 1e-3,
            "{} {}",
            square(&left),
            square(&whole)
        );
    }
}
