//! What a four-point probe says of the electrodes of a strip: the resistance that a run had, and its course over time.

use ieap_domain::number::fixed;

mod course;
mod reading;
pub mod view;
mod words;

pub use course::{Course, course};
pub use reading::{DAY_S, ProbeReading, ProbeSeries};
pub use words::{cracks, life};

/// A reading outside the others stands for a run as many days before or after it: within a week a strip that is kept and not
/// used changes less than the probe sees; what a run itself does to it is seen by a reading after it.
pub const HOLDS_DAYS: f64 = 7.0;
/// What a run had.
#[derive(Debug, Clone, PartialEq)]
pub struct AtRun {
    /// Resistance, Ohm per square.
    pub ohm_per_sq: f64,
    /// Its standard error; none where no reading has one.
    pub error_ohm_per_sq: Option<f64>,
    /// Flexings so far.
    pub flexings: Option<f64>,
    /// What it rests on, in words.
    pub rests_on: String,
}

/// The resistance at the start of a run: between two readings on a line, with the change between them as an even
/// uncertainty, for a crack may have come at any time; outside them the nearest reading, [`HOLDS_DAYS`] long.
///
/// # Errors
/// Why there is none.
pub fn at_run(readings: &[ProbeReading], start_s: f64) -> Result<AtRun, String> {
    let after = readings.iter().position(|reading| reading.at_s >= start_s);
    match after {
        Some(after) if after > 0 => Ok(between(&readings[after - 1], &readings[after], start_s)),
        other => {
            let nearest = other.map_or_else(|| readings.last(), |first| readings.get(first));
            let nearest = nearest.ok_or("there is no reading")?;
            let days = (nearest.at_s - start_s) / DAY_S;
            let side = if days >= 0.0 { "after" } else { "before" };
            if days.abs() > HOLDS_DAYS {
                return Err(format!(
                    "the nearest reading of the probe is {} days {side} the run's start, more than {}",
                    fixed(days.abs(), 0),
                    fixed(HOLDS_DAYS, 0)
                ));
            }
            Ok(AtRun {
                ohm_per_sq: nearest.ohm_per_sq,
                error_ohm_per_sq: nearest.error_ohm_per_sq,
                flexings: nearest.flexings,
                rests_on: format!(
                    "probe, the reading {} days {side} the start",
                    fixed(days.abs(), 1)
                ),
            })
        }
    }
}

fn between(before: &ProbeReading, after: &ProbeReading, start_s: f64) -> AtRun {
    let part = (start_s - before.at_s) / (after.at_s - before.at_s);
    let on_line = |a: f64, b: f64| a + part * (b - a);
    let change = after.ohm_per_sq - before.ohm_per_sq;
    let own = |error: Option<f64>, weight: f64| (weight * error.unwrap_or(0.0)).powi(2);
    let read = own(before.error_ohm_per_sq, 1.0 - part) + own(after.error_ohm_per_sq, part);
    // An even distribution of that width has a variance of a twelfth of its square.
    let error = (read + change * change / 12.0).sqrt();
    AtRun {
        ohm_per_sq: on_line(before.ohm_per_sq, after.ohm_per_sq),
        error_ohm_per_sq: (error > 0.0).then_some(error),
        flexings: before
            .flexings
            .zip(after.flexings)
            .map(|(a, b)| on_line(a, b).round()),
        rests_on: format!(
            "probe, between readings {} days before and {} days after the start",
            fixed((start_s - before.at_s) / DAY_S, 1),
            fixed((after.at_s - start_s) / DAY_S, 1)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(day: f64, ohm_per_sq: f64, error: Option<f64>) -> ProbeReading {
        ProbeReading {
            at_s: day * DAY_S,
            ohm_per_sq,
            error_ohm_per_sq: error,
            flexings: Some(100.0 * day),
            humidity_percent: None,
        }
    }

    #[test]
    fn a_run_between_two_readings_lies_between_them_and_knows_the_change() {
        let readings = [reading(0.0, 2.0, Some(0.1)), reading(10.0, 3.2, Some(0.1))];
        let found = at_run(&readings, 5.0 * DAY_S).unwrap();
        assert!((found.ohm_per_sq - 2.6).abs() < 1e-12);
        // 1.2 over the root of 12, and the mean of two readings.
        let error = (1.44 / 12.0 + 0.005f64).sqrt();
        assert!((found.error_ohm_per_sq.unwrap() - error).abs() < 1e-12);
        assert_eq!(found.flexings, Some(500.0));
    }

    #[test]
    fn nothing_is_extrapolated_beyond_a_week_and_no_error_made_up() {
        let readings = [reading(0.0, 2.0, None)];
        let near = at_run(&readings, 3.0 * DAY_S).unwrap();
        assert_eq!((near.ohm_per_sq, near.error_ohm_per_sq), (2.0, None));
        assert!(at_run(&readings, -3.0 * DAY_S).is_ok());
        for day in [8.0, -8.0] {
            assert!(at_run(&readings, day * DAY_S).unwrap_err().contains("8 days"));
        }
        let same = [reading(0.0, 2.0, None), reading(10.0, 2.0, None)];
        assert_eq!(at_run(&same, DAY_S).unwrap().error_ohm_per_sq, None);
        assert!(at_run(&[], 0.0).is_err());
    }
}
