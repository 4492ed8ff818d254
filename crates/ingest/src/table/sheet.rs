//! Sheets of workbooks as the text between tabs that they would be saved as, so that one reader reads both.
//!
//! Dates are numbers of days in a workbook and are written out year first; a date and a time of day may stand in two
//! columns. Lines are numbered as the rows of the sheet.

use std::collections::BTreeSet;

use crate::formats::sheet_cells::{Sheet, SheetCell, SheetRow};
use crate::formats::stamp;
use crate::text::{Cell, Decimal, Line, number};

/// The rows of a sheet as texts with tabs between the cells, at most `columns` of them.
pub fn texts(sheet: &Sheet, columns: usize) -> Vec<String> {
    let days = columns_of_days(sheet);
    let decimal = decimal_of_texts(
        sheet
            .rows
            .iter()
            .flat_map(|row| row.cells.iter().map(|(_, cell)| cell)),
    );
    sheet
        .rows
        .iter()
        .map(|row| text(row, &days, decimal, columns as u32))
        .collect()
}

/// The same as lines, with the numbers of their rows.
pub fn lines<'t>(sheet: &Sheet, texts: &'t [String]) -> Vec<Line<'t>> {
    let rows = sheet.rows.iter().zip(texts);
    rows.map(|(row, text)| Line {
        number: row.number as usize,
        text,
        ended: true,
    })
    .collect()
}

/// Decimal sign of numbers that a sheet stores as text: a comma where only that makes them numbers.
pub fn decimal_of_texts<'a>(cells: impl Iterator<Item = &'a SheetCell>) -> Decimal {
    let (mut point, mut comma) = (false, false);
    for cell in cells {
        if let SheetCell::Text(text) = cell {
            let reads = |decimal| matches!(number::parse(text, decimal), Cell::Number(_));
            let (as_point, as_comma) = (reads(Decimal::Point), reads(Decimal::Comma));
            point |= as_point && !as_comma;
            comma |= as_comma && !as_point;
        }
    }
    if comma && !point {
        Decimal::Comma
    } else {
        Decimal::Point
    }
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
fn text(row: &SheetRow, days: &BTreeSet<u32>, decimal: Decimal, columns: u32) -> String {
    const WIDEST: u32 = 4096;
    let mut text = String::new();
    let mut column = 0;
    let last = if columns < WIDEST {
        columns.saturating_sub(1)
    } else {
        0
    };
    for (at, cell) in row.cells.iter().take_while(|(at, _)| *at < WIDEST.min(columns)) {
        while column < *at {
            text.push('\t');
            column += 1;
        }
        let date = day_number(cell).and_then(|number| date_text(number, days.contains(at)));
        let duration = duration_text(cell);
        text += &match (date.or(duration), cell) {
            (Some(date), _) => date,
            (None, SheetCell::Number(number)) => number.to_string(),
            // A number that a sheet stores as text has the decimal sign of its author.
            (None, SheetCell::Text(text))
                if decimal == Decimal::Comma && matches!(number::parse(text, decimal), Cell::Number(_)) =>
            {
                text.trim().replace(',', ".")
            }
            (None, SheetCell::Text(text) | SheetCell::Date(text)) => plain(text),
            // No number, whatever went wrong.
            (None, SheetCell::Error(_)) => "NaN".to_owned(),
        };
    }
    while column < last {
        text.push('\t');
        column += 1;
    }
    text
}

/// A text as it stands between tabs.
pub fn plain(text: &str) -> String {
    let plain = text.replace(|c: char| c.is_control() || c == '"', " ");
    plain.trim().to_owned()
}

/// The days of `date 46082.5`, as cells of dates are kept.
fn day_number(cell: &SheetCell) -> Option<f64> {
    match cell {
        SheetCell::Date(date) => date.strip_prefix("date ")?.parse().ok(),
        _ => None,
    }
}

/// `27:00:00.5` of a cell that holds a duration.
fn duration_text(cell: &SheetCell) -> Option<String> {
    let SheetCell::Date(text) = cell else {
        return None;
    };
    let days: f64 = text.strip_prefix("duration ")?.parse().ok()?;
    let milliseconds = (days.abs() * 86_400_000.0).round() as u64;
    let (seconds, rest) = (milliseconds / 1000, milliseconds % 1000);
    let sign = if days < 0.0 { "-" } else { "" };
    let fraction = if rest == 0 {
        String::new()
    } else {
        format!(".{rest:03}")
    };
    Some(format!(
        "{sign}{:02}:{:02}:{:02}{fraction}",
        seconds / 3600,
        seconds / 60 % 60,
        seconds % 60
    ))
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

    fn word(text: &str) -> SheetCell {
        SheetCell::Text(text.to_owned())
    }

    fn date(days: f64) -> SheetCell {
        SheetCell::Date(format!("date {days}"))
    }

    fn sheet(rows: &[&[SheetCell]]) -> Sheet {
        let cells = |cells: &[SheetCell]| (0..).zip(cells.iter().cloned()).collect();
        let rows = (1..).zip(rows).map(|(number, row)| SheetRow {
            number,
            cells: cells(row),
        });
        Sheet {
            name: "a".to_owned(),
            rows: rows.collect(),
            formulas_without_value: None,
        }
    }

    #[test]
    fn dates_durations_and_numbers_are_written_out() {
        let rows: [&[SheetCell]; 2] = [
            &[
                date(46082.0),
                date(1430.0 / 1440.0),
                SheetCell::Date("duration 1.125".to_owned()),
            ],
            &[
                date(46083.0),
                date(0.0),
                word("0,5"),
                SheetCell::Error("#DIV/0!".to_owned()),
            ],
        ];
        let written = texts(&sheet(&rows), usize::MAX);
        assert_eq!(
            written,
            ["2026-03-01\t23:50:00\t27:00:00", "2026-03-02\t00:00:00\t0.5\tNaN"]
        );
    }

    #[test]
    fn texts_cannot_make_cells_of_their_own() {
        let rows: [&[SheetCell]; 1] = [&[word("a\tb\n\"c"), SheetCell::Number(-0.1), word("x")]];
        assert_eq!(texts(&sheet(&rows), usize::MAX), ["a b  c\t-0.1\tx"]);
        let far = Sheet {
            rows: vec![SheetRow {
                number: 1,
                cells: vec![(1, word("a")), (u32::MAX, word("b"))],
            }],
            ..sheet(&[])
        };
        assert_eq!(texts(&far, usize::MAX), ["\ta"]);
    }
}
