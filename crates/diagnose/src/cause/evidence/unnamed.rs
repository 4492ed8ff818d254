//! What has no name: a smooth answer to every step of the voltage, or what wanders with the clock.

use super::policy::{KNOTS_BY_CLOCK, MOST_BY_CLOCK, SIZES, WAVES, grid};
use super::smooth::{Column, Knots, Process, shared_since_edge};
use crate::fitting::tangent::Tangent;
use crate::readings::group::RunGroup;
use ieap_domain::Level;
use ieap_numerics::sums::mean;

/// Hypotheses without a name beside which every effect is held, as columns that do not depend on the model.
pub(crate) struct Nameless {
    /// A smooth answer to every step; what wanders with the clock.
    unnamed: [Vec<Column>; 2],
    slow_noise: Vec<Column>,
}

impl Nameless {
    pub(crate) fn of(group: &RunGroup) -> Nameless {
        Nameless {
            unnamed: [answers(group), wandering(group)],
            slow_noise: slow(group),
        }
    }
}

/// What a process without a name makes the logarithm of the likelihood rise by, what its widths cost, and how many columns it has.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Parts {
    pub(crate) fall: f64,
    pub(crate) occam: f64,
    pub(crate) free: usize,
}

impl Nameless {
    /// The more probable of what has no name.
    pub(crate) fn unnamed_parts(&self, tangent: &Tangent, left: &[f64]) -> Parts {
        let each = self
            .unnamed
            .each_ref()
            .map(|columns| parts(columns, tangent, left));
        let log = |own: &Parts| own.fall + own.occam;
        let [answers, wandering] = each;
        if log(&answers) > log(&wandering) {
            answers
        } else {
            wandering
        }
    }

    /// Of slow noise.
    pub(crate) fn slow_parts(&self, tangent: &Tangent, left: &[f64]) -> Parts {
        parts(&self.slow_noise, tangent, left)
    }
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

/// One answer for all runs, by the voltage that is on: a column for each knot since the edge, of current and curvature.
fn answers(group: &RunGroup) -> Vec<Column> {
    let piece = |place: usize, weights: &[f64]| {
        let steps = step_v(group, place);
        whitened(
            group,
            place,
            weights.iter().zip(&steps).map(|(w, v)| w * v).collect(),
        )
    };
    (0..2)
        .flat_map(|channel| shared_since_edge(group, channel, piece))
        .collect()
}

/// Size of the last step of the voltage at every reading of a block, V; 0 before the first. Of a voltage that moves all the
/// time the voltage itself: it has gone there from rest.
fn step_v(group: &RunGroup, place: usize) -> Vec<f64> {
    let block = &group.blocks[place];
    let run = &group.runs[block.run];
    let drive = run.drive();
    let mut steps: Vec<(f64, f64)> = Vec::new();
    let mut before_v = drive.baseline_v;
    let moves = drive.moves();
    for segment in &drive.segments {
        if let Level::Voltage(v) = segment.level {
            steps.push((segment.start_s(), v - before_v));
            if !moves {
                before_v = v;
            }
        }
    }
    let last = |t: &f64| {
        let found = steps.iter().rev().find(|(start_s, _)| start_s <= t);
        found.map_or(0.0, |(_, v)| *v)
    };
    run.times(block.channel).iter().map(last).collect()
}

/// Every channel of every run by itself: a smooth course over the clock.
fn wandering(group: &RunGroup) -> Vec<Column> {
    let count = (MOST_BY_CLOCK / group.blocks.len().max(1)).clamp(2, KNOTS_BY_CLOCK);
    let of_block = |place: usize| Knots::by_clock(group, place, count).weights;
    let blocks = 0..group.blocks.len();
    blocks
        .flat_map(|place| {
            let each = of_block(place).into_iter();
            each.map(move |weights| Column::of(vec![whitened(group, place, weights)]))
                .collect::<Vec<_>>()
        })
        .collect()
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
