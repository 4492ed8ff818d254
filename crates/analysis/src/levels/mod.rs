//! Levels of a drive as readings tell them: each begins and ends somewhere, and what flows over it.

mod begun;
mod charge;
mod flow;
pub mod policy;
#[cfg(test)]
mod tests;

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Drive, Estimate, Level as Source, Segment};

/// Why what depends on when a level began is open where only its end is known.
pub(crate) const UNKNOWN_BEGINNING: &str = "nothing tells how early the voltage changed";

pub(crate) use charge::{Charge, Sum};
pub(crate) use flow::{Flow, Told};
use policy::PLACE;

/// Where an edge lies: anywhere between two times, which are one where it is known exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Edge {
    /// Not before, s: the last reading of the voltage that shows the level before; minus infinity where nothing tells.
    pub earliest_s: f64,
    /// Not after, s: the first reading that shows the level behind it.
    pub latest_s: f64,
}

impl Edge {
    /// One that is known exactly.
    pub fn exact(at_s: f64) -> Edge {
        Edge {
            earliest_s: at_s,
            latest_s: at_s,
        }
    }

    /// Where a segment begins.
    pub fn of(segment: &Segment) -> Edge {
        Edge {
            earliest_s: segment.last_before_s.unwrap_or(segment.start_s),
            latest_s: segment.start_s,
        }
    }

    /// How long the stretch is in which it lies, s.
    pub fn open_s(&self) -> f64 {
        self.latest_s - self.earliest_s
    }

    /// The middle of where it may lie, s; where nothing tells how early, the latest.
    pub fn middle_s(&self) -> f64 {
        if self.open_s().is_finite() {
            0.5 * (self.earliest_s + self.latest_s)
        } else {
            self.latest_s
        }
    }

    /// Standard deviation of where it lies, s. That of an even distribution is smaller, but either end is a place, too: a clock
    /// that was started by the edge reads on it, always.
    pub fn error_s(&self) -> f64 {
        PLACE * self.open_s()
    }

    /// Readings of the level before it: those that are surely before.
    pub fn before(&self, time_s: &[f64]) -> usize {
        if self.open_s() > 0.0 {
            time_s.partition_point(|t| *t <= self.earliest_s)
        } else {
            self.after(time_s)
        }
    }

    /// The first reading of the level behind it.
    fn after(&self, time_s: &[f64]) -> usize {
        time_s.partition_point(|t| *t < self.latest_s)
    }
}

/// A voltage that is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Level {
    pub voltage_v: f64,
    /// By how much the voltage changes where it begins, V.
    pub change_v: f64,
    pub from: Edge,
    pub until: Edge,
}

impl Level {
    /// Its readings, half open: from the first one that shows it to before the first one of the next, those left out of which
    /// nothing tells on which side of an edge they are.
    pub fn readings(&self, time_s: &[f64]) -> std::ops::Range<usize> {
        let first = self.from.after(time_s);
        first..self.until.before(time_s).max(first)
    }

    /// How long it lasts, s.
    pub fn held_s(&self) -> f64 {
        self.until.middle_s() - self.from.middle_s()
    }

    /// The same as far as a time that lies in it, s.
    pub fn as_far_as(self, end_s: f64) -> Level {
        if end_s < self.until.latest_s {
            let until = Edge::exact(end_s);
            Level { until, ..self }
        } else {
            self
        }
    }
}

/// The levels of a drive that are seen until `last_s`, in their order, none of an open circuit; the last one ends with the
/// readings.
pub(crate) fn levels(drive: &Drive, last_s: f64) -> Vec<Option<Level>> {
    let mut before_v = drive.baseline_v;
    let segments = drive.segments.iter().enumerate();
    let level = |(k, segment): (usize, &Segment)| {
        let Source::Voltage(voltage_v) = segment.level else {
            return None;
        };
        let change_v = voltage_v - std::mem::replace(&mut before_v, voltage_v);
        let next = drive.segments.get(k + 1).map(Edge::of);
        let until = next.filter(|edge| edge.earliest_s < last_s);
        Some(Level {
            voltage_v,
            change_v,
            from: Edge::of(segment),
            until: until.unwrap_or(Edge::exact(last_s.next_up())),
        })
    };
    segments
        .take_while(|(_, segment)| segment.start_s <= last_s)
        .map(level)
        .collect()
}

/// A value with a normal error.
pub(crate) fn symmetric(value: f64, error: f64) -> Estimate {
    Estimate::determined(value, error, value - NORMAL_95 * error, value + NORMAL_95 * error)
}
