//! A level of a drive that is held, and what all numbers of one share.

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Drive, Estimate, Level, Segment};

/// A level of a drive.
#[derive(Debug, Clone, Copy)]
pub(super) struct Held {
    pub voltage_v: f64,
    pub step_s: f64,
    pub end_s: f64,
    /// Standard deviation of where the step lies, s.
    pub step_error_s: f64,
}

/// When a segment begins, and the standard deviation of that: anywhere between two readings is in the middle, with that of an
/// even distribution.
pub(super) fn edge(segment: &Segment) -> (f64, f64) {
    (segment.edge.middle_s(), segment.edge.standard_deviation_s())
}

/// The level of the first step; none where the voltage moves all the time, or never changes.
pub(super) fn first_level(drive: &Drive) -> Option<Held> {
    if drive.moves() {
        return None;
    }
    let first = drive.segments.first()?;
    let Level::Voltage(voltage_v) = first.level else {
        return None;
    };
    let (step_s, step_error_s) = edge(first);
    (voltage_v != drive.baseline_v).then(|| Held {
        voltage_v,
        step_s,
        step_error_s,
        end_s: drive
            .segments
            .get(1)
            .map_or(f64::INFINITY, |next| next.edge.no_earlier_s),
    })
}

pub(super) fn no_bending() -> Estimate {
    Estimate::not_determined("the bending cannot be told from noise")
}

pub(super) fn symmetric(value: f64, error: f64) -> Estimate {
    Estimate::determined(value, error, value - NORMAL_95 * error, value + NORMAL_95 * error)
}
