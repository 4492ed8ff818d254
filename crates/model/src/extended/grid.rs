//! The times at which a run is stepped: the readings, or as many as are enough where they are dense, the edges of the
//! drive, and what lies between where a step would be too long.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use ieap_domain::Level;
use ieap_numerics::sums::peak;

use super::knots::{Places, enough};
use super::source::ramp_ends;
use super::system::{CameraClock, RunContext, System};

/// Steps after an edge begin at this part of the shortest time constant and may grow by this part of the time that
/// has passed since: the error of steps that hold coefficients at their middle stays below 2e-3 of what an effect changes.
const FIRST: f64 = 0.045;
const GROWTH: f64 = 0.07;
/// First step after an edge at least, as part of the record: no reading tells what is faster.
const FINEST: f64 = 1e-9;
/// How many times longer they may be while parameters are searched: the error is six times as large, and far below noise.
const SEARCHED: f64 = 2.5;
/// Points of an exposure's mean (the trapezoidal rule over this many intervals).
const EXPOSURE_POINTS: usize = 4;
/// Grids that are kept of a run: laws that ask for finer steps, or whose times move, stand beside those that do not.
const MOST_KNOWN: usize = 8;

/// What the times of a run's steps hang on.
#[derive(Debug, Clone, PartialEq)]
struct Asked {
    /// Times of the readings of current and of curvature, s.
    readings_s: [Vec<f64>; 2],
    start_s: f64,
    camera: CameraClock,
    /// Beginnings of all segments of the drive, and those after which steps are fine, s.
    segments_s: Vec<f64>,
    edges_s: Vec<f64>,
    /// Times at which a ramp of the source ends, and at which laws jump, s.
    ramp_ends_s: Vec<f64>,
    jumps_s: Vec<f64>,
    is_smooth: bool,
    /// First step after an edge, s, and growth of the steps; none where every step is exact.
    steps: Option<(f64, f64)>,
}

/// Times with what is read at them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    /// Increasing times, s.
    pub(super) time_s: Vec<f64>,
    /// Place in `time_s` of every current reading.
    pub(super) current: Places,
    /// Places whose mean is every curvature reading, `shares` each.
    pub(super) curvature: Places,
    /// Places per curvature reading.
    pub(super) shares: usize,
}

/// Grids that were made before and serve again where the same is asked: while parameters are searched the times stay.
#[derive(Debug, Default)]
pub struct Grids {
    known: Mutex<VecDeque<(Asked, Arc<Grid>)>>,
}

impl Grids {
    pub(super) fn of(
        &self,
        run: &RunContext,
        system: &System,
        current_s: &[f64],
        curvature_s: &[f64],
    ) -> Arc<Grid> {
        let asked = Asked::of(run, system, [current_s, curvature_s]);
        let known = |grids: &VecDeque<(Asked, Arc<Grid>)>| {
            let found = grids.iter().find(|(own, _)| *own == asked);
            found.map(|(_, grid)| grid.clone())
        };
        if let Some(grid) = known(&self.lock()) {
            return grid;
        }
        let grid = Arc::new(Grid::of(&asked));
        let mut grids = self.lock();
        grids.truncate(MOST_KNOWN - 1);
        grids.push_front((asked, grid.clone()));
        grid
    }

    fn lock(&self) -> MutexGuard<'_, VecDeque<(Asked, Arc<Grid>)>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Asked {
    fn of(run: &RunContext, system: &System, [current_s, curvature_s]: [&[f64]; 2]) -> Asked {
        let opens = (run.drive.segments.iter()).any(|segment| segment.level == Level::OpenCircuit);
        let steps = resolved_s(system, opens).map(|shortest_s| {
            let laws = system.laws.iter().map(|law| law.finer());
            let seen = system.observations.iter().map(|o| o.finer());
            let finer = laws.chain(seen).fold(1.0, f64::max);
            let (shortest_s, coarser) = run
                .resolved_s
                .map_or((shortest_s, 1.0), |held_s| (held_s, SEARCHED));
            let coarser = if opens { 1.0 } else { coarser };
            (FIRST * shortest_s * coarser / finer, GROWTH * coarser / finer)
        });
        let start_s = run.start_s();
        let jumps = system.laws.iter().filter_map(|law| law.jumps_at_s());
        Asked {
            readings_s: [current_s.to_vec(), curvature_s.to_vec()],
            start_s,
            camera: system.camera,
            segments_s: (run.drive.segments.iter())
                .map(|segment| segment.start_s())
                .collect(),
            edges_s: run.drive.edges_s(),
            ramp_ends_s: ramp_ends(run, system).collect(),
            jumps_s: jumps.map(|at_s| start_s + at_s).collect(),
            is_smooth: system.is_smooth(),
            steps,
        }
    }

    /// Times that are shown by the readings of curvature, `shares` each, s.
    fn seen_s(&self, shares: usize) -> Vec<f64> {
        let (camera, start_s) = (self.camera, self.start_s);
        let seen = |&t: &f64| {
            let shown_s = start_s + (t - start_s) * (1.0 + camera.rate_error) - camera.delay_s;
            let back = move |k: usize| shown_s - camera.exposure_s * (k as f64 + 0.5) / shares as f64;
            (0..shares)
                .rev()
                .map(move |k| if shares == 1 { shown_s } else { back(k) })
        };
        self.readings_s[1].iter().flat_map(seen).collect()
    }

    /// Times at which laws jump or a ramp of the source ends, within those of the run.
    fn jumps(&self, time_s: &[f64]) -> Vec<f64> {
        let (Some(&first), Some(&last)) = (time_s.first(), time_s.last()) else {
            return Vec::new();
        };
        let mut at: Vec<f64> = (self.jumps_s.iter().chain(&self.ramp_ends_s))
            .copied()
            .filter(|t| (first..=last).contains(t))
            .collect();
        at.sort_by(f64::total_cmp);
        at
    }
}

impl Grid {
    fn of(asked: &Asked) -> Grid {
        let shares = if asked.camera.exposure_s > 0.0 {
            EXPOSURE_POINTS
        } else {
            1
        };
        let seen_s = asked.seen_s(shares);
        let [current_s, _] = &asked.readings_s;
        let last_s = current_s
            .iter()
            .chain(&seen_s)
            .copied()
            .fold(asked.start_s, f64::max);
        let turns = asked.segments_s.iter().chain(&asked.ramp_ends_s);
        let mut time_s: Vec<f64> = current_s
            .iter()
            .chain(&seen_s)
            .copied()
            .chain(turns.copied().filter(|&t| t <= last_s))
            .collect();
        // Stable, for it goes along stretches that are sorted already.
        time_s.sort_by(f64::total_cmp);
        time_s.dedup();
        let bounds = merged(&asked.segments_s, &asked.jumps(&time_s));
        let few = asked
            .is_smooth
            .then(|| enough(&merged(&time_s, &asked.jumps(&time_s)), &bounds))
            .flatten();
        let is_thinned = few.is_some();
        time_s = few.unwrap_or(time_s);
        if let Some((first_s, growth)) = asked.steps {
            time_s = refined(&time_s, &asked.edges_s, first_s, growth);
        }
        let places = |of: &[f64]| {
            if is_thinned {
                Places::between(&time_s, &bounds, of)
            } else {
                Places::on(&time_s, of)
            }
        };
        Grid {
            current: places(current_s),
            curvature: places(&seen_s),
            shares,
            time_s,
        }
    }
}

/// Both, increasing, each time once.
fn merged(times: &[f64], more: &[f64]) -> Vec<f64> {
    let mut all = [times, more].concat();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Shortest time that steps must resolve; none where every step is exact.
fn resolved_s(system: &System, opens: bool) -> Option<f64> {
    let observed_s = system
        .observations
        .iter()
        .map(|observation| observation.resolves_s());
    let observed_s = observed_s.fold(f64::INFINITY, f64::min);
    let branches = system.branches.iter();
    let of_branches = branches.map(|b| b.resistance_ohm_cm2 * b.capacitance_f_per_cm2);
    let shortest_s = match (system.is_linear() && !opens, system.source_rise_s) {
        (true, _) if observed_s.is_infinite() => observed_s,
        (true, _) => of_branches.fold(observed_s, f64::min),
        (false, 0.0) => of_branches.fold(observed_s, f64::min),
        (false, rise_s) => of_branches.fold(observed_s.min(rise_s), f64::min),
    };
    (shortest_s.is_finite() && shortest_s > 0.0).then_some(shortest_s)
}

/// With steps of `first_s` after every edge that grow by `growth` of the time since. No step is below what the
/// resolution of numbers lets time go on by. The levels of a voltage that moves all the time are no edges: they are as fine
/// as it is followed at all, and each is a step.
fn refined(time_s: &[f64], edges_s: &[f64], first_s: f64, growth: f64) -> Vec<f64> {
    let furthest_s = peak(time_s);
    let first_s = first_s.max(FINEST * furthest_s);
    let mut edges = edges_s.iter().copied().peekable();
    let mut edge_s = f64::NEG_INFINITY;
    let mut out = Vec::with_capacity(2 * time_s.len());
    for pair in time_s.windows(2) {
        let [mut t, next] = [pair[0], pair[1]];
        while let Some(start_s) = edges.next_if(|&start_s| start_s <= t) {
            edge_s = start_s;
        }
        out.push(t);
        if edge_s == f64::NEG_INFINITY {
            continue;
        }
        loop {
            let longest_s = first_s + growth * (t - edge_s);
            let left_s = next - t;
            if left_s <= 1.25 * longest_s {
                break;
            }
            t += if left_s < 2.0 * longest_s {
                left_s / 2.0
            } else {
                longest_s
            };
            out.push(t);
        }
    }
    out.extend(time_s.last());
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_constant_beyond_the_resolution_of_numbers_ends() {
        let edges = [0.0, 300.0];
        let times: Vec<f64> = (0..=600).map(f64::from).collect();
        let plain = refined(&times, &edges, 0.01, GROWTH).len();
        let steep = refined(&times, &edges, 1e-25, GROWTH);
        // Logarithmically more: from 1e-2 to 6e-7 s by 7 % each, after two edges.
        assert!(steep.len() < plain + 400, "{} {plain}", steep.len());
        assert!(steep.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
