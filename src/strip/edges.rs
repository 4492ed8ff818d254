//! Edges of the strip along the normals of its centre line, to a fraction of a pixel.
//!
//! An edge lies where the light that is missing (or added) beyond the strip's middle would end if it ended sharply:
//! levels are summed along the normal and divided by the strip's own level. The sum is the same wherever an edge falls
//! within a pixel and however blurred it is, which a crossing of half the level is not.

use super::curve::Curve;
use super::gray::Gray;
use super::ground::{Ground, median};

/// Distance between readings along a normal, pixels.
const SPACING: f64 = 0.5;
/// How far beyond its expected edge the strip is looked at, pixels: blur must have ended there.
const MARGIN: f64 = 5.0;
/// Readings at either end of a normal that give the ground there.
const OUTER: usize = 5;
/// Stretch, as a share of the length, over which thickness and levels are taken for steady.
const STEADY: f64 = 0.08;
/// The middle's level may differ by this share before something lies before the strip, or it is not there.
const COVERED: f64 = 0.3;

/// What is measured at places along the strip, a pixel or so apart.
#[derive(Debug, Clone, Default)]
pub struct Edges {
    /// Offset of the strip's middle from the curve, by the edge to either side; none where that edge is not seen.
    pub middle: [Vec<Option<f64>>; 2],
    /// Thickness, pixels.
    pub width: Vec<f64>,
    /// Level of the strip's middle.
    pub inside: Vec<f64>,
    /// Thickness just before the tip, pixels.
    pub width_at_tip: f64,
}

/// Measures the edges at every place of the curve; `width` is the thickness expected.
pub fn measure(gray: &Gray, ground: &Ground, curve: &Curve, width: &[f64]) -> Edges {
    let n = curve.places();
    let reach: Vec<f64> = width.iter().map(|w| 0.5 * w.max(1.0) + MARGIN).collect();
    let count = |k: usize| (reach[k] / SPACING).ceil() as usize;
    let mut profiles: Vec<Vec<f64>> = Vec::with_capacity(n);
    let mut centre = Vec::with_capacity(n);
    let mut outer = [Vec::with_capacity(n), Vec::with_capacity(n)];
    for (k, expected) in width.iter().enumerate().take(n) {
        let half = count(k);
        let ((x, y), (nx, ny)) = (curve.point(k), curve.normal(k));
        let level = |i: usize| {
            let offset = (i as f64 - half as f64) * SPACING;
            ground.level_at(gray, x + offset * nx, y + offset * ny)
        };
        let profile: Vec<f64> = (0..=2 * half).map(level).collect();
        let core = ((0.15 * expected / SPACING) as usize).max(1).min(half);
        let middle = &profile[half - core..=half + core];
        centre.push(middle.iter().sum::<f64>() / middle.len() as f64);
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        outer[0].push(mean(&profile[..OUTER]));
        outer[1].push(mean(&profile[profile.len() - OUTER..]));
        profiles.push(profile);
    }
    let window = ((STEADY * n as f64) as usize).max(12);
    let inside = running_median(&centre, window);
    let grounds = [
        running_median(&outer[0], window),
        running_median(&outer[1], window),
    ];
    let mut distances = [Vec::with_capacity(n), Vec::with_capacity(n)];
    for (k, profile) in profiles.iter().enumerate() {
        let half = count(k);
        let seen =
            (centre[k] - inside[k]).abs() < COVERED * inside[k].abs() && in_view(gray, curve, k, reach[k]);
        for side in 0..2 {
            let contrast = inside[k] - grounds[side][k];
            // Half of the middle reading belongs to either side.
            let sum: f64 = (1..=half)
                .map(|i| {
                    if side == 0 {
                        profile[half - i]
                    } else {
                        profile[half + i]
                    }
                })
                .sum::<f64>()
                + 0.5 * profile[half];
            let excess = sum - (half as f64 + 0.5) * grounds[side][k];
            let is_seen = seen && contrast > 0.25 * inside[k].abs();
            distances[side].push(is_seen.then(|| excess * SPACING / contrast));
        }
    }
    let [low, high] = distances;
    let both: Vec<f64> = low
        .iter()
        .zip(&high)
        .map(|(low, high)| low.zip(*high).map_or(f64::NAN, |(low, high)| low + high))
        .collect();
    let thickness = steady_thickness(&both, width, window);
    let near_tip = (2.0 * width[n - 1]) as usize + 8;
    let mut last: Vec<f64> = both[n.saturating_sub(near_tip)..]
        .iter()
        .copied()
        .filter(|width| width.is_finite())
        .collect();
    let width_at_tip = match last.is_empty() {
        true => thickness[n - 1],
        false => median(&mut last),
    };
    let middle = |distance: &[Option<f64>], sign: f64| {
        distance
            .iter()
            .zip(&thickness)
            .map(|(distance, width)| distance.map(|d| sign * (d - 0.5 * width)))
            .collect()
    };
    Edges {
        middle: [middle(&low, -1.0), middle(&high, 1.0)],
        width: thickness,
        inside,
        width_at_tip,
    }
}

/// Whether the normal at a place lies in the picture.
fn in_view(gray: &Gray, curve: &Curve, k: usize, reach: f64) -> bool {
    let ((x, y), (nx, ny)) = (curve.point(k), curve.normal(k));
    [-reach, reach]
        .iter()
        .all(|n| gray.holds((x + n * nx, y + n * ny)))
}

/// Running median of the thickness where both edges are seen; elsewhere what was expected.
fn steady_thickness(both: &[f64], expected: &[f64], window: usize) -> Vec<f64> {
    if both.iter().all(|width| width.is_nan()) {
        return expected.to_vec();
    }
    running_median(both, 2 * window)
}

/// Median over `window` places to either side, found at every few places and straight between them; NaNs are left out.
fn running_median(values: &[f64], window: usize) -> Vec<f64> {
    let n = values.len();
    let step = (window / 4).max(1);
    let mut nodes: Vec<(usize, f64)> = Vec::new();
    let mut room = Vec::with_capacity(2 * window + 1);
    for at in (0..n).step_by(step).chain([n.saturating_sub(1)]) {
        room.clear();
        let part = &values[at.saturating_sub(window)..(at + window + 1).min(n)];
        room.extend(part.iter().copied().filter(|value| value.is_finite()));
        if !room.is_empty() {
            nodes.push((at, median(&mut room)));
        }
    }
    let mut next = 0;
    (0..n)
        .map(|k| {
            while next + 1 < nodes.len() && nodes[next].0 < k {
                next += 1;
            }
            let Some(&(to, high)) = nodes.get(next) else {
                return 0.0;
            };
            let (from, low) = nodes[next.saturating_sub(1)];
            match to > from && k < to && k > from {
                true => low + (high - low) * (k - from) as f64 / (to - from) as f64,
                false if k <= from => low,
                false => high,
            }
        })
        .collect()
}

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
        clean.extend(clean_end(&levels, crossing, inside).map(|end| (end - count as f64) * SPACING));
    }
    let middle = |ends: &[f64]| median(&mut ends.to_vec());
    let error = |ends: &[f64]| 1.25 * super::ground::scatter(ends) / (ends.len() as f64).sqrt();
    if clean.len() >= LANES / 2 {
        return Some((middle(&clean), error(&clean).max(0.01)));
    }
    (half.len() > LANES / 2).then(|| (middle(&half), error(&half).max(0.15 * width)))
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
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
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
