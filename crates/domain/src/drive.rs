//! The piecewise-constant voltage that drives a run.

use serde::{Deserialize, Serialize};

/// Levels of one drive run twice differ by less than this part of its largest step: what a source is set to is met to
/// 1 % or better, and its record adds noise.
const LEVELS_ALIKE: f64 = 0.02;
/// Starts of its segments differ by less than this part of the shortest one: an edge is known to a reading or two.
const STARTS_ALIKE: f64 = 0.1;

/// What the source does during a segment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// The source holds this voltage, V.
    Voltage(f64),
    /// The source is disconnected: no current flows in the outer circuit.
    OpenCircuit,
}

/// A stretch of constant drive, lasting until the next segment starts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// Start, s from time zero.
    pub start_s: f64,
    /// What the source does from then on.
    pub level: Level,
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
            segments: vec![Segment {
                start_s: 0.0,
                level: Level::Voltage(voltage_v),
            }],
        }
    }

    /// When segments start, s: where readings may jump.
    pub fn edges_s(&self) -> Vec<f64> {
        self.segments.iter().map(|segment| segment.start_s).collect()
    }

    /// The held voltage farthest from the baseline (for a discharge, the baseline itself): the nominal step, V.
    pub fn nominal_step_v(&self) -> f64 {
        let levels = self.segments.iter().filter_map(|segment| match segment.level {
            Level::Voltage(voltage_v) => Some(voltage_v),
            Level::OpenCircuit => None,
        });
        levels
            .chain([self.baseline_v])
            .fold(0.0, |far: f64, v| if v.abs() > far.abs() { v } else { far })
    }

    /// Whether both are one drive run twice: the same levels one after the other, to within what sources and their
    /// records differ by. How long the last level was recorded does not count.
    pub fn repeats(&self, other: &Drive) -> bool {
        self.repeats_times(1.0, other)
    }

    /// Whether one is the other with all its voltages times a number: what is linear answers both alike.
    pub fn is_scaled(&self, other: &Drive) -> bool {
        let (own, others) = (self.nominal_step_v(), other.nominal_step_v());
        others != 0.0 && self.repeats_times(own / others, other)
    }

    fn repeats_times(&self, times: f64, other: &Drive) -> bool {
        let others_v = (times * other.nominal_step_v()).abs();
        let off_v = LEVELS_ALIKE * self.nominal_step_v().abs().max(others_v);
        let are_near = |a: f64, b: f64| (a - times * b).abs() <= off_v;
        let shortest_s = self.shortest_segment_s().min(other.shortest_segment_s());
        let alike = |(own, others): (&Segment, &Segment)| {
            let levels = match (own.level, others.level) {
                (Level::Voltage(a), Level::Voltage(b)) => are_near(a, b),
                (a, b) => a == b,
            };
            let after_s = |segment: &Segment, drive: &Drive| segment.start_s - drive.segments[0].start_s;
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
            .map(|pair| pair[1].start_s - pair[0].start_s)
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

    #[test]
    fn a_repeat_has_the_same_levels_at_the_same_times() {
        let drive = |levels: &[(f64, f64)]| {
            let segment = |&(start_s, v): &(f64, f64)| Segment {
                start_s,
                level: Level::Voltage(v),
            };
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
        assert!(
            Drive::step(2.0).is_scaled(&Drive::step(-1.0)) && !Drive::step(2.0).is_scaled(&Drive::step(0.0))
        );
        assert!(pulses.is_scaled(&drive(&[(0.0, 1.0), (20.0, 0.0), (40.0, 1.0)])));
        assert!(!pulses.is_scaled(&drive(&[(0.0, 1.0), (20.0, 0.2), (40.0, 1.0)])));
        let mut charged = Drive::step(0.0);
        charged.baseline_v = 2.0;
        assert!(!charged.is_scaled(&Drive::step(2.0)));
        assert!(charged.repeats(&charged.clone()) && !charged.repeats(&Drive::step(0.0)));
        let mut open = pulses.clone();
        open.segments[1].level = Level::OpenCircuit;
        assert!(open.repeats(&open.clone()) && !open.repeats(&pulses));
    }
}
