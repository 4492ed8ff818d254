//! The times at which a run is stepped: the readings, or as many as are enough where they are dense, the edges of the
//! drive, and what lies between where a step would be too long.

use ieap_domain::Level;

use super::knots::{Places, enough};
use super::source::ramp_ends;
use super::system::{RunContext, System};

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

impl Grid {
    pub(super) fn new(run: &RunContext, system: &System, current_s: &[f64], curvature_s: &[f64]) -> Grid {
        let camera = system.camera;
        let start_s = run.start_s();
        let shares = if camera.exposure_s > 0.0 {
            EXPOSURE_POINTS
        } else {
            1
        };
        let seen = |&t: &f64| {
            let shown_s = start_s + (t - start_s) * (1.0 + camera.rate_error) - camera.delay_s;
            let back = move |k: usize| shown_s - camera.exposure_s * (k as f64 + 0.5) / shares as f64;
            (0..shares)
                .rev()
                .map(move |k| if shares == 1 { shown_s } else { back(k) })
        };
        let seen_s: Vec<f64> = curvature_s.iter().flat_map(seen).collect();
        let edges: Vec<f64> = run
            .drive
            .segments
            .iter()
            .map(|segment| segment.start_s())
            .collect();
        let last_s = current_s.iter().chain(&seen_s).copied().fold(start_s, f64::max);
        let mut time_s: Vec<f64> = current_s
            .iter()
            .chain(&seen_s)
            .copied()
            .chain(edges.iter().copied().filter(|&t| t <= last_s))
            .chain(ramp_ends(run, system).filter(|&t| t <= last_s))
            .collect();
        // Stable, for it goes along stretches that are sorted already.
        time_s.sort_by(f64::total_cmp);
        time_s.dedup();
        let jumps = jumps(run, system, &time_s);
        let few = system
            .is_smooth()
            .then(|| enough(&merged(&time_s, &jumps), &merged(&edges, &jumps)))
            .flatten();
        let is_thinned = few.is_some();
        time_s = few.unwrap_or(time_s);
        let opens = (run.drive.segments.iter()).any(|segment| segment.level == Level::OpenCircuit);
        if let Some(shortest_s) = resolved_s(system, opens) {
            let laws = system.laws.iter().map(|law| law.finer());
            let seen = system.observations.iter().map(|o| o.finer());
            let finer = laws.chain(seen).fold(1.0, f64::max);
            let (shortest_s, coarser) = run
                .resolved_s
                .map_or((shortest_s, 1.0), |held_s| (held_s, SEARCHED));
            let coarser = if opens { 1.0 } else { coarser };
            time_s = refined(
                &time_s,
                run,
                FIRST * shortest_s * coarser / finer,
                GROWTH * coarser / finer,
            );
        }
        let places = |of: &[f64]| {
            if is_thinned {
                Places::between(&time_s, &merged(&edges, &jumps), of)
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

/// Times at which laws jump or a ramp of the source ends, within those of the run.
fn jumps(run: &RunContext, system: &System, time_s: &[f64]) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (time_s.first(), time_s.last()) else {
        return Vec::new();
    };
    let at = system.laws.iter().filter_map(|law| law.jumps_at_s());
    let mut at: Vec<f64> = at
        .map(|at_s| run.start_s() + at_s)
        .chain(ramp_ends(run, system))
        .filter(|t| (first..=last).contains(t))
        .collect();
    at.sort_by(f64::total_cmp);
    at
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
fn refined(time_s: &[f64], run: &RunContext, first_s: f64, growth: f64) -> Vec<f64> {
    let furthest_s = time_s.iter().fold(0.0_f64, |most, t| most.max(t.abs()));
    let first_s = first_s.max(FINEST * furthest_s);
    let mut edges = run.drive.edges_s().into_iter().peekable();
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
    use ieap_domain::{Drive, Segment};

    #[test]
    fn a_time_constant_beyond_the_resolution_of_numbers_ends() {
        let drive = Drive {
            baseline_v: 0.0,
            segments: [(0.0, 2.0), (300.0, 0.0)]
                .map(|(start_s, volts)| Segment::at(start_s, Level::Voltage(volts)))
                .to_vec(),
        };
        let run = RunContext {
            index: 0,
            drive: &drive,
            area_cm2: 0.1,
            length_cm: None,
            duration_s: 600.0,
            resolved_s: None,
            tags: &[],
        };
        let times: Vec<f64> = (0..=600).map(f64::from).collect();
        let plain = refined(&times, &run, 0.01, GROWTH).len();
        let steep = refined(&times, &run, 1e-25, GROWTH);
        // Logarithmically more: from 1e-2 to 6e-7 s by 7 % each, after two edges.
        assert!(steep.len() < plain + 400, "{} {plain}", steep.len());
        assert!(steep.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
