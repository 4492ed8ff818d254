//! Loggers' spreadsheets: a sheet is read as the text between tabs that it would be saved as.
//!
//! Dates are numbers of days in a workbook and are written out year first; a date and a time of day may stand in two
//! columns. Lines are numbered as the rows of the sheet.

use std::collections::BTreeSet;

use super::table;
use crate::Reading;
use crate::formats::ReadError;
use crate::formats::error::quoted;
use crate::formats::sheet_cells::{Sheet, SheetCell, SheetRow};
use crate::formats::stamp;
use crate::text::Line;
use ieap_domain::{DateOrder, Issue, RunStatus};

/// The log in a workbook, for the reader of that id and version; none where no sheet holds the table of a logger. Of
/// several such sheets the first is read.
pub fn log(
    reader: (&'static str, u32),
    date_order: Option<DateOrder>,
    sheets: &[Sheet],
) -> Option<Result<Reading, ReadError>> {
    let mut logs = sheets.iter().filter_map(|sheet| {
        let days = columns_of_days(sheet);
        let texts: Vec<String> = sheet.rows.iter().map(|row| text(row, &days)).collect();
        table::is_log(&lines(sheet, &texts)).then_some((sheet, texts))
    });
    let (sheet, texts) = logs.next()?;
    let left_out = |(other, _): (&Sheet, Vec<String>)| {
        let message = format!(
            "sheet {} is left out: sheet {} is read, and a file is one log",
            quoted(&other.name),
            quoted(&sheet.name)
        );
        Issue::warning("table-refused", message).mend("save each sheet as a file of its own")
    };
    let issues = logs.map(left_out).collect();
    let evidence = "the workbook is whole; the format declares no number of rows".to_owned();
    let status = (RunStatus::Complete, evidence);
    Some(table::read_lines(
        reader,
        None,
        date_order,
        &lines(sheet, &texts),
        status,
        issues,
    ))
}

fn lines<'t>(sheet: &Sheet, texts: &'t [String]) -> Vec<Line<'t>> {
    let rows = sheet.rows.iter().zip(texts);
    rows.map(|(row, text)| Line {
        number: row.number as usize,
        text,
        ended: true,
    })
    .collect()
}

/// Columns whose dates are days without a time, in a sheet whose times of day stand in another column. Where they do
/// not, a whole number of days is a midnight.
fn columns_of_days(sheet: &Sheet) -> BTreeSet<u32> {
    let cells = || sheet.rows.iter().flat_map(|row| &row.cells);
    let dates = || cells().filter_map(|(column, cell)| Some((*column, day_number(cell)?)));
    if !dates().any(|(_, days)| days < 1.0) {
        return BTreeSet::new();
    }
    let with_times: BTreeSet<u32> = dates()
        .filter(|(_, days)| days.fract() != 0.0)
        .map(|(column, _)| column)
        .collect();
    let columns = dates().map(|(column, _)| column);
    columns.filter(|column| !with_times.contains(column)).collect()
}

/// A row with its cells between tabs; the dates of some columns are `days` alone. A cell farther out than tables are
/// wide is left out with those behind it.
fn text(row: &SheetRow, days: &BTreeSet<u32>) -> String {
    const WIDEST: u32 = 4096;
    let mut text = String::new();
    let mut column = 0;
    for (at, cell) in row.cells.iter().take_while(|(at, _)| *at < WIDEST) {
        while column < *at {
            text.push('\t');
            column += 1;
        }
        let date = day_number(cell).and_then(|number| date_text(number, days.contains(at)));
        text += &match (date, cell) {
            (Some(date), _) => date,
            (None, SheetCell::Number(number)) => number.to_string(),
            (None, SheetCell::Text(text) | SheetCell::Date(text) | SheetCell::Error(text)) => {
                let plain = text.replace(|c: char| c.is_control() || c == '"', " ");
                plain.trim().to_owned()
            }
        };
    }
    text
}

/// The days of `date 46082.5`, as cells of dates are kept.
fn day_number(cell: &SheetCell) -> Option<f64> {
    match cell {
        SheetCell::Date(date) => date.strip_prefix("date ")?.parse().ok(),
        _ => None,
    }
}

/// `2026-03-01 12:00:00`, or the day alone; the time alone where there is no day.
fn date_text(days: f64, is_day: bool) -> Option<String> {
    let moment = stamp::from_day_number(days, true)?;
    let clock = match moment.subsec_nanosecond() {
        0 => moment.strftime("%H:%M:%S").to_string(),
        _ => moment.strftime("%H:%M:%S.%3f").to_string(),
    };
    Some(match (days < 1.0, is_day) {
        (true, _) => clock,
        (false, true) => moment.date().to_string(),
        (false, false) => format!("{} {clock}", moment.date()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Quantity;

    fn sheet(name: &str, rows: &[&[SheetCell]]) -> Sheet {
        let cells = |cells: &[SheetCell]| (0..).zip(cells.iter().cloned()).collect();
        let rows = (1..).zip(rows).map(|(number, row)| SheetRow {
            number,
            cells: cells(row),
        });
        Sheet {
            name: name.to_owned(),
            rows: rows.collect(),
        }
    }

    fn word(text: &str) -> SheetCell {
        SheetCell::Text(text.to_owned())
    }

    fn date(days: f64) -> SheetCell {
        SheetCell::Date(format!("date {days}"))
    }

    fn read(sheets: &[Sheet]) -> Result<Reading, ReadError> {
        log(("spreadsheet", 3), None, sheets).unwrap()
    }

    #[test]
    fn dates_that_are_numbers_are_read_in_one_column_and_in_two() {
        let number = SheetCell::Number;
        let one = sheet(
            "Log",
            &[
                &[word("Serial number"), word("42")],
                &[word("Date Time"), word("Temperature (°C)"), word("RH (%)")],
                &[date(46082.0 + 1430.0 / 1440.0), number(21.5), number(40.125)],
                &[date(46083.0), number(21.25), number(41.0)],
            ],
        );
        let two = sheet(
            "Log",
            &[
                &[
                    word("Date"),
                    word("Time"),
                    word("Temperature (°C)"),
                    word("RH (%)"),
                ],
                &[date(46082.0), date(1430.0 / 1440.0), number(21.5), number(40.125)],
                &[date(46083.0), date(0.0), number(21.25), number(41.0)],
            ],
        );
        for one in [one, two] {
            let reading = read(&[one]).unwrap();
            let start = reading.started_at.clone().unwrap();
            assert_eq!(start.local.as_deref(), Some("2026-03-01T23:50:00"));
            let channels = &reading.tables[0].channels;
            let humidity = channels
                .iter()
                .find(|c| c.quantity == Quantity::RelativeHumidity)
                .unwrap();
            assert_eq!(
                (&humidity.time_s[..], &humidity.values[..]),
                (&[0.0, 600.0][..], &[40.125, 41.0][..])
            );
            assert!(reading.issues.is_empty(), "{:?}", reading.issues);
        }
    }

    #[test]
    fn other_sheets_are_no_log_and_a_second_log_is_pointed_out() {
        let rows: [&[SheetCell]; 2] = [&[word("Time (s)"), word("RH (%)")], &[SheetCell::Number(0.0)]];
        assert!(log(("spreadsheet", 3), None, &[sheet("a", &rows)]).is_none());
        let rows: [&[SheetCell]; 2] = [
            &[word("Date Time"), word("RH (%)")],
            &[date(46082.5), SheetCell::Number(40.0)],
        ];
        let reading = read(&[sheet("a", &rows), sheet("b", &rows)]).unwrap();
        assert!(reading.issues.iter().any(|issue| issue.message.contains("\"b\"")));
    }

    #[test]
    fn texts_cannot_make_cells_of_their_own() {
        let rows: [&[SheetCell]; 1] = [&[word("a\tb\n\"c"), SheetCell::Number(-0.1), word("x")]];
        assert_eq!(
            text(&sheet("a", &rows).rows[0], &BTreeSet::new()),
            "a b  c\t-0.1\tx"
        );
        let far = SheetRow {
            number: 1,
            cells: vec![(1, word("a")), (u32::MAX, word("b"))],
        };
        assert_eq!(text(&far, &BTreeSet::new()), "\ta");
    }
}
