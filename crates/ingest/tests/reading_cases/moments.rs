//! Dates of a run: beside the time, above the table, in place of it.

use jiff::civil::{DateTime, date};
use jiff::{SignedDuration, Timestamp};

use crate::base_run::{base, power, short, table};
use crate::expected::Expected;
use crate::reads::{is_asked, local_start, moment_of_start, of};

/// The moment of a row of a run that begins at 14:00, 2 s before the step.
fn moment(day: DateTime, t: f64) -> DateTime {
    day + SignedDuration::from_millis(((t + 2.0) * 1000.0) as i64)
}

/// A column that is named `[s]` and counts ms, as the dates beside it show.
pub fn seconds_that_are_ms() -> String {
    let names = "Date Time,Test Time [s],Voltage [V],Current [A],Tip displacement [mm]";
    table(names, &base(), |row| {
        format!(
            "{},{},{:.3},{},{:.4}",
            moment(date(2026, 3, 9).at(14, 0, 0, 0), row.t).strftime("%Y-%m-%d %H:%M:%S%.3f"),
            (row.t + 2.0) * 1000.0,
            row.volts,
            power(row.amperes()),
            row.tip_mm
        )
    })
}

#[test]
fn case_03_a_unit_that_the_dates_contradict_is_asked() {
    is_asked("run.csv", &seconds_that_are_ms(), "elapsed", &["s", "ms"]);
}

/// When the runs of two cases begin.
const START: DateTime = date(2026, 3, 19).at(14, 0, 0, 0);

#[test]
fn case_04_a_date_beside_the_time_is_the_start() {
    let names = "Date and Time,Elapsed (s),Voltage (V),Current (mA)";
    let text = table(names, &base(), |row| {
        let moment = moment(START, row.t).strftime("%Y-%m-%d %H:%M:%S%.6f");
        format!("{moment},{:.2},{:.1},{:.5}", row.t + 2.0, row.volts, row.ma)
    });
    let reading = of("run.csv", text);
    assert_eq!(local_start(&reading), Some("2026-03-19T14:00:00"));
    Expected::run(&base(), 2.0).is_all_of(&reading);
}

#[test]
fn case_04b_a_date_above_the_table_is_the_start() {
    let text = table(
        "# Date: 2026-03-19 14:00:00\ntime_s,voltage_v,current_a",
        &base(),
        |row| format!("{:.1},{:.1},{}", row.t, row.volts, power(row.amperes())),
    );
    let reading = of("run.csv", text);
    assert_eq!(local_start(&reading), Some("2026-03-19T14:00:00"));
    Expected::run(&base(), 0.0).is_all_of(&reading);
}

#[test]
fn case_06_moments_in_utc() {
    let text = table("Timestamp,Current (A),Voltage (V)", &base(), |row| {
        let moment = moment(START, row.t).strftime("%Y-%m-%dT%H:%M:%S%.6fZ");
        format!("{moment},{},{:.1}", short(row.amperes()), row.volts)
    });
    let reading = of("run.csv", text);
    let start: Timestamp = "2026-03-19T14:00:00Z".parse().unwrap();
    assert_eq!(moment_of_start(&reading), Some(start));
    Expected::run(&base(), 2.0).is_all_of(&reading);
}
