//! Slow noise, at rest as under voltage: waves of every channel of every run.

use super::policy::{MOST_BY_CLOCK, SIZES, WAVES, grid};
use super::smooth::{Column, Process};
use crate::fitting::tangent::Tangent;
use crate::readings::group::RunGroup;
use ieap_numerics::sums::mean;

/// What a process makes the logarithm of the likelihood rise by, what its widths cost, and how many columns it has.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Parts {
    pub(crate) fall: f64,
    pub(crate) occam: f64,
    pub(crate) free: usize,
}

/// What slow noise explains of what is left, its size whichever is most probable.
pub(crate) fn slow_noise(group: &RunGroup, tangent: &Tangent, left: &[f64]) -> Parts {
    parts(&slow(group), tangent, left)
}

fn parts(columns: &[Column], tangent: &Tangent, left: &[f64]) -> Parts {
    let Some(process) = Process::of(columns, tangent, left).of_unit_size() else {
        return Parts::default();
    };
    let best = grid(SIZES)
        .map(|size| process.parts(size))
        .max_by(|a, b| (a.0 + a.1).total_cmp(&(b.0 + b.1)));
    let (fall, occam) = best.unwrap_or_default();
    Parts {
        fall,
        occam,
        free: columns.len(),
    }
}

/// Whitened pieces of a block from a series in units of its noise.
fn whitened(group: &RunGroup, place: usize, mut series: Vec<f64>) -> (usize, Vec<f64>) {
    let block = &group.blocks[place];
    if let Some(channel) = group.channel(block) {
        let size = mean(channel.standard_deviation());
        series.iter_mut().for_each(|v| *v *= size);
        channel.whiten(&mut series);
    }
    (block.first, series)
}

/// Every channel of every run by itself: waves of the record's length and shorter, the slower the larger.
fn slow(group: &RunGroup) -> Vec<Column> {
    let count = (MOST_BY_CLOCK / group.blocks.len().max(1)).clamp(2, WAVES);
    let mut columns = Vec::new();
    for (place, block) in group.blocks.iter().enumerate() {
        let rows = block.end - block.first;
        for wave in 1..=count {
            let turn = std::f64::consts::PI * wave as f64 / rows as f64;
            let series = (0..rows).map(|k| (turn * (k as f64 + 0.5)).cos() / wave as f64);
            columns.push(Column::of(vec![whitened(group, place, series.collect())]));
        }
    }
    columns
}
