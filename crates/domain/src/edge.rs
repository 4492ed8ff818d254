//! When the voltage changed, as far as it is known.

use serde::{Deserialize, Serialize};

/// When the voltage changed: after the last reading that shows the old level and no later than the first that shows the new one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Edge {
    /// It was not before this time, s.
    pub no_earlier_s: f64,
    /// It was not after this time, s.
    pub no_later_s: f64,
    /// What tells.
    pub origin: EdgeOrigin,
}

/// What tells when the voltage changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EdgeOrigin {
    /// The file or a person states it, to the instant.
    Stated,
    /// The readings beside it.
    Readings,
    /// Nothing: the record begins after it, and does not say how long after. [`Edge::no_earlier_s`] is then as far back as the
    /// record is long, which is no knowledge.
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

    /// An edge before the first of these readings, at a time that nothing tells.
    pub fn before_record(time_s: &[f64]) -> Edge {
        let begins_s = time_s.first().copied().unwrap_or(0.0);
        let ends_s = time_s.last().copied().unwrap_or(0.0);
        Edge {
            no_earlier_s: 2.0 * begins_s - ends_s,
            no_later_s: begins_s,
            origin: EdgeOrigin::Unseen,
        }
    }

    /// How long the time is in which it may lie, s; 0 where it is stated.
    pub fn open_s(&self) -> f64 {
        self.no_later_s - self.no_earlier_s
    }

    /// The middle of that time, s.
    pub fn middle_s(&self) -> f64 {
        0.5 * (self.no_earlier_s + self.no_later_s)
    }

    /// Standard deviation of where it lies in that time, s, as likely anywhere.
    pub fn standard_deviation_s(&self) -> f64 {
        self.open_s() / 12f64.sqrt()
    }

    /// Whether it is stated.
    pub fn is_stated(&self) -> bool {
        self.origin == EdgeOrigin::Stated
    }

    /// Whether nothing tells how long before the record it was.
    pub fn is_unseen(&self) -> bool {
        self.origin == EdgeOrigin::Unseen
    }

    /// The same taken to be at that time, s.
    pub fn taken_at(self, time_s: f64) -> Edge {
        Edge {
            no_later_s: time_s,
            ..self
        }
    }
}
