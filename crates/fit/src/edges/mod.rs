//! When the edges of a drive were, where only readings tell: between the last reading before and the first one after.
//!
//! Any logger that is not told of the edges meets this. The times are nuisances: uniform between two readings, found with
//! all else where the readings tell more, and what is left open of them widens what is stated.

mod policy;
mod programme;

use crate::edges::policy::SHARED_PART;
use ieap_domain::{Drive, EDGE_OF_RANGE, Segment};
use ieap_numerics::symmetric::Symmetric;

use programme::Programme;

/// Part of its range that a shift uses: an edge is never at the very reading before it, which would then lie behind it.
const INSIDE: f64 = 1.0 - 1e-6;

/// Parts of its range at which a search begins a shift: the middle, soon after the reading before, shortly before the reading
/// that saw the edge. A branch that charges between two readings makes one minimum of each.
const BEGUN_AT: [f64; Shift::PLACES] = [0.0, -0.7, 0.7];

/// A drive whose edges are known to within the readings beside them.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeTimes {
    drive: Drive,
    shifts: Vec<Shift>,
    /// The times after which no edge is, s.
    latest_s: Vec<f64>,
}

/// Edges that move together.
#[derive(Debug, Clone, PartialEq)]
pub struct Shift {
    /// By how much each segment's start moves, per second of the shift.
    moves: Vec<f64>,
    /// How far the shift may go, s.
    low_s: f64,
    high_s: f64,
    /// Whether it may be off as others are, which the same clock makes; not so the length of a period.
    is_of_clock: bool,
}

impl Shift {
    /// Places that a search begins at.
    pub const PLACES: usize = 3;

    fn of_one(segment: usize, segments: usize, reach_s: f64) -> Shift {
        Shift {
            moves: (0..segments).map(|k| f64::from(u8::from(k == segment))).collect(),
            low_s: -INSIDE * reach_s,
            high_s: INSIDE * reach_s,
            is_of_clock: true,
        }
    }

    /// How far it may go, s.
    pub fn limits_s(&self) -> (f64, f64) {
        (self.low_s, self.high_s)
    }

    /// Where a search begins it, s; all shifts are begun at the same place of their ranges.
    pub fn begun_at_s(&self) -> [f64; Shift::PLACES] {
        BEGUN_AT.map(|part| part * if part < 0.0 { -self.low_s } else { self.high_s })
    }

    /// What is not known of it before the readings tell, s.
    pub fn standard_deviation_s(&self) -> f64 {
        EDGE_OF_RANGE * (self.high_s - self.low_s)
    }
}

impl EdgeTimes {
    /// Every edge where it is said to be.
    pub fn known(drive: &Drive) -> EdgeTimes {
        EdgeTimes::placed(drive, drive.clone(), Vec::new())
    }

    /// With the edges of a drive where `placed` has them, and what may move.
    fn placed(drive: &Drive, placed: Drive, shifts: Vec<Shift>) -> EdgeTimes {
        EdgeTimes {
            latest_s: drive.segments.iter().map(|segment| segment.start_s()).collect(),
            drive: placed,
            shifts,
        }
    }

    /// Every edge in the middle of where it may be; of a train of pulses that one programme gives, where the programme has
    /// it, which its edges tell all together.
    pub fn of(drive: &Drive) -> EdgeTimes {
        let open = |k: usize| {
            let edge = drive.segments[k].edge;
            (edge.open_s() > 0.0).then_some((edge.no_earlier_s, edge.no_later_s))
        };
        let between: Vec<Option<(f64, f64)>> = (0..drive.segments.len()).map(open).collect();
        if between.iter().all(Option::is_none) || drive.moves() {
            return EdgeTimes::known(drive);
        }
        if let Some(programme) = Programme::of(drive, &between) {
            return programme.edge_times(drive);
        }
        let mut placed = drive.clone();
        let mut shifts = Vec::new();
        for (k, between) in between.iter().enumerate() {
            let Some((from_s, to_s)) = *between else { continue };
            let half_s = 0.5 * (to_s - from_s);
            placed.segments[k].edge.no_later_s = from_s + half_s;
            shifts.push(Shift::of_one(k, drive.segments.len(), half_s));
        }
        EdgeTimes::placed(drive, placed, shifts)
    }

    /// The drive with its edges where they are taken to be.
    pub fn drive(&self) -> &Drive {
        &self.drive
    }

    /// What may move.
    pub fn shifts(&self) -> &[Shift] {
        &self.shifts
    }

    /// The drive with each shift gone so far, s.
    pub fn shifted(&self, by_s: &[f64]) -> Drive {
        let mut drive = self.drive.clone();
        for (shift, by_s) in self.shifts.iter().zip(by_s) {
            let starts = drive.segments.iter_mut().zip(&shift.moves);
            starts.for_each(|(segment, moves)| segment.edge.no_later_s += moves * by_s);
        }
        drive
    }

    /// The part of a way that the shifts can go, s, until an edge meets a reading beside it; 1 at most.
    pub fn part_of(&self, by_s: &[f64]) -> f64 {
        let there = self.shifted(by_s);
        let edges = self
            .drive
            .segments
            .iter()
            .zip(&there.segments)
            .zip(&self.latest_s);
        let part = |((here, there), latest_s): ((&Segment, &Segment), &f64)| {
            let (from_s, to_s) = (here.start_s(), there.start_s());
            let room_s = if to_s > from_s {
                latest_s - from_s
            } else {
                from_s - here.edge.no_earlier_s
            };
            let gone_s = (to_s - from_s).abs();
            if gone_s > 0.0 {
                INSIDE * room_s.max(0.0) / gone_s
            } else {
                1.0
            }
        };
        edges.map(part).fold(1.0, f64::min)
    }

    /// With the shifts gone so far; what is left of their ranges is counted from there.
    pub fn moved(&self, by_s: &[f64]) -> EdgeTimes {
        let left = |(shift, by_s): (&Shift, &f64)| Shift {
            low_s: shift.low_s - by_s,
            high_s: shift.high_s - by_s,
            ..shift.clone()
        };
        EdgeTimes {
            drive: self.shifted(by_s),
            shifts: self.shifts.iter().zip(by_s).map(left).collect(),
            latest_s: self.latest_s.clone(),
        }
    }

    /// Independent ways in which the shifts are not known before the readings tell, one standard deviation each, s: all alike,
    /// and each by itself.
    pub fn open_ways(&self) -> Vec<Vec<f64>> {
        let of_clock = |shift: &Shift| f64::from(u8::from(shift.is_of_clock));
        let several = self.shifts.iter().filter(|shift| shift.is_of_clock).count() > 1;
        let part = if several { SHARED_PART } else { 0.0 };
        let alike = |shift: &Shift| (part * of_clock(shift)).sqrt() * shift.standard_deviation_s();
        let own = |shift: &Shift| (1.0 - part * of_clock(shift)).sqrt() * shift.standard_deviation_s();
        let of_one = |k: usize| {
            let mut way = vec![0.0; self.shifts.len()];
            way[k] = own(&self.shifts[k]);
            way
        };
        let all = several.then(|| self.shifts.iter().map(alike).collect());
        all.into_iter()
            .chain((0..self.shifts.len()).map(of_one))
            .collect()
    }

    /// What is known of the shifts before the readings tell: the inverse of their covariance, 1/s2.
    pub fn known_before(&self) -> Symmetric {
        let ways = self.open_ways();
        let count = self.shifts.len();
        let covariance = Symmetric::from_fn(count, |a, b| ways.iter().map(|way| way[a] * way[b]).sum());
        covariance.inverse(1e-12)
    }

    /// Whether any edge is not known.
    pub fn is_open(&self) -> bool {
        !self.shifts.is_empty()
    }
}

/// Edges where the readings have them, with what is left open of them.
pub(crate) struct Settled {
    pub(crate) edges: EdgeTimes,
    /// Independent ways in which all edges may still be off together, one standard deviation each, s.
    pub(crate) open: Vec<Vec<f64>>,
}

impl Settled {
    /// Standard error of each segment's start, s.
    pub(crate) fn errors_s(&self) -> Vec<f64> {
        let moved = |segment: usize, way: &[f64]| -> f64 {
            let shifts = self.edges.shifts.iter().zip(way);
            shifts.map(|(shift, by_s)| shift.moves[segment] * by_s).sum()
        };
        let error = |segment: usize| {
            let square: f64 = self.open.iter().map(|way| moved(segment, way).powi(2)).sum();
            square.sqrt()
        };
        (0..self.edges.drive.segments.len()).map(error).collect()
    }

    /// The same where each edge may be later than it was found, up to the reading that saw it: in the middle of that.
    pub(crate) fn or_later(mut self) -> Settled {
        let shifts = self.edges.shifts().len();
        let room_s = |k: usize| {
            let mut by_s = vec![0.0; shifts];
            by_s[k] = self.edges.shifts[k].high_s.max(0.0);
            self.edges.part_of(&by_s) * by_s[k]
        };
        let room_s: Vec<f64> = (0..shifts).map(room_s).collect();
        let half_s: Vec<f64> = room_s.iter().map(|room_s| 0.5 * room_s).collect();
        let part = self.edges.part_of(&half_s);
        let middle_s: Vec<f64> = half_s.iter().map(|half_s| part * half_s).collect();
        self.edges = self.edges.moved(&middle_s);
        self.open
            .push(room_s.iter().map(|room_s| EDGE_OF_RANGE * room_s).collect());
        self
    }

    /// Each edge in the middle of where it may be, with all of its range open.
    pub(crate) fn in_the_middle(drive: &Drive) -> Settled {
        let edges = EdgeTimes::of(drive);
        Settled {
            open: edges.open_ways(),
            edges,
        }
    }
}

#[cfg(test)]
mod tests;
