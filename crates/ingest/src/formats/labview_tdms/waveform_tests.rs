//! Waveforms with clocks of their own: starts, offsets and rates of each channel, and units that stand twice.

use ieap_domain::{Channel, Quantity};

use super::LabviewTdms;
use super::waveform_writer::{START, Wave, wave, written};
use crate::Reading;
use crate::formats::{Format, ReadContext};

fn read(waves: &[Wave]) -> Reading {
    LabviewTdms
        .read(&written(waves), &ReadContext::default())
        .unwrap()
}

fn codes(reading: &Reading) -> Vec<&str> {
    reading.issues.iter().map(|issue| issue.code.as_str()).collect()
}

fn local(reading: &Reading) -> Option<&str> {
    reading.started_at.as_ref()?.local.as_deref()
}

/// Quantity, times and values of a channel.
fn shown(channel: &Channel) -> (Quantity, Vec<f64>, Vec<f64>) {
    (channel.quantity, channel.time_s.to_vec(), channel.values.to_vec())
}

#[test]
fn channels_that_start_at_different_moments_stand_on_one_clock() {
    let bending = Wave {
        start: START + 3,
        offset: 0.25,
        ..wave("Displacement", "mm", 0.5, &[0.0, 0.1])
    };
    let reading = read(&[bending, wave("Voltage", "V", 0.5, &[0.0, 2.0, 2.0])]);
    assert_eq!(codes(&reading), [""; 0]);
    assert_eq!(local(&reading), Some("2026-03-09T14:00:00"));
    let [table] = &reading.tables[..] else {
        panic!("{:#?}", reading.tables)
    };
    let found: Vec<_> = table.channels.iter().map(shown).collect();
    let expected = [
        (Quantity::TipDisplacement, vec![3.25, 3.75], vec![0.0, 0.1]),
        (Quantity::Voltage, vec![0.0, 0.5, 1.0], vec![0.0, 2.0, 2.0]),
    ];
    assert_eq!(found, expected);
    assert_eq!((table.rows, table.time_first_last_s), (3, Some((0.0, 3.75))));
}

#[test]
fn channels_of_different_rates_are_one_run_in_the_order_of_the_file() {
    let reading = read(&[
        wave("Voltage", "V", 0.5, &[0.0, 2.0]),
        wave("Displacement", "mm", 0.25, &[0.0, 0.1, 0.2, 0.3]),
        wave("Current", "A", 0.5, &[1e-3, 2e-3]),
        wave("Current 2", "A", 0.25, &[4e-3]),
        wave("I", "mA", 0.25, &[5.0]),
    ]);
    let [table] = &reading.tables[..] else {
        panic!("{:#?}", reading.tables)
    };
    let found: Vec<_> = table.channels.iter().map(shown).collect();
    let expected = [
        (Quantity::Voltage, vec![0.0, 0.5], vec![0.0, 2.0]),
        (
            Quantity::TipDisplacement,
            vec![0.0, 0.25, 0.5, 0.75],
            vec![0.0, 0.1, 0.2, 0.3],
        ),
        (Quantity::Current, vec![0.0, 0.5], vec![1e-3, 2e-3]),
        (Quantity::Other, vec![0.0], vec![4e-3]),
        // A second current stays in the unit of the file.
        (Quantity::Other, vec![0.0], vec![5.0]),
    ];
    assert_eq!(found, expected);
    assert_eq!(codes(&reading), ["duplicate-quantity"; 2]);
    assert_eq!(
        (table.name.as_str(), table.rows, reading.is_step_response),
        ("", 4, true)
    );
}

#[test]
fn a_unit_that_stands_in_the_name_too_is_one_unit() {
    let reading = read(&[
        wave("Voltage (V)", "Volts", 0.5, &[0.0, 2.0]),
        wave("Current (mA)", "mA", 0.5, &[1.0, 2.0]),
        wave("Displacement (mm)", "um", 0.5, &[1.0, 2.0]),
    ]);
    let channels = &reading.tables[0].channels;
    let found: Vec<_> = channels
        .iter()
        .map(|channel| (channel.quantity, channel.raw_unit.as_str(), channel.values[1]))
        .collect();
    let expected = [
        (Quantity::Voltage, "Volts", 2.0),
        (Quantity::Current, "mA", 2e-3),
        (Quantity::Other, "um", 2.0),
    ];
    assert_eq!(found, expected);
    assert_eq!(codes(&reading), ["column-refused"]);
}

#[test]
fn a_channel_without_a_start_is_placed_only_where_all_others_share_one() {
    let without = || Wave {
        start: 0,
        ..wave("Displacement", "mm", 0.5, &[0.0, 0.1])
    };
    let reading = read(&[wave("Voltage", "V", 0.5, &[0.0, 2.0]), without()]);
    assert_eq!((reading.tables.len(), codes(&reading)), (1, Vec::new()));

    let later = Wave {
        start: START + 3,
        ..wave("Current", "A", 0.5, &[1e-3])
    };
    let reading = read(&[wave("Voltage", "V", 0.5, &[0.0, 2.0]), later, without()]);
    assert_eq!(codes(&reading), ["starts-differ"]);
    let names: Vec<&str> = reading.tables.iter().map(|table| table.name.as_str()).collect();
    assert_eq!(names, ["Run", "Run (2)"]);
    assert_eq!(*reading.tables[0].channels[1].time_s, [3.0]);
}

#[test]
fn a_column_of_times_counts_from_the_start_of_its_own_channels() {
    let time = || wave("Time (s)", "s", 1.0, &[10.0, 11.0]);
    let reading = read(&[time(), wave("Voltage", "V", 1.0, &[0.0, 2.0])]);
    let table = &reading.tables[0];
    assert_eq!(table.time_first_last_s, Some((10.0, 11.0)));
    assert_eq!(
        (local(&reading), codes(&reading)),
        (Some("2026-03-09T14:00:00"), Vec::new())
    );

    // Whether the column counts from its own start or from that of the other channel, nobody said.
    let later = Wave {
        start: START + 3,
        ..wave("Current", "A", 0.5, &[1e-3])
    };
    let reading = read(&[time(), wave("Voltage", "V", 1.0, &[0.0, 2.0]), later]);
    assert_eq!((local(&reading), codes(&reading)), (None, vec!["starts-differ"]));
}
