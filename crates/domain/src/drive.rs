//! The piecewise-constant voltage that drives a run.

use serde::{Deserialize, Serialize};

use crate::edge::Edge;
use crate::range::range_of;

/// Levels of one drive run twice differ by less than this part of its largest step: what a source is set to is met to
/// 1 % or better, and its record adds noise.
const LEVELS_ALIKE: f64 = 0.02;
/// Starts of its segments differ by less than this part of the shortest one: an edge is known to a reading or two.
const STARTS_ALIKE: f64 = 0.1;
/// Least number of segments of a voltage that moves all the time: half of the readings that a record of one needs.
const LEAST_MOVING: usize = 30;
/// Middle step of such a voltage at most, as a part of its range: twenty readings in a period of a sine step by up to a
/// sixth of the range, pulses by all of it and trains of a few levels by a third.
const MOVES_BY: f64 = 0.2;
/// A step within such a voltage exceeds this many times the larger of its neighbours, and is so many times as steep ...
const JUMP_BESIDE: f64 = 5.0;
/// ... and this part of the range.
const JUMP_OF_RANGE: f64 = 0.05;

/// A voltage agrees with a nominal one within 10 mV or 2 %, whichever is more: what a potentiostat's offset and the rounding of
/// a nominal value explain, and less than the steps of a campaign.
pub const NOMINAL_AGREES_V: f64 = 0.01;
/// See [`NOMINAL_AGREES_V`].
pub const NOMINAL_AGREES_PART: f64 = 0.02;

/// What the source does during a segment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// The source holds this voltage, V.
    Voltage(f64),
    /// The source is disconnected: no current flows in the outer circuit.
    OpenCircuit,
}

impl Level {
    /// The voltage that the source holds, V; none in an open circuit.
    pub fn volts(self) -> Option<f64> {
        match self {
            Level::Voltage(volts) => Some(volts),
            Level::OpenCircuit => None,
        }
    }
}

/// Which of the levels of a moving voltage are reached by a jump: a step far larger than those beside it, and far steeper,
/// for of readings at uneven times a larger step may just have taken longer. `time_s` are the times of the levels, s.
pub fn jumps(time_s: &[f64], levels_v: &[f64]) -> Vec<usize> {
    let (low, high) = range_of(levels_v.iter().copied());
    let step = |at: usize| match (at.checked_sub(1), levels_v.get(at), time_s.get(at)) {
        (Some(before), Some(level_v), Some(t)) => {
            let size_v = (level_v - levels_v[before]).abs();
            (size_v, size_v / (t - time_s[before]).max(f64::MIN_POSITIVE))
        }
        _ => (0.0, 0.0),
    };
    (1..levels_v.len())
        .filter(|&at| {
            let ((before_v, before), (after_v, after)) = (step(at - 1), step(at + 1));
            let (own_v, own) = step(at);
            own_v > JUMP_OF_RANGE * (high - low)
                && own_v > JUMP_BESIDE * before_v.max(after_v)
                && own > JUMP_BESIDE * before.max(after)
        })
        .collect()
}

/// A stretch of constant drive, lasting until the next segment starts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "StoredSegment")]
pub struct Segment {
    /// When it begins.
    pub edge: Edge,
    /// What the source does from then on.
    pub level: Level,
}

impl Segment {
    /// A segment whose start is stated.
    pub fn at(start_s: f64, level: Level) -> Segment {
        let edge = Edge::at(start_s);
        Segment { edge, level }
    }

    /// The time from which on it surely holds, s: of an edge between two readings that of the later one.
    pub fn start_s(&self) -> f64 {
        self.edge.no_later_s
    }
}

/// A segment as it is stored, now and before edges had values of their own.
#[derive(Deserialize)]
struct StoredSegment {
    edge: Option<Edge>,
    level: Level,
    start_s: Option<f64>,
    last_before_s: Option<f64>,
}

impl From<StoredSegment> for Segment {
    fn from(stored: StoredSegment) -> Segment {
        let start_s = stored.start_s.unwrap_or(f64::NAN);
        let between = |before_s| Edge::between(before_s, start_s);
        let before = || stored.last_before_s.map_or(Edge::at(start_s), between);
        Segment {
            edge: stored.edge.unwrap_or_else(before),
            level: stored.level,
        }
    }
}

/// A piecewise-constant drive. Before the first segment the sample rests in the steady state at
/// `baseline_v` (discharged at 0 V).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Voltage held before the first segment, V.
    pub baseline_v: f64,
    /// Segments with strictly increasing starts; at least one.
    pub segments: Vec<Segment>,
}

impl Drive {
    /// One voltage step from the discharged state at time zero.
    pub fn step(voltage_v: f64) -> Drive {
        Drive {
            baseline_v: 0.0,
            segments: vec![Segment::at(0.0, Level::Voltage(voltage_v))],
        }
    }

    /// A drive by the start of each segment, s, and its voltage, V; none of an open circuit.
    pub fn of_levels(baseline_v: f64, levels: impl IntoIterator<Item = (f64, Option<f64>)>) -> Drive {
        let segment = |(start_s, volts): (f64, Option<f64>)| {
            Segment::at(start_s, volts.map_or(Level::OpenCircuit, Level::Voltage))
        };
        Drive {
            baseline_v,
            segments: levels.into_iter().map(segment).collect(),
        }
    }

    /// The start of each segment, s, and its voltage, V; none of an open circuit.
    pub fn levels(&self) -> impl Iterator<Item = (f64, Option<f64>)> {
        let segments = self.segments.iter();
        segments.map(|segment| (segment.start_s(), segment.level.volts()))
    }

    /// Largest voltage of its segments, whatever its sign, V.
    pub fn largest_v(&self) -> f64 {
        let held = self.levels().filter_map(|(_, volts)| volts);
        held.map(f64::abs).fold(0.0, f64::max)
    }

    /// What the source does at a time, s: it holds the baseline before the first segment.
    pub fn level_at(&self, time_s: f64) -> Level {
        let begun = self.segments.iter().rfind(|segment| segment.start_s() <= time_s);
        begun.map_or(Level::Voltage(self.baseline_v), |segment| segment.level)
    }

    /// The staircase of a moving voltage's readings: each is held from midway to the one before to midway to the one after,
    /// from rest at `baseline_v`; a jump lies between the reading before it and the first one that saw it. Times that do not increase are passed over.
    pub fn staircase(time_s: &[f64], volts: &[f64], baseline_v: f64) -> Drive {
        let jumps = jumps(time_s, volts);
        let mut segments: Vec<Segment> = Vec::with_capacity(volts.len());
        for (k, (&t, &volts)) in time_s.iter().zip(volts).enumerate() {
            let before_s = k.checked_sub(1).map(|before| time_s[before]);
            let last_before_s = before_s.filter(|_| jumps.binary_search(&k).is_ok());
            let start_s = match (before_s, last_before_s) {
                (Some(before_s), None) => 0.5 * (before_s + t),
                _ => t,
            };
            if segments.last().is_none_or(|last| last.start_s() < start_s) {
                segments.push(Segment {
                    edge: last_before_s.map_or(Edge::at(start_s), |before_s| Edge::between(before_s, t)),
                    level: Level::Voltage(volts),
                });
            }
        }
        Drive { baseline_v, segments }
    }

    /// The drive as a voltmeter tells it that is read at these times, in rising order: each start lies between the last reading
    /// before it and the first one that saw it; of one before the first reading see [`Edge::before_readings`]. Of starts between the same two readings the last level is seen.
    pub fn as_seen(&self, time_s: &[f64]) -> Drive {
        let mut seen = self.clone();
        for segment in &mut seen.segments {
            let first = time_s.partition_point(|&t| t < segment.start_s());
            let after_s = time_s.get(first).copied().unwrap_or(segment.start_s());
            let before_s = first.checked_sub(1).map(|before| time_s[before]);
            segment.edge = before_s
                .map(|before_s| Edge::between(before_s, after_s))
                .or_else(|| Edge::before_readings(time_s, true))
                .unwrap_or(segment.edge);
        }
        seen.segments.dedup_by(|later, earlier| {
            let same = later.start_s() <= earlier.start_s();
            if same {
                earlier.level = later.level;
            }
            same
        });
        seen
    }

    /// The same so much later, s: as a clock shows it that is ahead by that.
    pub fn later(&self, by_s: f64) -> Drive {
        let mut later = self.clone();
        for segment in &mut later.segments {
            segment.edge.no_earlier_s += by_s;
            segment.edge.no_later_s += by_s;
        }
        later
    }

    /// When segments start at which readings may jump, s: all of them, or of a voltage that [`Drive::moves`] the first one
    /// and those at which it jumps or the circuit opens or closes.
    pub fn edges_s(&self) -> Vec<f64> {
        self.edges()
            .iter()
            .map(|&at| self.segments[at].start_s())
            .collect()
    }

    /// Which segments these are.
    pub fn edges(&self) -> Vec<usize> {
        if !self.moves() {
            return (0..self.segments.len()).collect();
        }
        let is_open = |at: usize| self.segments[at].level == Level::OpenCircuit;
        let jumps = jumps(&self.middles_s(), &self.levels_v());
        (0..self.segments.len())
            .filter(|&at| at == 0 || is_open(at) || is_open(at - 1) || jumps.binary_search(&at).is_ok())
            .collect()
    }

    /// Whether the voltage moves all the time, as a sine, a chirp or a triangle does: such a drive is the staircase of the
    /// voltage's readings, whose steps are no edges.
    pub fn moves(&self) -> bool {
        let levels_v = self.levels_v();
        if levels_v.len() < LEAST_MOVING {
            return false;
        }
        let (low, high) = range_of(levels_v.iter().copied());
        let mut steps: Vec<f64> = levels_v
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs())
            .collect();
        let middle = steps.len() / 2;
        let (_, middle_v, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
        high > low && *middle_v <= MOVES_BY * (high - low)
    }

    /// The middles of the segments in their order, s; the last one has no end, and gives its start.
    fn middles_s(&self) -> Vec<f64> {
        let end_s = |at: usize| self.segments.get(at + 1).unwrap_or(&self.segments[at]).start_s();
        let segments = self.segments.iter().enumerate();
        segments
            .map(|(at, segment)| 0.5 * (segment.start_s() + end_s(at)))
            .collect()
    }

    /// The voltages of the segments in their order, V; of an open circuit the one before.
    fn levels_v(&self) -> Vec<f64> {
        let mut last_v = self.baseline_v;
        let level = |(_, volts): (f64, Option<f64>)| {
            last_v = volts.unwrap_or(last_v);
            last_v
        };
        self.levels().map(level).collect()
    }

    /// The held voltage farthest from the baseline (for a discharge, the baseline itself): the nominal step, V. Of a moving
    /// voltage that goes as far to both sides its positive end: which of them reaches farther is chance.
    pub fn nominal_step_v(&self) -> f64 {
        let far = (self.levels().filter_map(|(_, volts)| volts))
            .chain([self.baseline_v])
            .fold(0.0, |far: f64, v| if v.abs() > far.abs() { v } else { far });
        let has_both = far < 0.0 && self.has_level_near(-far) && self.moves();
        if has_both { -far } else { far }
    }

    /// Whether it holds that voltage at some time, to within what a nominal value is rounded to ([`NOMINAL_AGREES_V`]).
    pub fn has_level_near(&self, voltage_v: f64) -> bool {
        let near = |level_v: f64| {
            (level_v - voltage_v).abs() <= NOMINAL_AGREES_V.max(NOMINAL_AGREES_PART * voltage_v.abs())
        };
        near(self.baseline_v) || self.levels().any(|(_, volts)| volts.is_some_and(near))
    }

    /// Whether both are one drive run twice: the same levels one after the other, to within what sources and their
    /// records differ by. How long the last level was recorded does not count.
    pub fn repeats(&self, other: &Drive) -> bool {
        let others_v = other.nominal_step_v().abs();
        let off_v = LEVELS_ALIKE * self.nominal_step_v().abs().max(others_v);
        let are_near = |a: f64, b: f64| (a - b).abs() <= off_v;
        let shortest_s = self.shortest_segment_s().min(other.shortest_segment_s());
        let alike = |(own, others): (&Segment, &Segment)| {
            let levels = match (own.level, others.level) {
                (Level::Voltage(a), Level::Voltage(b)) => are_near(a, b),
                (a, b) => a == b,
            };
            let after_s = |segment: &Segment, drive: &Drive| segment.start_s() - drive.segments[0].start_s();
            let apart_s = (after_s(own, self) - after_s(others, other)).abs();
            levels && apart_s <= STARTS_ALIKE * shortest_s
        };
        are_near(self.baseline_v, other.baseline_v)
            && self.segments.len() == other.segments.len()
            && self.segments.iter().zip(&other.segments).all(alike)
    }

    /// Length of the shortest segment that another one ends, s; without bound where there is one segment.
    fn shortest_segment_s(&self) -> f64 {
        let pairs = self.segments.windows(2);
        pairs
            .map(|pair| pair[1].start_s() - pair[0].start_s())
            .fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nominal_step_of_a_discharge_is_what_it_was_charged_to() {
        let mut drive = Drive::step(0.0);
        drive.baseline_v = 5.0;
        assert_eq!(drive.nominal_step_v(), 5.0);
        assert_eq!(Drive::step(-0.7).nominal_step_v(), -0.7);
    }

    fn staircase(levels_v: impl Iterator<Item = f64>) -> Drive {
        let segment = |(k, v): (usize, f64)| Segment::at(k as f64, Level::Voltage(v));
        Drive {
            baseline_v: 0.0,
            segments: levels_v.enumerate().map(segment).collect(),
        }
    }

    #[test]
    fn the_nominal_voltage_of_a_wave_is_its_positive_end() {
        let time_s: Vec<f64> = (0..200).map(f64::from).collect();
        let wave =
            |about_v: f64| -> Vec<f64> { time_s.iter().map(|t| about_v - 2.0 * (t / 8.0).sin()).collect() };
        let nominal = |about_v: f64| Drive::staircase(&time_s, &wave(about_v), 0.0).nominal_step_v();
        assert!((nominal(-0.001) - 2.0).abs() < 0.01, "{}", nominal(-0.001));
        assert!((nominal(-1.0) + 3.0).abs() < 0.01);
    }

    #[test]
    fn a_step_that_took_longer_is_no_jump() {
        let time_s: Vec<f64> = (0..120)
            .map(|k| f64::from(k) + if k % 7 == 3 { 0.95 } else { 0.0 })
            .collect();
        let volts: Vec<f64> = time_s.iter().map(|t| (t / 4.0).sin()).collect();
        assert_eq!(jumps(&time_s, &volts), Vec::<usize>::new());
        let jumping: Vec<f64> = time_s
            .iter()
            .zip(&volts)
            .map(|(t, v)| v + if *t < 60.5 { 0.0 } else { 2.0 })
            .collect();
        let at = time_s.partition_point(|t| *t < 60.5);
        assert_eq!(jumps(&time_s, &jumping), [at]);
        assert_eq!(Drive::staircase(&time_s, &jumping, 0.0).edges(), [0, at]);
    }

    #[test]
    fn a_sine_moves_and_has_edges_only_where_it_jumps() {
        let sine = |k: usize| (std::f64::consts::TAU * k as f64 / 20.0).sin();
        let wave = staircase((0..200).map(sine));
        assert!(wave.moves());
        assert_eq!(wave.edges_s(), [0.0]);
        let riding = staircase((0..200).map(|k| if k < 90 { 0.0 } else { 3.0 + 0.1 * sine(k) }));
        assert!(riding.moves());
        assert_eq!(riding.edges(), [0, 90]);
        let mut opened = wave.clone();
        opened.segments[50].level = Level::OpenCircuit;
        assert_eq!(opened.edges(), [0, 50, 51]);
    }

    #[test]
    fn readings_see_an_edge_after_it_was_and_of_two_between_them_the_last() {
        let mut drive = Drive::step(2.0);
        drive.segments.push(Segment::at(4.2, Level::Voltage(0.0)));
        drive.segments.push(Segment::at(4.6, Level::Voltage(1.0)));
        let seen = drive.as_seen(&[-0.5, 0.5, 1.5, 4.0, 5.0]);
        let told: Vec<_> = (seen.segments.iter())
            .map(|segment| (segment.edge, segment.level))
            .collect();
        let expected = [
            (Edge::between(-0.5, 0.5), Level::Voltage(2.0)),
            (Edge::between(4.0, 5.0), Level::Voltage(1.0)),
        ];
        assert_eq!(told, expected);
    }

    #[test]
    fn pulses_and_levels_do_not_move() {
        let pulses = staircase((0..200).map(|k| f64::from(k % 2)));
        let levels = staircase((0..200).map(|k| f64::from([0, 1, 2, 3, 2, 1][k as usize % 6])));
        for drive in [Drive::step(2.0), pulses, levels] {
            assert!(!drive.moves());
            assert_eq!(drive.edges().len(), drive.segments.len());
        }
    }

    #[test]
    fn a_repeat_has_the_same_levels_at_the_same_times() {
        let drive = |levels: &[(f64, f64)]| {
            let segment = |&(start_s, v): &(f64, f64)| Segment::at(start_s, Level::Voltage(v));
            Drive {
                baseline_v: 0.0,
                segments: levels.iter().map(segment).collect(),
            }
        };
        let pulses = drive(&[(0.0, 2.0), (20.0, 0.0), (40.0, 2.0)]);
        assert!(pulses.repeats(&drive(&[(0.5, 2.02), (20.9, 0.001), (41.5, 1.99)])));
        assert!(!pulses.repeats(&drive(&[(0.0, 2.0), (20.0, 0.0), (45.0, 2.0)])));
        assert!(!pulses.repeats(&drive(&[(0.0, 2.0), (20.0, 0.1), (40.0, 2.0)])));
        assert!(!pulses.repeats(&drive(&[(0.0, 2.0), (20.0, 0.0)])));
        assert!(!Drive::step(2.0).repeats(&Drive::step(-2.0)));
        assert!(!Drive::step(2.0).repeats(&Drive::step(1.9)));
        assert!(Drive::step(2.0).repeats(&Drive::step(2.03)));
        let mut charged = Drive::step(0.0);
        charged.baseline_v = 2.0;
        assert!(charged.repeats(&charged.clone()) && !charged.repeats(&Drive::step(0.0)));
        let mut open = pulses.clone();
        open.segments[1].level = Level::OpenCircuit;
        assert!(open.repeats(&open.clone()) && !open.repeats(&pulses));
    }
}
