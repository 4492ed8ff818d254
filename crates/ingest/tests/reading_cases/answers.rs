//! One answer settles what a file leaves open: the same bytes with it give the values that it means.

use ieap_ingest::formats::{ReadContext, read};
use jiff::civil::date;

use crate::base_run::{base, rows};
use crate::expected::Expected;
use crate::log_expected::{is_series, log_of, log_rows, only_series};
use crate::logs::fractions;
use crate::moments::seconds_that_are_ms;
use crate::reads::{answered, is_asked, local_start, of, only_channel, only_table};
use crate::times::two_fields;

#[test]
fn what_two_fields_of_a_time_are() {
    let run = || Expected::run(&rows(122, -2.0, 1.0), 2.0);
    run().is_all_of(&answered("run.csv", &two_fields(), "clock", "mm:ss"));
    let hours = answered("run.csv", &two_fields(), "clock", "hh:mm");
    run().timed(|minutes| minutes * 60.0).is_all_of(&hours);
}

#[test]
fn which_of_time_and_dates_is_right() {
    for (answer, factor) in [("ms", 1.0), ("s", 1000.0)] {
        let reading = answered("run.csv", &seconds_that_are_ms(), "elapsed", answer);
        Expected::run(&base(), 2.0)
            .with_tip(&base(), 2.0, 0.5e-4)
            .timed(|time| time * factor)
            .is_all_of(&reading);
        assert_eq!(local_start(&reading), Some("2026-03-09T14:00:00"), "{answer}");
    }
}

#[test]
fn whether_a_humidity_is_a_fraction() {
    let rows = log_rows(date(2026, 3, 28).at(23, 0, 0, 0), 60, 300);
    for (answer, factor) in [("fraction", 1.0), ("percent", 0.01)] {
        let log = log_of(&answered("log.csv", &fractions(), "humidity", answer));
        let series = only_series(&log, "", "relative_humidity_percent");
        is_series(series, &rows, 0.0, |row| row.percent * factor);
        is_series(only_series(&log, "", "temperature_c"), &rows, 0.0, |row| {
            row.celsius
        });
    }
}

/// Every number has a comma and three digits behind it: thousands, or decimals.
#[test]
fn whether_a_comma_stands_between_thousands() {
    let text = "Time (s);Voltage (V);Current (uA)\n1;2;9,412\n2;2;8,123\n";
    is_asked("run.csv", text, "decimal", &["point", "comma"]);
    let (thousands, decimals) = ([9.412e-3, 8.123e-3], [9.412e-6, 8.123e-6]);
    for (key, answer, expected) in [
        ("decimal", "point", thousands),
        ("decimal", "comma", decimals),
        ("thousands", "comma", thousands),
        ("thousands", "none", decimals),
    ] {
        let reading = answered("run.csv", text, key, answer);
        let current = only_channel(only_table(&reading), ieap_domain::Quantity::Current);
        assert_eq!(current.time_s.to_vec(), [1.0, 2.0], "{key} = {answer}");
        for (found, expected) in current.values.iter().zip(expected) {
            assert!(
                (found / expected - 1.0).abs() < 1e-12,
                "{key} = {answer}: found {found}, expected {expected}"
            );
        }
    }
}

#[test]
fn an_answer_settles_what_is_open_and_nothing_else() {
    let table = "Time (s);Current (mA)\n0;0,5\n1;0,25\n2;0,125\n";
    let mut answers = ieap_ingest::table::Answers::default();
    for (key, answer) in [
        ("elapsed", "ms"),
        ("decimal", "point"),
        ("clock", "hh:mm"),
        ("humidity", "fraction"),
    ] {
        answers.add(key, answer).unwrap();
    }
    let context = ReadContext {
        answers,
        ..ReadContext::default()
    };
    let plain = read("a.csv", table.as_bytes(), &ReadContext::default()).unwrap();
    let answered = read("a.csv", table.as_bytes(), &context).unwrap();
    assert_eq!(plain.tables, answered.tables);
}

#[test]
fn a_date_above_a_table_is_what_was_answered_of_it() {
    let rows: String = (0..20)
        .map(|k| format!("{k},{},1.5\n", u8::from(k > 4)))
        .collect();
    let text = format!("Gerät 7\nSoros 2026/06/03 10:21:05\nTime (s),Voltage (V),Current (mA)\n{rows}");
    let kind = |reading: &ieap_ingest::Reading| reading.started_at.as_ref().map(|start| start.kind);
    assert_eq!(kind(&of("a.csv", &text)), Some(ieap_ingest::Timestamp::Start));
    assert_eq!(
        kind(&answered("a.csv", &text, "start", "end")),
        Some(ieap_ingest::Timestamp::End)
    );
    assert_eq!(kind(&answered("a.csv", &text, "start", "none")), None);
    // Behind a word for it nothing is open.
    let named = text.replace("Soros", "Start:");
    assert_eq!(
        kind(&answered("a.csv", &named, "start", "none")),
        Some(ieap_ingest::Timestamp::Start)
    );
}
