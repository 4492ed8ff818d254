//! TDMS files of waveforms: starts and rates of channels, units that stand twice.

use jiff::Timestamp;

use crate::base_run::{Row, base, noisy, rows};
use crate::expected::Expected;
use crate::reads::{moment_of_start, of};
use crate::waveform_writer::{START, Wave, wave, written};

/// What channels hold is written as it is.
fn exactly(rows: &[Row], step_at_s: f64) -> Expected {
    Expected::run(rows, step_at_s).with_currents_to(0.0)
}

/// A channel of some rows.
fn channel(name: &'static str, unit: &'static str, every_s: f64, rows: &[Row], of: fn(&Row) -> f64) -> Wave {
    let values: Vec<f64> = rows.iter().map(of).collect();
    wave(name, unit, every_s, &values)
}

/// Voltage and current of the noisy run.
fn drive() -> [Wave; 2] {
    [
        channel("Voltage", "V", 0.25, &noisy(), |row| row.volts),
        channel("Current", "A", 0.25, &noisy(), Row::amperes),
    ]
}

/// Reads voltage, current and a bending.
fn with_bending(bending: Wave) -> ieap_ingest::Reading {
    let [voltage, current] = drive();
    let reading = of("run.tdms", written(&[voltage, current, bending]));
    let start: Timestamp = "2026-03-09T14:00:00Z".parse().unwrap();
    assert_eq!(moment_of_start(&reading), Some(start));
    reading
}

#[test]
fn case_13_a_bending_that_starts_later_begins_with_the_step() {
    let bending = rows(501, -2.0, 0.25);
    let later = Wave {
        start: START + 3,
        ..channel("Displacement", "mm", 0.25, &bending, |row| row.tip_mm)
    };
    exactly(&noisy(), 5.0)
        .with_tip(&bending, 5.0, 0.0)
        .lasting_to(128.0)
        .is_all_of(&with_bending(later));
}

#[test]
fn case_13b_channels_of_two_rates_are_one_run() {
    let bending = rows(2501, -5.0, 0.05);
    let faster = channel("Displacement", "mm", 0.05, &bending, |row| row.tip_mm);
    let reading = with_bending(faster);
    exactly(&noisy(), 5.0)
        .with_tip(&bending, 5.0, 0.0)
        .in_rows(2501)
        .is_all_of(&reading);
}

#[test]
fn case_13c_a_unit_that_stands_in_the_name_too() {
    let channels = [
        channel("Voltage (V)", "V", 0.5, &base(), |row| row.volts),
        channel("Current (A)", "A", 0.5, &base(), Row::amperes),
    ];
    exactly(&base(), 2.0).is_all_of(&of("run.tdms", written(&channels)));
}
