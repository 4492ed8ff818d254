//! Levels of a drive as readings tell them: each begins and ends somewhere, and what flows over it.

mod begun;
mod charge;
mod flow;
pub mod policy;
#[cfg(test)]
mod tests;

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Drive, Edge, Estimate, Level as Source, Segment};

pub(crate) use charge::{Charge, Sum};
pub(crate) use flow::{Flow, Told};

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
        let first = self.from.first_behind(time_s);
        first..self.until.readings_before(time_s).max(first)
    }

    /// How long it lasts, s.
    pub fn held_s(&self) -> f64 {
        self.until.middle_s() - self.from.middle_s()
    }

    /// The same as far as a time that lies in it, s.
    pub fn as_far_as(self, end_s: f64) -> Level {
        if end_s < self.until.no_later_s {
            let until = Edge::at(end_s);
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
        let next = drive.segments.get(k + 1).map(|segment| segment.edge);
        let until = next.filter(|edge| edge.no_earlier_s < last_s);
        Some(Level {
            voltage_v,
            change_v,
            from: segment.edge,
            until: until.unwrap_or(Edge::at(last_s.next_up())),
        })
    };
    segments
        .take_while(|(_, segment)| segment.start_s() <= last_s)
        .map(level)
        .collect()
}

/// A value with a normal error.
pub(crate) fn symmetric(value: f64, error: f64) -> Estimate {
    Estimate::determined(value, error, value - NORMAL_95 * error, value + NORMAL_95 * error)
}
