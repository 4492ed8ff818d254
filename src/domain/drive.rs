//! The piecewise-constant voltage that drives a run.

use serde::{Deserialize, Serialize};

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
}
