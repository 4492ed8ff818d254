//! The smoothest curve that the edges allow: least squares on the curvature's spline, its roughness weighed by the
//! evidence, readings that disagree with their neighbours left out.

use super::believed::believed;
use super::curve::{Curve, PARAMETERS};
use super::edges::Edges;
use super::ground::{biweight, median};
use super::spline::{COEFFICIENTS, INTERVALS};
use ieap_numerics::robust::sd_about_median;
use ieap_numerics::symmetric::Symmetric;

/// Readings further off than this many standard deviations count nothing (Tukey's biweight).
const LEFT_OUT: f64 = 4.685;
/// No edge of a real strip is followed better than this, pixels.
const LEAST_NOISE: f64 = 0.01;
/// Weight of an edge beside one that is something else's: some of what disturbs that one reaches it.
const ONE_EDGE: f64 = 0.1;
/// Order of the differences that are rough.
const ORDER: usize = 3;
/// Lags of the residuals' correlation that are summed at most, places.
const LONGEST_LAG: usize = 24;

/// Normal equations of a step, and what the readings say of noise.
pub struct Equations {
    /// Weighted products of derivatives, each divided by the variance of a reading.
    gram: Symmetric,
    /// Weighted products of derivatives and readings.
    right: Vec<f64>,
    /// Standard deviation of one edge, pixels.
    pub noise: f64,
    /// For each place, the larger of both edges' weights.
    pub weight: Vec<f64>,
}

/// A solution with its uncertainty.
pub struct Solution {
    /// Change of the start, angle and coefficients.
    pub change: Vec<f64>,
    /// Covariance of them, pixels, rad and 1/pixel.
    pub covariance: Symmetric,
    /// Length of strip that one free parameter of the curvature stands for, pixels.
    pub bandwidth: f64,
}

impl Equations {
    /// Sets the equations up for a curve and edges measured about it. As long as it may
    /// still be off the strip by about `doubt` pixels, readings that far off are believed.
    pub fn new(curve: &Curve, edges: &Edges, doubt: f64) -> Equations {
        let n = curve.places();
        let ends = end_margin(edges, n);
        let used = |k: usize| k >= ends && k + ends < n;
        let course = course(edges, n / INTERVALS);
        let offs: Vec<f64> = (0..n)
            .filter(|&k| used(k) && !edges.doubtful[k])
            .flat_map(|k| [0, 1].map(|side: usize| edges.middle[side][k].map(|reading| reading - course[k])))
            .flatten()
            .collect();
        let noise = sd_about_median(&offs).max(LEAST_NOISE);
        let left_out = LEFT_OUT * noise.max(doubt);
        let believed = believed(edges, noise, doubt > 0.0);
        let mut weight = vec![0.0; n];
        let mut readings = vec![(0.0, 0.0); n];
        for k in (0..n).filter(|&k| used(k)) {
            for (side, believed) in edges.middle.iter().zip(&believed) {
                if let Some(reading) = side[k].filter(|_| believed[k]) {
                    let w = biweight(reading / left_out);
                    weight[k] = f64::max(weight[k], w);
                    let w = if edges.doubtful[k] { w * ONE_EDGE } else { w };
                    readings[k].0 += w;
                    readings[k].1 += w * reading;
                }
            }
        }
        let memory = memory(&readings, &course);
        let mut gram = Symmetric::zero(PARAMETERS);
        let mut right = vec![0.0; PARAMETERS];
        let per_reading = 1.0 / (noise * noise * memory);
        let mut products = vec![0.0; PARAMETERS * PARAMETERS];
        curve.derivatives(|k, moved| {
            let (w, sum) = readings[k];
            if w == 0.0 {
                return;
            }
            let (nx, ny) = curve.normal(k);
            let row: [f64; PARAMETERS] = std::array::from_fn(|p| moved[p].0 * nx + moved[p].1 * ny);
            // Coefficients far ahead do not move a place yet.
            let end = row
                .iter()
                .rposition(|value| *value != 0.0)
                .map_or(0, |last| last + 1);
            for i in 0..end {
                right[i] += row[i] * sum * per_reading;
                let weighted = row[i] * w * per_reading;
                let line = &mut products[i * PARAMETERS..i * PARAMETERS + i + 1];
                line.iter_mut()
                    .zip(&row)
                    .for_each(|(product, value)| *product += weighted * value);
            }
        });
        for i in 0..PARAMETERS {
            for j in 0..=i {
                gram.add(i, j, products[i * PARAMETERS + j]);
                if i != j {
                    gram.add(j, i, products[i * PARAMETERS + j]);
                }
            }
        }
        Equations {
            gram,
            right,
            noise,
            weight,
        }
    }

    /// Solves with the roughness of the curvature weighed as the evidence says.
    ///
    /// Roughness is the sum of squared third differences of the coefficients: a curvature that is a parabola along the
    /// strip costs nothing. Its weight is the one under which the readings are likeliest.
    pub fn solve(&self, curve: &Curve) -> Solution {
        let roughness = roughness();
        let size = |matrix: &Symmetric| (2..PARAMETERS).map(|k| matrix.get(k, k)).sum::<f64>();
        let unit = size(&self.gram) / size(&roughness).max(f64::MIN_POSITIVE);
        let rank = (COEFFICIENTS - ORDER) as f64;
        let now: Vec<f64> = [0.0, 0.0]
            .iter()
            .chain(&curve.curvature.coefficients)
            .copied()
            .collect();
        let pull: Vec<f64> = (0..PARAMETERS)
            .map(|row| product(&roughness, row, &now))
            .collect();
        let mut best: Option<(f64, Symmetric, Vec<f64>)> = None;
        for half_decades in -24..=10 {
            let weight = unit * 10f64.powf(0.5 * f64::from(half_decades));
            let mut matrix = self.gram.clone();
            for i in 2..PARAMETERS {
                for j in i.saturating_sub(ORDER).max(2)..(i + ORDER + 1).min(PARAMETERS) {
                    matrix.add(i, j, weight * roughness.get(i, j));
                }
            }
            let right: Vec<f64> = self
                .right
                .iter()
                .zip(&pull)
                .map(|(r, p)| r - weight * p)
                .collect();
            let change = matrix.solve(&right, 1e-14);
            let then: Vec<f64> = now.iter().zip(&change).map(|(a, b)| a + b).collect();
            let gained: f64 = (0..PARAMETERS)
                .map(|row| change[row] * (2.0 * self.right[row] - product(&self.gram, row, &change)))
                .sum();
            let penalty = weight * roughness.form(&then, &then);
            let evidence = 0.5 * (gained - penalty + rank * weight.ln() - matrix.log_determinant());
            if best.as_ref().is_none_or(|best| evidence > best.0) {
                best = Some((evidence, matrix, change));
            }
        }
        let Some((_, matrix, change)) = best else {
            return Solution {
                change: vec![0.0; PARAMETERS],
                covariance: Symmetric::zero(PARAMETERS),
                bandwidth: curve.length,
            };
        };
        let covariance = matrix.inverse(1e-14);
        let free: f64 = (2..PARAMETERS)
            .map(|i| {
                (0..PARAMETERS)
                    .map(|j| covariance.get(i, j) * self.gram.get(j, i))
                    .sum::<f64>()
            })
            .sum();
        Solution {
            change,
            covariance,
            bandwidth: curve.length / free.max(1.0),
        }
    }
}

fn product(matrix: &Symmetric, row: usize, x: &[f64]) -> f64 {
    x.iter().enumerate().map(|(k, x)| matrix.get(row, k) * x).sum()
}

/// The readings' own smooth course: their medians over stretches of `window` places, joined by straight lines.
///
/// What is left of the readings beside it is noise, however far the curve still is from the strip.
fn course(edges: &Edges, window: usize) -> Vec<f64> {
    let n = edges.width.len();
    let window = window.max(8);
    let mut room = Vec::new();
    let nodes: Vec<(f64, f64)> = (0..=n / window)
        .filter_map(|part| {
            let middle = part * window;
            let range = middle.saturating_sub(window / 2)..(middle + window / 2 + 1).min(n);
            room.clear();
            room.extend(edges.middle.iter().flat_map(|side| {
                range
                    .clone()
                    .filter_map(|k| side[k].filter(|_| !edges.doubtful[k]))
            }));
            let at = 0.5 * (range.start + range.end) as f64 - 0.5;
            (!room.is_empty()).then(|| (at, median(&mut room)))
        })
        .collect();
    let mut next = 0;
    (0..n)
        .map(|k| {
            while next + 2 < nodes.len() && nodes[next + 1].0 < k as f64 {
                next += 1;
            }
            match (nodes.get(next), nodes.get(next + 1)) {
                (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (k as f64 - a.0) / (b.0 - a.0),
                (Some(a), None) => a.1,
                _ => 0.0,
            }
        })
        .collect()
}

/// Places at either end whose normals may meet the clamp or the corner of the tip.
fn end_margin(edges: &Edges, n: usize) -> usize {
    let width = edges.width.first().copied().unwrap_or(0.0);
    ((0.25 * width + 2.0) as usize).min(n / 8)
}

/// Sum of the correlations of neighbouring residuals, at least 1: blur and the strip's own roughness make readings
/// that stand near each other alike.
fn memory(readings: &[(f64, f64)], course: &[f64]) -> f64 {
    let residual: Vec<f64> = readings
        .iter()
        .zip(course)
        .map(|((w, sum), course)| if *w > 0.0 { sum / w - course } else { 0.0 })
        .collect();
    let square: f64 = residual.iter().map(|r| r * r).sum();
    if square <= 0.0 {
        return 1.0;
    }
    let mut sum = 1.0;
    for lag in 1..=LONGEST_LAG.min(residual.len().saturating_sub(1)) {
        let product: f64 = residual.iter().zip(&residual[lag..]).map(|(a, b)| a * b).sum();
        if product < 0.05 * square {
            break;
        }
        sum += 2.0 * product / square;
    }
    sum
}

/// Products of third differences of the coefficients.
fn roughness() -> Symmetric {
    let mut matrix = Symmetric::zero(PARAMETERS);
    for first in 0..COEFFICIENTS - ORDER {
        let difference = [1.0, -3.0, 3.0, -1.0];
        for (i, a) in difference.iter().enumerate() {
            for (j, b) in difference.iter().enumerate() {
                matrix.add(2 + first + i, 2 + first + j, a * b);
            }
        }
    }
    matrix
}
