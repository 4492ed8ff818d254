//! The source: how it comes to the level that it is told.

use super::system::{RunContext, System};

impl System {
    /// Time in which a source that ramps reaches its level, s; none where none does.
    fn ramp_s(&self) -> Option<f64> {
        (self.source_ramps && self.source_rise_s > 0.0).then_some(2.0 * self.source_rise_s)
    }

    /// Slope from a voltage to the level of a segment that begins, V/s; 0 where the source does not ramp.
    pub(super) fn ramp_v_per_s(&self, from_v: f64, level_v: f64) -> f64 {
        self.ramp_s().map_or(0.0, |ramp_s| (level_v - from_v) / ramp_s)
    }

    /// Voltage after `h` on the way from `from_v` to the level, on a line of that slope where the source ramps.
    pub(super) fn source_after(&self, from_v: f64, slope_v_per_s: f64, level_v: f64, h: f64) -> f64 {
        let (way, left) = (slope_v_per_s * h, level_v - from_v);
        match (self.source_rise_s, self.source_ramps) {
            (0.0, _) => level_v,
            (_, true) if way.abs() < left.abs() => from_v + way,
            (_, true) => level_v,
            (rise_s, false) => level_v - left * (-h / rise_s).exp(),
        }
    }
}

/// Times at which a source that ramps reaches its level.
pub(super) fn ramp_ends(run: &RunContext, system: &System) -> impl Iterator<Item = f64> {
    let segments = run.drive.segments.iter();
    (system.ramp_s().into_iter()).flat_map(move |ramp_s| segments.clone().map(move |s| s.start_s() + ramp_s))
}
