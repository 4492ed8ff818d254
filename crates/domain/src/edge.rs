//! When the voltage changed, as far as it is known.

use serde::{Deserialize, Serialize};

/// When the voltage changed: after the last reading that shows the old level and no later than the first that shows the new one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Edge {
    /// It was not before this time, s.
    // Databases of before hold edges without it, of origin `unseen`; their runs are asked again.
    #[serde(default)]
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
    /// The readings beside it, and of one before the first of them the clock's zero.
    #[serde(alias = "unseen")]
    Readings,
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

    /// The edge before the first of readings at these times, which find the new level already. Two witnesses tell when it was: a
    /// record begins with its step, so that it lies within one interval before the first reading; and a clock that counts from
    /// the step has its zero there. Where they disagree it lies anywhere between what they say. None without a reading.
    pub fn before_readings(time_s: &[f64], counts_from_step: bool) -> Option<Edge> {
        let begins_s = *time_s.first()?;
        let interval_s = time_s.get(1).map_or(0.0, |next_s| next_s - begins_s);
        let of_clock = Some(0.0).filter(|zero_s| counts_from_step && *zero_s <= begins_s);
        let of_record_s = begins_s - interval_s;
        Some(Edge::between(
            of_clock.map_or(of_record_s, |zero_s| of_record_s.min(zero_s)),
            begins_s,
        ))
    }

    /// How long the time is in which it may lie, s; 0 where it is stated.
    pub fn open_s(&self) -> f64 {
        self.no_later_s - self.no_earlier_s
    }

    /// The middle of that time, s.
    pub fn middle_s(&self) -> f64 {
        0.5 * (self.no_earlier_s + self.no_later_s)
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_before_a_record_moves_with_its_first_reading_and_jumps_nowhere() {
        let edge = |begins_s: f64, counts_from_step: bool| {
            Edge::before_readings(&[begins_s, begins_s + 1.0, begins_s + 2.0], counts_from_step).unwrap()
        };
        // Both witnesses agree within an interval of the clock's zero.
        assert_eq!(edge(0.5, true), Edge::between(-0.5, 0.5));
        assert_eq!(edge(10.0, true), Edge::between(0.0, 10.0));
        // Another clock tells nothing, nor does one whose zero comes after the first reading.
        assert_eq!(edge(10.0, false), Edge::between(9.0, 10.0));
        assert_eq!(edge(-5.0, true), Edge::between(-6.0, -5.0));
        let at: Vec<f64> = (0..3000).map(|k| f64::from(k) * 1e-3 - 1.0).collect();
        for pair in at.windows(2) {
            let [a, b] = [edge(pair[0], true), edge(pair[1], true)];
            assert!((a.no_earlier_s - b.no_earlier_s).abs() < 1.1e-3, "{pair:?}");
        }
        assert_eq!(Edge::before_readings(&[], true), None);
    }
}
