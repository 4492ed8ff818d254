//! One way to make the run: its drive, its sampling and its length.

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::number::digits;
use crate::domain::{Drive, Edge, Level};
use crate::pipeline::PipelineError;
use crate::pipeline::standalone::forward::document::{DriveEntry, as_entry};

/// Readings of a run at most: what twenty fits of take minutes.
const MOST_READINGS: f64 = 1e6;
/// Readings before the drive begins: as few as show that there is one.
const BEFORE: f64 = 2.0;

/// How a run is to be made.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Trial {
    /// The drive.
    #[serde(serialize_with = "as_entry")]
    #[schemars(with = "DriveEntry")]
    pub drive: Drive,
    /// Time between readings of the current, s.
    pub every_s: f64,
    /// Time between readings of the bending, s.
    pub bending_every_s: f64,
    /// Length of the record from the start of the drive, s.
    pub for_s: f64,
    /// Whether the instrument states when the drive begins; else it is known between two readings only.
    pub start_is_known: bool,
}

impl Trial {
    /// Refuses times and voltages that no run can have.
    ///
    /// # Errors
    /// What was found and what was needed.
    pub fn check(&self) -> Result<(), PipelineError> {
        let positive = |time_s: f64| time_s.is_finite() && time_s > 0.0;
        for (what, every_s) in [
            ("--every", self.every_s),
            ("--bending-every", self.bending_every_s),
        ] {
            if !positive(every_s) {
                return Err(PipelineError::bad_argument(
                    what,
                    format!("{every_s} s"),
                    "a time above 0 between readings, as 0.25s",
                ));
            }
            if !positive(self.for_s) || self.for_s < 2.0 * every_s {
                let needed = format!(
                    "two readings at least: {} s or more at a reading every {every_s} s",
                    2.0 * every_s
                );
                return Err(PipelineError::bad_argument(
                    "--for",
                    format!("{} s", self.for_s),
                    &needed,
                ));
            }
        }
        if !self.is_feasible() {
            let needed = format!("at most {MOST_READINGS} readings: a longer --every, or a shorter --for");
            return Err(PipelineError::bad_argument(
                "--every",
                format!("{} readings", digits(self.readings(), 0)),
                &needed,
            ));
        }
        let rest = Some(self.drive.baseline_v);
        if self.drive.levels().any(|(_, volts)| volts != rest) {
            Ok(())
        } else {
            Err(PipelineError::bad_argument(
                "--voltage",
                "a voltage that never changes".to_owned(),
                "a step, as 1.2V",
            ))
        }
    }

    /// Whether it has no more readings than can be fitted in reasonable time.
    pub fn is_feasible(&self) -> bool {
        self.readings() <= MOST_READINGS
    }

    fn readings(&self) -> f64 {
        self.for_s / self.every_s + self.for_s / self.bending_every_s
    }

    /// The same with all voltages times `factor`.
    pub fn at_voltage(&self, factor: f64) -> Trial {
        let mut changed = self.clone();
        changed.drive.baseline_v *= factor;
        for segment in &mut changed.drive.segments {
            if let Level::Voltage(volts) = &mut segment.level {
                *volts *= factor;
            }
        }
        changed
    }

    /// The same with both responses read `factor` times as often.
    pub fn read_faster(&self, factor: f64) -> Trial {
        Trial {
            every_s: self.every_s / factor,
            bending_every_s: self.bending_every_s / factor,
            ..self.clone()
        }
    }

    /// The same for `factor` times as long; the last level is held.
    pub fn longer(&self, factor: f64) -> Trial {
        Trial {
            for_s: self.for_s * factor,
            ..self.clone()
        }
    }

    /// The same where the start of the drive is stated.
    pub fn with_known_start(&self) -> Trial {
        Trial {
            start_is_known: true,
            ..self.clone()
        }
    }

    /// The drive as the fit is told it.
    pub fn told(&self, time_s: &[f64]) -> Drive {
        let mut told = self.drive.as_seen(time_s);
        if let (true, Some(first), Some(own)) = (
            self.start_is_known,
            told.segments.first_mut(),
            self.drive.segments.first(),
        ) {
            // A trigger tells when the drive begins; later edges are read like all others.
            first.edge = Edge::at(own.start_s());
        }
        told
    }

    /// Times of readings every so often, of which the first within the drive comes after `phase` (0 to 1) of an interval.
    pub fn times(&self, every_s: f64, phase: f64) -> Vec<f64> {
        let start_s = self
            .drive
            .segments
            .first()
            .map_or(0.0, |segment| segment.start_s());
        let count = (self.for_s / every_s + BEFORE).floor() as usize;
        let time = |k: usize| start_s + (k as f64 - BEFORE + phase) * every_s;
        (0..=count)
            .map(time)
            .filter(|time| *time <= start_s + self.for_s)
            .collect()
    }
}
