//! A train of pulses that one programme gives: a period, and where in it each edge lies. Hundreds of edges that fall between
//! readings tell these few numbers well.

use ieap_domain::Drive;

use super::{EdgeTimes, Shift};
use crate::edges::policy::{FEWEST_FOR_PERIOD, MOST_IN_PERIOD, SAME_LEVEL_PART};

/// Periods that are tried between the shortest and the longest that the edges leave.
const TRIED: usize = 400;

/// A period with where the edges of its first round may be, s.
type Tried = (f64, Vec<(f64, f64)>);

/// The period, and where the edges of its middle round may be: whichever of the periods that pass between the readings it is.
pub(super) struct Programme {
    /// Ends of the period, s.
    period_s: (f64, f64),
    /// Ends of where each edge of the middle round may be, s.
    middle: Vec<(f64, f64)>,
}

impl Programme {
    /// The programme of a train; none where no period passes between all of its readings.
    pub(super) fn of(drive: &Drive, between: &[Option<(f64, f64)>]) -> Option<Programme> {
        let between: Vec<(f64, f64)> = between.iter().copied().collect::<Option<_>>()?;
        if between.len() < FEWEST_FOR_PERIOD {
            return None;
        }
        let cycle = (1..=MOST_IN_PERIOD.min(between.len() / 2)).find(|&cycle| repeats(drive, cycle))?;
        let rounds = (between.len() - 1) / cycle;
        let last = rounds * cycle;
        let low_s = (between[last].0 - between[0].1) / rounds as f64;
        let high_s = (between[last].1 - between[0].0) / rounds as f64;
        let tried = (0..=TRIED).map(|k| low_s + (high_s - low_s) * k as f64 / TRIED as f64);
        let first = |period_s: f64| Some((period_s, first_round(&between, cycle, period_s)?));
        let possible: Vec<Tried> = tried.filter_map(first).collect();
        let half = 0.5 * ((between.len() - 1) / cycle) as f64;
        let of_place = |place: usize| {
            let ends = possible.iter().map(|(period_s, first)| {
                let (from_s, to_s) = first[place];
                (from_s + half * period_s, to_s + half * period_s)
            });
            ends.fold(
                (f64::INFINITY, f64::NEG_INFINITY),
                |(low, high), (from_s, to_s)| (low.min(from_s), high.max(to_s)),
            )
        };
        Some(Programme {
            period_s: (possible.first()?.0, possible.last()?.0),
            middle: (0..cycle).map(of_place).collect(),
        })
    }

    /// Each edge of the period may move with those of its place in other rounds, and all by the length of the period.
    pub(super) fn edge_times(&self, drive: &Drive) -> EdgeTimes {
        let (cycle, segments) = (self.middle.len(), drive.segments.len());
        // About the middle round, so that the length of the period moves no edge that the places move.
        let half = 0.5 * ((segments - 1) / cycle) as f64;
        let round = |k: usize| (k / cycle) as f64 - half;
        let period_s = 0.5 * (self.period_s.0 + self.period_s.1);
        let mut placed = drive.clone();
        for (k, segment) in placed.segments.iter_mut().enumerate() {
            let (from_s, to_s) = self.middle[k % cycle];
            segment.edge.no_later_s = 0.5 * (from_s + to_s) + round(k) * period_s;
        }
        let of_place = |(place, (from_s, to_s)): (usize, &(f64, f64))| Shift {
            moves: (0..segments)
                .map(|k| f64::from(u8::from(k % cycle == place)))
                .collect(),
            low_s: 0.5 * (from_s - to_s),
            high_s: 0.5 * (to_s - from_s),
            is_of_clock: true,
        };
        let mut shifts: Vec<Shift> = self.middle.iter().enumerate().map(of_place).collect();
        let half = half.max(0.5);
        let reach_s = 0.5 * half * (self.period_s.1 - self.period_s.0);
        shifts.push(Shift {
            moves: (0..segments).map(|k| round(k) / half).collect(),
            low_s: -reach_s,
            high_s: reach_s,
            is_of_clock: false,
        });
        EdgeTimes::placed(drive, placed, shifts)
    }
}

/// Whether the levels repeat after so many edges.
fn repeats(drive: &Drive, cycle: usize) -> bool {
    let levels: Vec<Option<f64>> = drive.levels().map(|(_, volts)| volts).collect();
    let known = levels.iter().flatten().copied().chain([drive.baseline_v]);
    let (low, high) = ieap_domain::range_of(known);
    let alike = |(a, b): (&Option<f64>, &Option<f64>)| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= SAME_LEVEL_PART * (high - low),
        (a, b) => a == b,
    };
    levels.iter().zip(&levels[cycle..]).all(alike)
}

/// Where the edges of the first round may be with that period; none where some edge would not lie between its readings.
fn first_round(between: &[(f64, f64)], cycle: usize, period_s: f64) -> Option<Vec<(f64, f64)>> {
    let of_place = |place: usize| {
        let (mut from_s, mut to_s) = (f64::NEG_INFINITY, f64::INFINITY);
        for (round, (before_s, after_s)) in between.iter().skip(place).step_by(cycle).enumerate() {
            from_s = from_s.max(before_s - round as f64 * period_s);
            to_s = to_s.min(after_s - round as f64 * period_s);
        }
        (from_s <= to_s).then_some((from_s, to_s))
    };
    (0..cycle).map(of_place).collect()
}
