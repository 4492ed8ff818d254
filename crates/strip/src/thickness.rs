//! The strip's thickness along its length, and where what is seen of its edges does not agree with it.
//!
//! A strip is as thick everywhere, or thins evenly as a camera sees it that looks a little along it. Where it looks
//! thinner or thicker for a stretch, something else is seen at one of its edges: a shine that hides it, a mirror image
//! beside it. The middle between both edges is not the strip's middle there.

use super::ground::{biweight, median};
use ieap_numerics::robust::sd_about_median;

/// Places to either side whose median is looked at: what persists counts, a single reading does not.
const PERSISTS: usize = 4;
/// Places about a doubtful stretch that are doubtful as well: blur carries it there.
const FRINGE: usize = 5;
/// Standard deviations by which a stretch must differ, and pixels in addition.
const DIFFERS: (f64, f64) = (4.0, 0.08);
/// Stretches whose medians lines are drawn through.
const STRETCHES: usize = 12;
/// Change of the thickness along the strip at most, as a share of it.
const MOST_TAPER: f64 = 0.5;
/// Where more places than this share differ, the thickness is no straight line and tells nothing.
const MOST_DIFFERENT: f64 = 0.45;

/// Value at the start and change over the whole length of the straight line that most thicknesses follow.
///
/// Lines through the medians of any two of some stretches are compared by the places that lie on them: half the strip may
/// be something else, also at an end, where it would tilt a line that is fitted to all.
fn straight(smooth: &[f64], noise: f64) -> Option<(f64, f64)> {
    let n = smooth.len();
    let part = n.div_ceil(STRETCHES);
    let medians: Vec<(f64, f64)> = smooth
        .chunks(part)
        .enumerate()
        .filter_map(|(k, chunk)| {
            let mut seen: Vec<f64> = chunk.iter().copied().filter(|value| value.is_finite()).collect();
            let middle = (k * part) as f64 + 0.5 * (chunk.len() as f64 - 1.0);
            (2 * seen.len() > chunk.len()).then(|| (middle / (n - 1) as f64, median(&mut seen)))
        })
        .collect();
    let reach = 2.5 * noise + DIFFERS.1;
    let on_line = |(start, change): (f64, f64)| {
        let off = |k: usize| smooth[k] - start - change * k as f64 / (n - 1) as f64;
        (0..n)
            .filter(|&k| smooth[k].is_finite())
            .map(|k| biweight(off(k) / reach))
            .sum::<f64>()
    };
    let mut best: Option<(f64, (f64, f64))> = None;
    for (k, from) in medians.iter().enumerate() {
        for to in &medians[k..] {
            let slope = if to.0 > from.0 {
                (to.1 - from.1) / (to.0 - from.0)
            } else {
                0.0
            };
            let line = (from.1 - slope * from.0, slope);
            let count = on_line(line);
            if slope.abs() <= MOST_TAPER * from.1.max(to.1) && best.is_none_or(|best| count > best.0) {
                best = Some((count, line));
            }
        }
    }
    best.map(|(_, line)| line)
}

/// For each place, whether the thickness there differs from the straight line that most places follow.
///
/// `thickness` is NaN where not both edges are seen.
pub fn doubtful(thickness: &[f64]) -> Vec<bool> {
    let n = thickness.len();
    let none = vec![false; n];
    let mut room = Vec::with_capacity(2 * PERSISTS + 1);
    let smooth: Vec<f64> = (0..n)
        .map(|k| {
            let range = k.saturating_sub(PERSISTS)..(k + PERSISTS + 1).min(n);
            room.clear();
            room.extend(thickness[range].iter().copied().filter(|value| value.is_finite()));
            if room.is_empty() {
                f64::NAN
            } else {
                median(&mut room)
            }
        })
        .collect();
    // What the thickness does from one stretch of that length to the next is noise.
    let steps: Vec<f64> = (2 * PERSISTS + 1..n)
        .map(|k| (smooth[k] - smooth[k - 2 * PERSISTS - 1]) / 2f64.sqrt())
        .filter(|step| step.is_finite())
        .collect();
    let Some((start, change)) = straight(&smooth, sd_about_median(&steps)) else {
        return none;
    };
    let off: Vec<f64> = (0..n)
        .map(|k| smooth[k] - start - change * k as f64 / (n - 1) as f64)
        .collect();
    let seen: Vec<f64> = off.iter().copied().filter(|off| off.is_finite()).collect();
    let allowed = DIFFERS.0 * sd_about_median(&seen) + DIFFERS.1;
    let different: Vec<usize> = (0..n).filter(|&k| off[k].abs() > allowed).collect();
    if different.len() as f64 > MOST_DIFFERENT * seen.len() as f64 {
        return none;
    }
    let mut doubtful = none;
    for k in different {
        doubtful[k.saturating_sub(FRINGE)..(k + FRINGE + 1).min(n)].fill(true);
    }
    doubtful
}
