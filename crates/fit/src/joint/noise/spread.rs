//! Exponentials whose time constants are spread over a segment.

use ieap_numerics::decay::{BLOCK, Block, Decay};
use ieap_numerics::sums::add;

use crate::joint::policy::{CLOSEST_SHAPES_LOG, GONE_AT, MOST_SHAPES};

/// The rate of a constant, and those of exponentials that are spread over the segment.
pub(super) fn rates_per_s(elapsed_s: &[f64]) -> Vec<f64> {
    let spread = time_constants_s(elapsed_s, elapsed_s.len() / 8, MOST_SHAPES);
    let spread = spread.into_iter().map(f64::recip);
    std::iter::once(0.0).chain(spread).collect()
}

/// Adds `amplitude` times e^(-rate t).
pub(super) fn add_decay(
    amplitude: f64,
    rate_per_s: f64,
    blocks: &[Block],
    elapsed_s: &[f64],
    out: &mut [f64],
) {
    let (mut decay, mut own) = (Decay::new(rate_per_s), [0.0; BLOCK]);
    for block in blocks {
        if rate_per_s * elapsed_s[block.first] > GONE_AT {
            break;
        }
        decay.fill(block, elapsed_s, &mut own);
        add(&mut out[block.first..block.first + block.len], amplitude, &own);
    }
}

/// Time constants from the record's length down to the distance of readings, at most so many; none of too few readings.
pub(super) fn time_constants_s(elapsed_s: &[f64], count: usize, most: usize) -> Vec<f64> {
    let longest_s = elapsed_s.last().copied().unwrap_or(0.0);
    let step_s = elapsed_s
        .windows(3)
        .map(|three| (three[2] - three[0]) / 2.0)
        .fold(f64::INFINITY, f64::min);
    if elapsed_s.len() < 6 || longest_s <= 0.0 || step_s <= 0.0 {
        return Vec::new();
    }
    let (fast, slow) = ((step_s * 2.0).ln(), (longest_s / 1.5).ln());
    let room = ((slow - fast) / CLOSEST_SHAPES_LOG).max(0.0) as usize + 1;
    let count = count.min(room).clamp(2, most);
    let at = |k: usize| (slow + (fast - slow) * k as f64 / (count - 1) as f64).exp();
    (0..count).map(at).collect()
}
