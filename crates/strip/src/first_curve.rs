//! A curve through the rough centres of the walk, from which the search for the line starts.

use super::curve::Curve;
use super::march::Rough;
use super::silhouette::Root;
use super::spline::{COEFFICIENTS, Spline};
use ieap_numerics::symmetric::Symmetric;

/// A curve through the rough centres: their directions, smoothed by the same spline.
pub fn first_curve(root: &Root, rough: &Rough) -> Curve {
    let centres = &evened(&rough.centres);
    // Directions over a few steps, each at the arc length of its middle; turns are unwound.
    let reach = 3.min(centres.len() - 1);
    let mut along = vec![0.0];
    for pair in centres.windows(2) {
        along.push(along[along.len() - 1] + (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1));
    }
    let length = along[along.len() - 1];
    let mut readings: Vec<(f64, f64)> = Vec::new();
    for k in 0..centres.len() - reach {
        let ((x0, y0), (x1, y1)) = (centres[k], centres[k + reach]);
        let mut angle = (y1 - y0).atan2(x1 - x0);
        if let Some((_, before)) = readings.last() {
            angle -= ((angle - before) / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        }
        readings.push((0.5 * (along[k] + along[k + reach]), angle));
    }
    // The walk ends within a thickness of the tip.
    let (angle_rad, curvature) = spline_of_angles(&readings, length + rough.width);
    let line = root.side.along();
    Curve::new(root.at, line, angle_rad, curvature, length)
}

/// Centres without their jitter, which would add to the length.
fn evened(centres: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let n = centres.len();
    (0..n)
        .map(|k| {
            let reach = 4.min(k).min(n - 1 - k);
            let part = &centres[k - reach..=k + reach];
            let count = part.len() as f64;
            (
                part.iter().map(|centre| centre.0).sum::<f64>() / count,
                part.iter().map(|centre| centre.1).sum::<f64>() / count,
            )
        })
        .collect()
}

/// Angle at the start and curvature whose integral fits angles along the strip.
fn spline_of_angles(readings: &[(f64, f64)], length: f64) -> (f64, Spline) {
    let mut spline = Spline::straight(length);
    let mut normal = Symmetric::zero(1 + COEFFICIENTS);
    let mut right = vec![0.0; 1 + COEFFICIENTS];
    let step = length / 400.0;
    let (mut s, mut turned) = (0.0, [0.0; COEFFICIENTS]);
    for (at, angle) in readings {
        while s < *at {
            let (first, weights) = spline.weights(s + 0.5 * step);
            weights
                .iter()
                .enumerate()
                .for_each(|(j, w)| turned[first + j] += step * w);
            s += step;
        }
        let row: Vec<f64> = std::iter::once(1.0).chain(turned).collect();
        for i in 0..row.len() {
            right[i] += row[i] * angle;
            for j in 0..row.len() {
                normal.add(i, j, row[i] * row[j]);
            }
        }
    }
    // Enough roughness penalty that noise of a tenth of a radian does not bend the line.
    let unit = 0.3 * (length / 20.0).powi(2);
    for first in 1..COEFFICIENTS - 1 {
        let difference = [1.0, -2.0, 1.0];
        for (i, a) in difference.iter().enumerate() {
            for (j, b) in difference.iter().enumerate() {
                normal.add(first + i, first + j, unit * a * b);
            }
        }
    }
    let solved = normal.solve(&right, 1e-12);
    spline.coefficients.copy_from_slice(&solved[1..]);
    (solved[0], spline)
}
