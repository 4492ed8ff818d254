//! Stretches of time over which residuals are averaged: where the simulation is wrong, whatever the cause.

use crate::domain::Level;

use super::group::{Block, Group};

/// Stretches of the clock per run, and of the time since an edge per level of the drive.
const BY_CLOCK: usize = 8;
const BY_PHASE: usize = 4;
/// Readings that a stretch needs.
const FEWEST: usize = 4;

/// Rows of one channel of one run that are averaged.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stretch {
    pub(super) block: usize,
    pub(super) rows: Vec<usize>,
    /// First and last time, s since the start of the drive, for a stretch of the clock.
    pub(super) clock_s: Option<(f64, f64)>,
}

/// Stretches of every channel of every run.
pub(super) fn stretches(group: &Group) -> Vec<Stretch> {
    let mut found = Vec::new();
    for (place, block) in group.blocks.iter().enumerate() {
        of_block(group, place, block, &mut found);
    }
    found
}

fn of_block(group: &Group, place: usize, block: &Block, found: &mut Vec<Stretch>) {
    let run = &group.runs[block.run];
    let drive = run.given.input.drive;
    let start_s = drive.segments.first().map_or(0.0, |segment| segment.start_s);
    let times = run.times(block.channel);
    let shortest_s = times
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .fold(f64::INFINITY, f64::min);
    let span = ((run.duration_s - start_s) / shortest_s).max(2.0).ln();
    let logarithmic = |elapsed_s: f64, count: usize| {
        let part = (elapsed_s.max(shortest_s) / shortest_s).ln() / span;
        ((part * count as f64) as usize).min(count - 1)
    };
    let levels = levels(group, block);
    let mut clock: Vec<Vec<usize>> = vec![Vec::new(); BY_CLOCK + 1];
    let mut phase: Vec<Vec<usize>> = vec![Vec::new(); BY_PHASE * levels.len()];
    for (k, &t) in times.iter().enumerate() {
        let row = block.first + k;
        let Some(segment) = drive.segments.iter().rev().find(|segment| segment.start_s <= t) else {
            clock[BY_CLOCK].push(row);
            continue;
        };
        clock[logarithmic(t - start_s, BY_CLOCK)].push(row);
        let level = levels
            .iter()
            .position(|level| same(*level, segment.level))
            .unwrap_or(0);
        if levels.len() > 1 {
            phase[level * BY_PHASE + logarithmic(t - segment.start_s, BY_PHASE)].push(row);
        }
    }
    let at = |row: usize| times[row - block.first] - start_s;
    for rows in clock.into_iter().filter(|rows| rows.len() >= FEWEST) {
        let clock_s = Some((at(rows[0]), at(rows[rows.len() - 1])));
        found.push(Stretch {
            block: place,
            rows,
            clock_s,
        });
    }
    for rows in phase.into_iter().filter(|rows| rows.len() >= FEWEST) {
        found.push(Stretch {
            block: place,
            rows,
            clock_s: None,
        });
    }
}

fn same(left: Level, right: Level) -> bool {
    match (left, right) {
        (Level::Voltage(a), Level::Voltage(b)) => (a - b).abs() < 0.01,
        (left, right) => left == right,
    }
}

/// Different levels of a run's drive.
fn levels(group: &Group, block: &Block) -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    for segment in &group.runs[block.run].given.input.drive.segments {
        if levels.len() < 4 && !levels.iter().any(|level| same(*level, segment.level)) {
            levels.push(segment.level);
        }
    }
    levels
}
