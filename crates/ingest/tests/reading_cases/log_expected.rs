//! What a logger wrote: temperature and humidity that rise by a step each row.

use ieap_ingest::Reading;
use ieap_ingest::climate_log::{Log, Series, log};
use jiff::SignedDuration;
use jiff::civil::DateTime;

use crate::expected::assert_readings;

/// A row of a log.
#[derive(Debug, Clone, Copy)]
pub struct LogRow {
    /// When, on the logger's clock.
    pub moment: DateTime,
    /// Since the first row, s.
    pub elapsed_s: f64,
    /// Temperature, °C.
    pub celsius: f64,
    /// Relative humidity, %.
    pub percent: f64,
}

/// So many rows; row j has 21 + 0.01 j °C and 45 + 0.1 j %.
pub fn log_rows(first: DateTime, count: u32, every_s: u32) -> Vec<LogRow> {
    let row = |j: u32| LogRow {
        moment: first + SignedDuration::from_secs(i64::from(j * every_s)),
        elapsed_s: f64::from(j * every_s),
        celsius: 21.0 + 0.01 * f64::from(j),
        percent: 45.0 + 0.1 * f64::from(j),
    };
    (0..count).map(row).collect()
}

/// Names and a line for each row.
pub fn log_table(names: &str, rows: &[LogRow], line: impl Fn(&LogRow) -> String) -> String {
    let lines: Vec<String> = rows.iter().map(line).collect();
    format!("{names}\n{}\n", lines.join("\n"))
}

/// The series of a reading.
pub fn log_of(reading: &Reading) -> Log {
    log(reading, "climate/log.csv").unwrap_or_else(|issue| panic!("{}: {}", issue.code, issue.message))
}

/// The only series of a quantity, of those that sensors called `sensor` have.
pub fn only_series<'a>(log: &'a Log, sensor: &str, quantity: &str) -> &'a Series {
    let is_it = |one: &&Series| one.sensor.contains(sensor) && one.quantity.key() == quantity;
    let found: Vec<&Series> = log.series.iter().filter(is_it).collect();
    let [series] = found.as_slice() else {
        let all: Vec<(&str, &str)> = log
            .series
            .iter()
            .map(|one| (one.sensor.as_str(), one.quantity.key()))
            .collect();
        panic!("expected one {quantity} of {sensor:?}, found {all:?}")
    };
    series
}

/// Asserts the readings of a series, with what was rounded when they were written.
pub fn is_series(series: &Series, rows: &[LogRow], rounding: f64, value: impl Fn(&LogRow) -> f64) {
    let readings = &series.readings;
    let found: Vec<(f64, f64)> = readings
        .elapsed_s
        .iter()
        .copied()
        .zip(readings.values.iter().copied())
        .collect();
    let expected: Vec<(f64, f64)> = rows.iter().map(|row| (row.elapsed_s, value(row))).collect();
    assert_readings(series.quantity.key(), &found, &expected, rounding);
}

/// Asserts that the humidity of a log is that of the rows.
pub fn is_humidity(log: &Log, rows: &[LogRow]) {
    is_series(
        only_series(log, "", "relative_humidity_percent"),
        rows,
        0.0,
        |row| row.percent,
    );
}

/// Asserts that temperature and humidity of a log are those of the rows; the temperature is written with so many digits.
pub fn is_climate(log: &Log, rows: &[LogRow], rounding_k: f64) {
    is_humidity(log, rows);
    is_series(only_series(log, "", "temperature_c"), rows, rounding_k, |row| {
        row.celsius
    });
}
