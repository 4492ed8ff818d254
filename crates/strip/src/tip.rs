//! Where the strip ends.

use super::curve::Curve;
use super::edges::{COVERED, Edges, MARGIN, OUTER, SPACING};
use super::gray::Gray;
use super::ground::{Ground, biweight, median};
use ieap_numerics::robust::sd_about_median;
use ieap_numerics::sums::mean;
use ieap_numerics::symmetric::Symmetric;

/// No end is known better than this, pixels.
const LEAST_ERROR: f64 = 0.01;

/// Where the strip ends: arc length of the tip beyond the curve's end, and its standard error, both in pixels. None
/// where no end is seen.
///
/// Where the end is frayed or something lies at it, the lanes in which the strip's level falls cleanly are few; the
/// places where it falls to half are taken then, with an error of their own.
pub fn tip(gray: &Gray, ground: &Ground, curve: &Curve, edges: &Edges) -> Option<(f64, f64)> {
    const LANES: usize = 9;
    let last = curve.places() - 1;
    let (inside, width) = (*edges.inside.get(last)?, edges.width_at_tip);
    let reach = 1.2 * width + 2.0 * MARGIN;
    let count = (reach / SPACING).ceil() as i64;
    let (mut clean, mut half) = (Vec::with_capacity(LANES), Vec::with_capacity(LANES));
    for lane in 0..LANES {
        let n = 0.6 * width * (lane as f64 / (LANES - 1) as f64 - 0.5);
        let level = |k: i64| {
            // Along the curve up to its end, straight on beyond it.
            let s = curve.length + k as f64 * SPACING;
            let (x, y) = curve.point_at(s);
            let (nx, ny) = curve.normal(((s / curve.step()).max(0.0) as usize).min(last));
            ground.level_at(gray, x + n * nx, y + n * ny)
        };
        let levels: Vec<f64> = (-count..=count).map(level).collect();
        let Some(crossing) = falls(&levels, 0.5 * inside) else {
            continue;
        };
        half.push((crossing as f64 - 0.5 - count as f64) * SPACING);
        clean.extend(clean_end(&levels, crossing, inside).map(|end| (n, (end - count as f64) * SPACING)));
    }
    let middle = |ends: &[f64]| median(&mut ends.to_vec());
    let error = |ends: &[f64]| 1.25 * sd_about_median(ends) / (ends.len() as f64).sqrt();
    if clean.len() >= LANES / 2 {
        return Some(foremost(&clean, 0.3 * width));
    }
    (half.len() > LANES / 2).then(|| (middle(&half), error(&half).max(0.15 * width)))
}

/// End of the middle lane, with its standard error, from the ends of all of them: a round or slanted end is a parabola
/// across the strip. Where lanes are missing on one side it is their median.
fn foremost(ends: &[(f64, f64)], reach: f64) -> (f64, f64) {
    let along: Vec<f64> = ends.iter().map(|end| end.1).collect();
    let n = ends.len() as f64;
    let level = median(&mut along.clone());
    let plain = (
        level,
        (1.25 * sd_about_median(&along) / n.sqrt()).max(LEAST_ERROR),
    );
    let sided = |sign: f64| ends.iter().filter(|end| sign * end.0 > 0.3 * reach).count();
    if sided(1.0).min(sided(-1.0)) < 2 || ends.len() < 6 {
        return plain;
    }
    let row = |n: f64| [1.0, n / reach, (n / reach).powi(2)];
    let mut terms = vec![level, 0.0, 0.0];
    let mut error = plain.1;
    for _ in 0..6 {
        let off: Vec<f64> = ends
            .iter()
            .map(|end| end.1 - row(end.0).iter().zip(&terms).map(|(a, b)| a * b).sum::<f64>())
            .collect();
        let scale = sd_about_median(&off).max(LEAST_ERROR);
        let mut normal = Symmetric::zero(3);
        let mut right = [0.0; 3];
        for (end, off) in ends.iter().zip(&off) {
            let (weight, row) = (biweight(off / (5.0 * scale)), row(end.0));
            for i in 0..3 {
                right[i] += weight * row[i] * end.1;
                (0..3).for_each(|j| normal.add(i, j, weight * row[i] * row[j]));
            }
        }
        terms = normal.solve(&right, 1e-9);
        error = scale * normal.inverse(1e-9).error(0);
    }
    if (terms[0] - level).abs() < 1.5 * reach {
        (terms[0], error.max(LEAST_ERROR))
    } else {
        plain
    }
}

/// The first reading below a level after one above it, with at least the blur's width below it thereafter.
fn falls(levels: &[f64], to: f64) -> Option<usize> {
    let gone = (1.5 * MARGIN / SPACING) as usize;
    let begun = levels.iter().position(|level| *level > to)?;
    (begun..levels.len()).find(|&k| {
        levels[k..(k + gone).min(levels.len())]
            .iter()
            .all(|level| *level <= to)
    })
}

/// End of the strip in a lane, in readings, from the light that is missing up to it; none where it does not fall
/// from the strip's level to the ground's within the blur.
fn clean_end(levels: &[f64], crossing: usize, inside: f64) -> Option<f64> {
    let from = crossing.saturating_sub((MARGIN / SPACING) as usize);
    let to = (crossing + (MARGIN / SPACING) as usize).min(levels.len() - 1);
    let ground_there = mean(&levels[to.saturating_sub(OUTER)..=to]);
    // The strip's own level just before its end, for light is uneven along it, too.
    let strip_there = mean(&levels[from.saturating_sub(OUTER)..=from]);
    let contrast = strip_there - ground_there;
    let like_strip = (strip_there - inside).abs() <= COVERED * inside;
    if contrast < 0.5 * inside || !like_strip || ground_there > COVERED * inside {
        return None;
    }
    let excess: f64 = levels[from..=to].iter().map(|level| level - ground_there).sum();
    // A reading stands for half its spacing to either side.
    Some(from as f64 - 0.5 + excess / contrast)
}
