//! Spreadsheets built cell by cell, with what real ones do: gaps, texts, dates, cells far out, damage.

use proptest::prelude::*;

use super::sheet_writer::Xml::{Date, None as Gap, Number, Percent, Text};
use super::sheet_writer::{Xml, sheet, workbook};
use super::{ReadContext, ReadError, read};
use crate::Reading;
use ieap_domain::{Quantity, RunStatus};

fn read_rows(rows: &[&[Xml<'_>]]) -> Result<Reading, ReadError> {
    read("run.xlsx", &workbook(&[sheet(rows)]), &ReadContext::default())
}

#[test]
fn gaps_and_lone_texts_are_no_numbers() {
    let reading = read_rows(&[
        &[Text("Strip 4, second run")],
        &[],
        &[
            Text("Time (s)"),
            Text("I/mA"),
            Text("kappa (1/m)"),
            Text("remark"),
        ],
        &[Number(0.0), Number(2.0), Number(0.0), Text("start")],
        &[Number(1.0), Number(1.5), Gap, Gap],
        &[Gap, Gap, Gap, Gap],
        &[Number(2.0), Text("lost"), Number(1.0), Gap],
        &[Number(3.0), Text("0.5"), Number(1.5), Gap],
    ])
    .unwrap();
    let table = &reading.tables[0];
    assert_eq!(
        (reading.format, table.rows, table.time_zero_is_step),
        ("spreadsheet", 4, true)
    );
    let [current, curvature] = table.channels.as_slice() else {
        panic!("{:?}", table.columns())
    };
    assert_eq!(
        (&current.time_s[..], &current.values[..]),
        (&[0.0, 1.0, 3.0][..], &[0.002, 0.0015, 0.0005][..])
    );
    assert_eq!(
        (&curvature.time_s[..], &curvature.values[..]),
        (&[0.0, 2.0, 3.0][..], &[0.0, 0.01, 0.015][..])
    );
    let text = reading
        .issues
        .iter()
        .find(|issue| issue.code == "text-in-number-column")
        .unwrap();
    assert_eq!(text.place, "line 7, column 2");
}

#[test]
fn numbers_shown_in_percent_are_what_their_author_sees() {
    let rows: Vec<[Xml<'_>; 3]> = (0..5)
        .map(|k| {
            [
                Date(46100.0 + f64::from(k) / 24.0),
                Number(21.5),
                Percent(0.07 + f64::from(k) / 100.0),
            ]
        })
        .collect();
    let head = [Text("Time"), Text("T (°C)"), Text("RH (%)")];
    let rows: Vec<&[Xml<'_>]> = std::iter::once(&head[..])
        .chain(rows.iter().map(|row| &row[..]))
        .collect();
    let xml = sheet(&rows);
    let humidity = |xml: String| {
        let reading = read("log.xlsx", &workbook(&[xml]), &ReadContext::default()).unwrap();
        let channels = &reading.tables[0].channels;
        channels
            .iter()
            .find(|c| c.quantity == Quantity::RelativeHumidity)
            .unwrap()
            .values
            .to_vec()
    };
    assert_eq!(humidity(xml.clone()), [7.0, 8.0, 9.0, 10.0, 11.0]);
    // What stands in quotes is shown as it is, and says nothing of the number.
    assert_eq!(
        humidity(
            xml.replace(r#"s="3"><v>0.0"#, r#"s="4"><v>0.0"#)
                .replace(r#"s="3"><v>0.1"#, r#"s="4"><v>0.1"#)
                .replace("<v>0.", "<v>4.")
        )[0],
        4.07
    );
}

#[test]
fn dates_are_moments_whatever_unit_stands_above_them() {
    let reading = read_rows(&[
        &[Text("Time (s)"), Text("Current (A)")],
        &[Date(45_000.5), Number(0.001)],
        &[Date(45_000.6), Number(0.002)],
    ])
    .unwrap();
    assert_eq!(reading.tables[0].time_first_last_s, Some((0.0, 8640.0)));
    assert_eq!(
        reading.started_at.unwrap().local.as_deref(),
        Some("2023-03-15T12:00:00")
    );
}

#[test]
fn every_sheet_with_a_run_is_a_table() {
    let rows: &[&[Xml<'_>]] = &[&[Text("time_s"), Text("current_a")], &[Number(0.0), Number(0.5)]];
    let notes: &[&[Xml<'_>]] = &[&[Text("Operator"), Text("somebody")]];
    let bytes = workbook(&[sheet(notes), sheet(rows), sheet(rows)]);
    let reading = read("runs.xlsx", &bytes, &ReadContext::default()).unwrap();
    let names: Vec<&str> = reading.tables.iter().map(|table| table.name.as_str()).collect();
    assert_eq!(
        (names.as_slice(), reading.status),
        (&["Run 2", "Run 3"][..], RunStatus::Complete)
    );
}

#[test]
fn a_nova_export_keeps_its_clock_and_excludes_overloads() {
    let reading = read_rows(&[
        &[
            Text("Time (s)"),
            Text("WE(1).Potential (V)"),
            Text("WE(1).Current (A)"),
            Text("Corrected time (s)"),
            Text("Overload"),
        ],
        &[
            Number(127.25),
            Number(0.5),
            Number(9.5e-5),
            Number(0.0),
            Text("Current overload"),
        ],
        &[
            Number(127.5),
            Number(0.5),
            Number(4.5e-5),
            Number(0.25),
            Text(" "),
        ],
    ])
    .unwrap();
    let table = &reading.tables[0];
    let current = table
        .channels
        .iter()
        .find(|channel| channel.quantity == Quantity::Current)
        .unwrap();
    assert_eq!(
        (&current.excluded[..], table.time_first_last_s),
        (&[0][..], Some((0.0, 0.25)))
    );
    assert!(!table.time_zero_is_step);
    assert!(
        reading.issues[0].message.starts_with("1 of 2 rows"),
        "{:?}",
        reading.issues
    );
}

#[test]
fn a_cell_far_out_costs_nothing() {
    let mut rows = sheet(&[&[Text("time_s"), Text("current_a")], &[Number(0.0), Number(0.5)]]);
    rows.push_str(r#"<row r="1048576"><c r="XFD1048576"><v>1</v></c></row>"#);
    let reading = read("run.xlsx", &workbook(&[rows]), &ReadContext::default()).unwrap();
    assert_eq!(reading.tables[0].rows, 1);
}

#[test]
fn what_is_damaged_or_too_large_is_named() {
    let rows: &[&[Xml<'_>]] = &[&[Text("time_s"), Text("current_a")], &[Number(0.0), Number(0.5)]];
    let bytes = workbook(&[sheet(rows)]);
    let cut = read("run.xlsx", &bytes[..bytes.len() - 30], &ReadContext::default()).unwrap_err();
    assert!(matches!(cut, ReadError::BrokenContainer { .. }), "{cut}");
    let small = ReadContext {
        max_unpacked_bytes: 500,
        ..ReadContext::default()
    };
    assert!(matches!(
        read("run.xlsx", &bytes, &small),
        Err(ReadError::TooLarge { limit: 500, .. })
    ));
    let header: &[&[Xml<'_>]] = &[&[Text("time_s"), Text("current_a")]];
    let waiting = read("run.xlsx", &workbook(&[sheet(header)]), &ReadContext::default()).unwrap_err();
    assert!(waiting.is_pending(), "{waiting}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_damaged_workbook_never_changes_a_number(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let rows: &[&[Xml<'_>]] = &[&[Text("time_s"), Text("current_a")], &[Number(0.25), Number(0.5)]];
        let mut bytes = workbook(&[sheet(rows)]);
        let at = at.index(bytes.len());
        bytes[at] = byte;
        if let Ok(reading) = read("run.xlsx", &bytes, &ReadContext::default()) {
            let current = &reading.tables[0].channels[0];
            prop_assert_eq!((&current.time_s[..], &current.values[..]), (&[0.25][..], &[0.5][..]));
        }
    }
}

#[test]
fn sheets_of_current_and_camera_are_one_run() {
    let current = sheet(&[
        &[Text("Time (s)"), Text("Voltage (V)"), Text("Current (A)")],
        &[Number(0.0), Number(2.0), Number(1e-3)],
        &[Number(1.0), Number(2.0), Number(5e-4)],
        &[Number(2.0), Number(2.0), Number(4e-4)],
    ]);
    let camera = sheet(&[
        &[Text("Time (s)"), Text("Curvature (1/cm)")],
        &[Number(0.5), Number(0.1)],
        &[Number(1.5), Number(0.2)],
        &[Number(2.5), Number(0.3)],
    ]);
    let reading = read(
        "a.xlsx",
        &workbook(&[current.clone(), camera]),
        &ReadContext::default(),
    )
    .unwrap();
    let [run] = reading.tables.as_slice() else {
        panic!("{:?}", reading.tables)
    };
    let quantities: Vec<Quantity> = run.channels.iter().map(|channel| channel.quantity).collect();
    assert_eq!(
        quantities,
        [Quantity::Voltage, Quantity::Current, Quantity::Curvature]
    );
    let times: Vec<f64> = run.channels.iter().map(|channel| channel.time_s[0]).collect();
    assert_eq!(times, [0.0, 0.0, 0.5]);
    assert!(reading.issues.iter().any(|issue| issue.code == "sheets-joined"));
    // Two whole runs stay two.
    let two = read(
        "a.xlsx",
        &workbook(&[current.clone(), current]),
        &ReadContext::default(),
    )
    .unwrap();
    assert_eq!(two.tables.len(), 2);
}
