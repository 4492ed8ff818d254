//! Bins of time over which residuals are averaged: where the simulation is wrong, whatever the cause.

use ieap_domain::{Drive, Level, range_of};
use ieap_numerics::sums::dot;

use crate::fitting::fitted::Fitted;
use crate::misfit::policy::{
    BINS_BY_CLOCK, BINS_BY_PHASE, FEWEST_EDGES, FEWEST_OF_BIN, MOST_EDGE_RESPONSES, SAME_LEVEL_V,
};
use crate::readings::group::{Block, RunGroup};

/// Which rows belong together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// Those between two times, s since the start of the drive.
    Clock(f64, f64),
    /// Those as long after every edge to the same level; of a moving voltage those in the same part of its course.
    Phase,
    /// The answer to one edge, or to some that follow one another.
    EdgeResponse,
}

/// Rows of one channel of one run that are averaged.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ResidualBin {
    pub(crate) kind: Kind,
    pub(crate) block: usize,
    pub(crate) rows: Vec<usize>,
    /// Weight of every row; their squares sum to one.
    pub(crate) weights: Vec<f64>,
}

impl ResidualBin {
    /// All rows alike.
    fn even(kind: Kind, block: usize, rows: Vec<usize>) -> ResidualBin {
        let weights = vec![(rows.len() as f64).sqrt().recip(); rows.len()];
        ResidualBin {
            kind,
            block,
            rows,
            weights,
        }
    }

    /// Weighted sum of a series over the rows.
    pub(crate) fn over(&self, series: &[f64]) -> f64 {
        let each = self.rows.iter().zip(&self.weights);
        each.map(|(&row, weight)| weight * series[row]).sum()
    }
}

/// Bins of every channel of every run; then how much each run answers to each of many edges, by the shape in which
/// the fitted current follows the resistances and the fitted curvature its size.
pub(crate) fn residual_bins(group: &RunGroup, base: &Fitted) -> Vec<ResidualBin> {
    let mut found = Vec::new();
    for (place, block) in group.blocks.iter().enumerate() {
        of_block(group, place, block, &mut found);
    }
    let shapes = base.problem.edge_shapes(&base.at);
    for (place, block) in group.blocks.iter().enumerate() {
        found.extend(edge_responses(group, place, block, &shapes[block.channel]));
    }
    found
}

fn edge_responses(group: &RunGroup, place: usize, block: &Block, shape: &[f64]) -> Vec<ResidualBin> {
    let run = &group.runs[block.run];
    let segments = &run.drive().segments;
    if segments.len() < FEWEST_EDGES {
        return Vec::new();
    }
    let times = run.times(block.channel);
    let together = segments.len().div_ceil(MOST_EDGE_RESPONSES);
    let row_at = |time_s: f64| block.first + times.partition_point(|&t| t < time_s);
    let starts: Vec<usize> = segments
        .chunks(together)
        .map(|some| row_at(some[0].start_s()))
        .chain([block.end])
        .collect();
    let of = |ends: &[usize]| {
        let rows: Vec<usize> = (ends[0]..ends[1]).collect();
        let norm = dot(&shape[ends[0]..ends[1]], &shape[ends[0]..ends[1]]).sqrt();
        (norm > 0.0 && norm.is_finite()).then(|| ResidualBin {
            kind: Kind::EdgeResponse,
            block: place,
            weights: rows.iter().map(|&row| shape[row] / norm).collect(),
            rows,
        })
    };
    starts.windows(2).filter_map(of).collect()
}

fn of_block(group: &RunGroup, place: usize, block: &Block, found: &mut Vec<ResidualBin>) {
    let run = &group.runs[block.run];
    let drive = run.drive();
    let start_s = drive.segments.first().map_or(0.0, |segment| segment.start_s());
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
    let courses = drive.moves().then(|| courses(drive));
    let mut clock: Vec<Vec<usize>> = vec![Vec::new(); BINS_BY_CLOCK + 1];
    let mut phase: Vec<Vec<usize>> = vec![Vec::new(); BINS_BY_PHASE * levels.len().max(1)];
    for (k, &t) in times.iter().enumerate() {
        let row = block.first + k;
        let Some(last) = drive
            .segments
            .partition_point(|segment| segment.start_s() <= t)
            .checked_sub(1)
        else {
            clock[BINS_BY_CLOCK].push(row);
            continue;
        };
        let segment = &drive.segments[last];
        clock[logarithmic(t - start_s, BINS_BY_CLOCK)].push(row);
        if let Some(courses) = &courses {
            phase[courses[last]].push(row);
            continue;
        }
        let level = levels
            .iter()
            .position(|level| same(*level, segment.level))
            .unwrap_or(0);
        if levels.len() > 1 {
            phase[level * BINS_BY_PHASE + logarithmic(t - segment.start_s(), BINS_BY_PHASE)].push(row);
        }
    }
    let at = |row: usize| times[row - block.first] - start_s;
    for rows in clock.into_iter().filter(|rows| rows.len() >= FEWEST_OF_BIN) {
        let kind = Kind::Clock(at(rows[0]), at(rows[rows.len() - 1]));
        found.push(ResidualBin::even(kind, place, rows));
    }
    for rows in phase.into_iter().filter(|rows| rows.len() >= FEWEST_OF_BIN) {
        found.push(ResidualBin::even(Kind::Phase, place, rows));
    }
}

fn same(left: Level, right: Level) -> bool {
    match (left, right) {
        (Level::Voltage(a), Level::Voltage(b)) => (a - b).abs() < SAME_LEVEL_V,
        (left, right) => left == right,
    }
}

/// Which part of its course a moving voltage is in at every segment: below or above the middle of its range, falling or rising.
fn courses(drive: &Drive) -> Vec<usize> {
    let mut last_v = drive.baseline_v;
    let held = drive.segments.iter().map(|segment| {
        if let Level::Voltage(volts) = segment.level {
            last_v = volts;
        }
        last_v
    });
    let levels_v: Vec<f64> = std::iter::once(drive.baseline_v).chain(held).collect();
    let (low, high) = range_of(levels_v.iter().copied());
    let of = |pair: &[f64]| 2 * usize::from(pair[1] > 0.5 * (low + high)) + usize::from(pair[1] > pair[0]);
    levels_v.windows(2).map(of).collect()
}

/// Different levels of a run's drive.
fn levels(group: &RunGroup, block: &Block) -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    for segment in &group.runs[block.run].drive().segments {
        if levels.len() < 4 && !levels.iter().any(|level| same(*level, segment.level)) {
            levels.push(segment.level);
        }
    }
    levels
}
