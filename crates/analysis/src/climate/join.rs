//! The as-of join: what a run had of a series while it ran.
//!
//! A run is covered where the readings within it, the last one before it and the first one after it follow each other
//! without a gap longer than the rule. Where a log begins or ends within the run, the run is covered if no more than
//! one interval of the log is missing at that end. Nothing is extrapolated: a run that is not covered has no value.

use ieap_domain::number::seconds::duration;
use ieap_domain::{ClimateQuantity, RunClimate};

/// A run on UTC.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Start, s since 1970 UTC.
    pub from_s: f64,
    /// End, s since 1970 UTC.
    pub to_s: f64,
}

/// Why a series says nothing of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoClimate {
    /// All readings lie before the run, the last one that long, s.
    EndsBefore(f64),
    /// All readings lie after the run, the first one that long, s.
    BeginsAfter(f64),
    /// The log begins or ends while the run goes on; so much of the run, s, is without readings.
    CoversPart(f64),
    /// Two neighbouring readings lie that far apart, s.
    Gap(f64),
    /// There is no reading at all.
    Empty,
}

impl NoClimate {
    /// The reason in words.
    pub fn words(self, longest_gap_s: f64) -> String {
        match self {
            NoClimate::EndsBefore(by) => format!("ends {} before it", duration(by)),
            NoClimate::BeginsAfter(by) => format!("begins {} after it", duration(by)),
            NoClimate::CoversPart(missing) => format!("does not cover {} of it", duration(missing)),
            NoClimate::Gap(gap) => {
                format!(
                    "has a gap of {} (longest allowed: {})",
                    duration(gap),
                    duration(longest_gap_s)
                )
            }
            NoClimate::Empty => "has no reading near it".to_owned(),
        }
    }
}

/// Statistics of a series over a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    /// Readings in the window; 0: interpolated between the readings around it.
    pub readings: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation of the readings.
    pub standard_deviation: Option<f64>,
    /// Slope of the straight line through the readings, per hour.
    pub drift_per_h: Option<f64>,
    /// Largest distance of a reading from the mean.
    pub largest_deviation: f64,
    /// Longest time between neighbouring readings, s, those around the window counted.
    pub largest_gap_s: f64,
}

impl Statistics {
    /// As stored for a run.
    pub fn of_run(
        self,
        sensor: &str,
        quantity: ClimateQuantity,
        chosen: bool,
        accuracy: Option<f64>,
    ) -> RunClimate {
        RunClimate {
            sensor: sensor.to_owned(),
            quantity,
            chosen,
            readings: self.readings,
            mean: self.mean,
            standard_deviation: self.standard_deviation,
            drift_per_h: self.drift_per_h,
            largest_deviation: self.largest_deviation,
            largest_gap_s: self.largest_gap_s,
            accuracy,
        }
    }
}

/// Index of the first reading within `window` and one past the last; with the readings around it that exist.
pub fn readings_in(times_s: &[f64], window: Window) -> (usize, usize) {
    (
        times_s.partition_point(|&t| t < window.from_s),
        times_s.partition_point(|&t| t <= window.to_s),
    )
}

/// Statistics of the readings in `window`; `interval_s` is the time between most of them.
///
/// # Errors
/// The window is not covered, with the reason.
pub fn statistics(
    (times_s, values): (&[f64], &[f64]),
    window: Window,
    interval_s: f64,
    longest_gap_s: f64,
) -> Result<Statistics, NoClimate> {
    let (first, end) = readings_in(times_s, window);
    let largest_gap_s = covered(times_s, (first, end), window, interval_s, longest_gap_s)?;
    if first == end {
        let middle = 0.5 * (window.from_s + window.to_s);
        let (t0, t1) = (times_s[first - 1], times_s[first]);
        let weight = (middle - t0) / (t1 - t0);
        return Ok(Statistics {
            readings: 0,
            mean: values[first - 1] * (1.0 - weight) + values[first] * weight,
            standard_deviation: None,
            drift_per_h: None,
            largest_deviation: 0.0,
            largest_gap_s,
        });
    }
    let (times_s, values) = (&times_s[first..end], &values[first..end]);
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let mean_time = times_s.iter().map(|t| t - window.from_s).sum::<f64>() / count;
    let moments = times_s.iter().zip(values).fold((0.0, 0.0), |(tt, tv), (t, v)| {
        let dt = t - window.from_s - mean_time;
        (tt + dt * dt, tv + dt * (v - mean))
    });
    Ok(Statistics {
        readings: values.len(),
        mean,
        standard_deviation: (values.len() >= 2).then(|| (squares / (count - 1.0)).sqrt()),
        drift_per_h: (values.len() >= 3).then(|| 3600.0 * moments.1 / moments.0),
        largest_deviation: values.iter().fold(0.0, |most, v| (v - mean).abs().max(most)),
        largest_gap_s,
    })
}

/// The longest gap that the window touches, s, where no gap is longer than the rule.
fn covered(
    times_s: &[f64],
    (first, end): (usize, usize),
    window: Window,
    interval_s: f64,
    longest_gap_s: f64,
) -> Result<f64, NoClimate> {
    let (before, after) = (
        first.checked_sub(1).map(|k| times_s[k]),
        times_s.get(end).copied(),
    );
    let (first_in, last_in) = match (first < end, before, after) {
        (true, ..) => (times_s[first], times_s[end - 1]),
        (false, Some(before), Some(after)) => {
            let gap = after - before;
            return if gap <= allowed(longest_gap_s) {
                Ok(gap)
            } else {
                Err(NoClimate::Gap(gap))
            };
        }
        (false, Some(before), None) => return Err(NoClimate::EndsBefore(window.from_s - before)),
        (false, None, Some(after)) => return Err(NoClimate::BeginsAfter(after - window.to_s)),
        (false, None, None) => return Err(NoClimate::Empty),
    };
    let edge = 1.05 * interval_s.min(longest_gap_s);
    let missing_before = if before.is_none() {
        first_in - window.from_s
    } else {
        0.0
    };
    let missing_after = if after.is_none() {
        window.to_s - last_in
    } else {
        0.0
    };
    if missing_before > edge || missing_after > edge {
        return Err(NoClimate::CoversPart(missing_before + missing_after));
    }
    let all = &times_s[first.saturating_sub(1)..(end + 1).min(times_s.len())];
    let gap = all.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    if gap > allowed(longest_gap_s) {
        return Err(NoClimate::Gap(gap));
    }
    Ok(gap.max(missing_before).max(missing_after))
}

/// The rule with room for a logger's clock that is read to the second.
fn allowed(longest_gap_s: f64) -> f64 {
    longest_gap_s + 1.0
}

/// Value of a series at a time, between two readings that lie no farther apart than the rule.
pub fn interpolated(times_s: &[f64], values: &[f64], at_s: f64, longest_gap_s: f64) -> Option<f64> {
    let next = times_s.partition_point(|&t| t < at_s);
    if times_s.get(next) == Some(&at_s) {
        return Some(values[next]);
    }
    let before = next.checked_sub(1)?;
    let (t0, t1) = (times_s[before], *times_s.get(next)?);
    let weight = (at_s - t0) / (t1 - t0);
    (t1 - t0 <= allowed(longest_gap_s)).then(|| values[before] * (1.0 - weight) + values[next] * weight)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const HOUR: f64 = 3600.0;

    fn of(times_s: &[f64], values: &[f64], from_s: f64, to_s: f64) -> Result<Statistics, NoClimate> {
        statistics((times_s, values), Window { from_s, to_s }, 60.0, HOUR)
    }

    #[test]
    fn a_ramp_has_its_mean_and_drift() {
        let times: Vec<f64> = (0..600).map(|k| f64::from(k) * 60.0).collect();
        let values: Vec<f64> = times.iter().map(|t| 40.0 + 1.5 * t / HOUR).collect();
        let found = of(&times, &values, HOUR, 2.0 * HOUR).unwrap();
        assert_eq!(found.readings, 61);
        assert!((found.mean - 42.25).abs() < 1e-9 && (found.drift_per_h.unwrap() - 1.5).abs() < 1e-9);
        assert!((found.largest_deviation - 0.75).abs() < 1e-9);
        assert_eq!(found.largest_gap_s, 60.0);
    }

    #[test]
    fn a_short_run_between_two_readings_is_interpolated() {
        let found = of(&[0.0, 1000.0], &[40.0, 50.0], 480.0, 520.0).unwrap();
        assert_eq!((found.readings, found.standard_deviation), (0, None));
        assert!((found.mean - 45.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_covered_has_no_value_and_a_reason() {
        let times: Vec<f64> = (0..60).map(|k| f64::from(k) * 60.0).collect();
        let values = vec![40.0; 60];
        assert_eq!(
            of(&times, &values, 4000.0, 5000.0),
            Err(NoClimate::EndsBefore(460.0))
        );
        assert_eq!(
            of(&times, &values, -500.0, -100.0),
            Err(NoClimate::BeginsAfter(100.0))
        );
        assert_eq!(
            of(&times, &values, 3000.0, 5000.0),
            Err(NoClimate::CoversPart(1460.0))
        );
        assert_eq!(of(&[], &[], 0.0, 1.0), Err(NoClimate::Empty));
        let with_gap = [0.0, 60.0, 4000.0, 4060.0];
        assert_eq!(
            of(&with_gap, &[1.0; 4], 30.0, 4030.0),
            Err(NoClimate::Gap(3940.0))
        );
        assert!(NoClimate::Gap(3940.0).words(HOUR).contains("66 min"));
        // A log copied right after the run lacks less than one interval of it.
        assert!(of(&times, &values, 3000.0, 3590.0).is_ok());
    }

    proptest! {
        /// Every mean lies within the readings in and around the window, and a window outside has none.
        #[test]
        fn nothing_is_extrapolated(
            steps in prop::collection::vec((1.0..900.0f64, 0.0..100.0f64), 2..80),
            from in -2000.0..60_000.0f64, length in 1.0..9000.0f64
        ) {
            let mut time = 0.0;
            let times: Vec<f64> = steps.iter().map(|(step, _)| { time += step; time }).collect();
            let values: Vec<f64> = steps.iter().map(|(_, value)| *value).collect();
            let window = Window { from_s: from, to_s: from + length };
            let outside = window.to_s < times[0] || window.from_s > time;
            match statistics((&times, &values), window, 450.0, 600.0) {
                Ok(found) => {
                    prop_assert!(!outside);
                    let (first, end) = readings_in(&times, window);
                    let around = &values[first.saturating_sub(1)..(end + 1).min(values.len())];
                    let least = around.iter().copied().fold(f64::INFINITY, f64::min);
                    let most = around.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                    prop_assert!((least - 1e-9..=most + 1e-9).contains(&found.mean));
                    prop_assert!(found.largest_gap_s <= 601.0);
                }
                Err(_) => {
                    let touched = &times[readings_in(&times, window).0.saturating_sub(1)..];
                    let gap = touched.windows(2).any(|pair| pair[1] - pair[0] > 601.0 && pair[0] <= window.to_s);
                    let inside = window.from_s >= times[0] && window.to_s <= time;
                    prop_assert!(gap || !inside, "a run that is covered has a value");
                }
            }
        }
    }
}
