//! When the voltage changed, as far as it is known.

use serde::{Deserialize, Serialize};

/// When the voltage changed: after the last reading that shows the old level and no later than the first that shows the new one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Edge {
    /// It was not before this time, s; minus infinity, which is not stored, where nothing tells.
    #[serde(default = "never", skip_serializing_if = "is_never")]
    pub no_earlier_s: f64,
    /// It was not after this time, s.
    pub no_later_s: f64,
    /// What tells.
    pub origin: EdgeOrigin,
}

/// What is not known of an edge that lies anywhere in a time counts as so much of that, as a standard deviation. Of an even
/// distribution it would be 0.289; but either end is a place, too, where a clock that was started by the edge reads on all of
/// them: with 0.289 88 to 94 of 100 intervals hold there, by `cargo run --release -p ieap-fit --example sampling_grid`.
pub const EDGE_OF_RANGE: f64 = 0.36;

/// What tells when the voltage changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EdgeOrigin {
    /// The file or a person states it, to the instant.
    Stated,
    /// The readings beside it.
    Readings,
    /// Nothing: the record begins after it, and does not say how long after.
    Unseen,
}

impl Edge {
    /// An edge that is stated.
    pub fn at(time_s: f64) -> Edge {
        Edge {
            no_earlier_s: time_s,
            no_later_s: time_s,
            origin: EdgeOrigin::Stated,
        }
    }

    /// An edge after one reading and no later than another.
    pub fn between(no_earlier_s: f64, no_later_s: f64) -> Edge {
        Edge {
            no_earlier_s,
            no_later_s,
            origin: EdgeOrigin::Readings,
        }
    }

    /// An edge before the record, at a time that nothing tells.
    pub fn before(begins_s: f64) -> Edge {
        Edge {
            no_earlier_s: f64::NEG_INFINITY,
            no_later_s: begins_s,
            origin: EdgeOrigin::Unseen,
        }
    }

    /// How long the time is in which it may lie, s; 0 where it is stated.
    pub fn open_s(&self) -> f64 {
        self.no_later_s - self.no_earlier_s
    }

    /// The middle of that time, s; the end of it where nothing tells how early.
    pub fn middle_s(&self) -> f64 {
        if self.is_unseen() {
            self.no_later_s
        } else {
            0.5 * (self.no_earlier_s + self.no_later_s)
        }
    }

    /// Standard deviation of where it lies in that time, s ([`EDGE_OF_RANGE`]).
    pub fn standard_deviation_s(&self) -> f64 {
        EDGE_OF_RANGE * self.open_s()
    }

    /// Readings at these times that are surely before it; of one that is stated those of the level before.
    pub fn readings_before(&self, time_s: &[f64]) -> usize {
        if self.open_s() > 0.0 {
            time_s.partition_point(|t| *t <= self.no_earlier_s)
        } else {
            self.first_behind(time_s)
        }
    }

    /// The first reading at these times that is surely behind it.
    pub fn first_behind(&self, time_s: &[f64]) -> usize {
        time_s.partition_point(|t| *t < self.no_later_s)
    }

    /// Whether it is stated.
    pub fn is_stated(&self) -> bool {
        self.origin == EdgeOrigin::Stated
    }

    /// Whether nothing tells how long before the record it was.
    pub fn is_unseen(&self) -> bool {
        self.origin == EdgeOrigin::Unseen
    }
}

fn never() -> f64 {
    f64::NEG_INFINITY
}

fn is_never(time_s: &f64) -> bool {
    *time_s == f64::NEG_INFINITY
}
