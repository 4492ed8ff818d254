//! Reading a run sheet, strictly: one fault refuses it as a whole, with its place and how to mend it.

use std::collections::BTreeSet;

use super::policy::{DELIMITERS, LARGEST_BYTES, SAID};
use super::{IS_DAMAGED, SheetRow, is_numeric, laboratory};
use crate::scan::composed;
use crate::tags::value::usable;
use crate::text::number::{self, Cell, Decimal};
use crate::text::{Decoded, decode};
use ieap_domain::Issue;
use ieap_domain::safe_text::from_csv_text;
use ieap_domain::tag::keys;

/// Column with the planned id.
const PLANNED: &str = "planned";
/// Column with the name of the file.
const FILE: &str = "file";
/// Columns of a sheet that the program writes, in their order; others are tags, too.
pub const COLUMNS: [&str; 11] = [
    PLANNED,
    FILE,
    keys::SAMPLE,
    keys::ENVIRONMENT,
    keys::RELATIVE_HUMIDITY_PERCENT,
    keys::TEMPERATURE_C,
    keys::VOLTAGE_V,
    "drive",
    keys::REST_BEFORE_S,
    keys::CYCLE,
    "why",
];

/// Reads the rows of a sheet.
///
/// # Errors
/// An issue [`IS_DAMAGED`] for the first fault: a missing column, a row without id or name, a name or an id that stands
/// twice, a name that is none, a number that is none, cells beyond the columns, a quotation that does not end.
pub fn read(bytes: &[u8]) -> Result<Vec<SheetRow>, Issue> {
    if bytes.len() as u64 > LARGEST_BYTES {
        let found = format!("it has {} bytes, more than {LARGEST_BYTES}", bytes.len());
        return Err(damaged(
            "",
            found,
            "save it as a table of planned runs and nothing else",
        ));
    }
    if let Some(own) = laboratory::rewritten(bytes) {
        return rows_of(&own.text);
    }
    let Decoded { text, .. } = decode(bytes);
    rows_of(&text)
}

fn rows_of(text: &str) -> Result<Vec<SheetRow>, Issue> {
    if text.contains('\0') {
        return Err(damaged("", "it is no text", "save it as CSV, not as a workbook"));
    }
    if text.matches('"').count() % 2 == 1 {
        let found = "a quotation mark opens a cell that is never closed";
        return Err(damaged("", found, "close it, or restore the sheet from a copy"));
    }
    let Some(delimiter) = delimiter(text) else {
        let found = "its first line does not name the columns planned and file";
        return Err(damaged(
            "line 1",
            found,
            "write them, or make the sheet again with `ieap plan --sheet`",
        ));
    };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .flexible(true)
        .from_reader(text.as_bytes());
    let not_read = |error: csv::Error| {
        let line = error
            .position()
            .map_or_else(String::new, |at| format!("line {}", at.line()));
        damaged(&line, format!("it cannot be read: {error}"), "restore that line")
    };
    let columns: Vec<String> = reader.headers().map_err(not_read)?.iter().map(named).collect();
    check_columns(&columns)?;
    let mut rows: Vec<SheetRow> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(not_read)?;
        let line = record.position().map_or(0, |at| at.line() as usize);
        if record.iter().all(|cell| cell.trim().is_empty()) {
            continue;
        }
        let row = row(&columns, &record, line, delimiter)?;
        check_distinct(&rows, &row)?;
        rows.push(row);
    }
    Ok(rows)
}

/// Whether the first line of text that is no comment names the columns of a sheet.
pub fn names_columns(head: &[u8]) -> bool {
    delimiter(&decode(head).text).is_some()
}

/// The delimiter under which the first line names the columns of a sheet.
fn delimiter(text: &str) -> Option<u8> {
    let line = text.lines().find(|line| !line.trim().is_empty())?;
    DELIMITERS.into_iter().find(|&delimiter| {
        let cells: BTreeSet<String> = line.split(char::from(delimiter)).map(named).collect();
        cells.contains(PLANNED) && cells.contains(FILE)
    })
}

fn named(cell: &str) -> String {
    from_csv_text(number::unquote(cell)).to_lowercase()
}

fn check_columns(columns: &[String]) -> Result<(), Issue> {
    let mut seen = BTreeSet::new();
    match columns
        .iter()
        .find(|column| !column.is_empty() && !seen.insert(*column))
    {
        Some(twice) => Err(damaged(
            "line 1",
            format!("the column {twice} stands twice"),
            "take one of them away",
        )),
        None => Ok(()),
    }
}

fn check_distinct(rows: &[SheetRow], row: &SheetRow) -> Result<(), Issue> {
    for known in rows {
        let twice = match () {
            () if known.file == row.file => format!("the file \"{}\"", row.file),
            () if known.planned == row.planned => format!("the planned id \"{}\"", row.planned),
            () => continue,
        };
        return Err(damaged(
            &format!("line {}", row.line),
            format!("{twice} stands on line {} already", known.line),
            "give each planned run an id and a file name of its own",
        ));
    }
    Ok(())
}

fn row(
    columns: &[String],
    record: &csv::StringRecord,
    line: usize,
    delimiter: u8,
) -> Result<SheetRow, Issue> {
    let place = format!("line {line}");
    if let Some(beyond) = record
        .iter()
        .skip(columns.len())
        .find(|cell| !cell.trim().is_empty())
    {
        let found = format!(
            "the cell \"{beyond}\" stands beyond the {} columns",
            columns.len()
        );
        return Err(damaged(
            &place,
            found,
            "put cells that hold the delimiter in quotation marks",
        ));
    }
    let values: Vec<String> = record
        .iter()
        .map(|cell| composed(&from_csv_text(cell.trim())))
        .collect();
    let cells = || columns.iter().zip(values.iter().map(String::as_str));
    let cell = |wanted: &str| {
        cells()
            .find(|(column, _)| *column == wanted)
            .map_or("", |(_, cell)| cell)
    };
    let (planned, file) = (cell(PLANNED), cell(FILE));
    for (column, value) in [(PLANNED, planned), (FILE, file)] {
        if value.is_empty() {
            let at = format!("{place}, column {column}");
            return Err(damaged(
                &at,
                "it is empty",
                "every planned run needs an id and the name of its file",
            ));
        }
    }
    if planned.contains(',') {
        let at = format!("{place}, column {PLANNED}");
        return Err(damaged(
            &at,
            "an id has no comma",
            "write letters and digits, such as P01",
        ));
    }
    if file.contains(['/', '\\']) || file == "." || file == ".." {
        let at = format!("{place}, column {FILE}");
        let found = format!("\"{file}\" is no name of a file");
        return Err(damaged(
            &at,
            found,
            "write the name without its folder and its ending",
        ));
    }
    let mut row = SheetRow {
        planned: planned.to_owned(),
        file: file.to_owned(),
        line,
        tags: vec![(keys::PLANNED.to_owned(), planned.to_owned())],
        said: Vec::new(),
    };
    for (column, value) in cells().filter(|(_, value)| !value.is_empty()) {
        match column.as_str() {
            "" | PLANNED | FILE => {}
            said if SAID.contains(&said) => row.said.push((said.to_owned(), value.to_owned())),
            key => {
                let value = tag_value(key, value, delimiter)
                    .map_err(|(found, mend)| damaged(&format!("{place}, column {key}"), found, mend))?;
                row.tags.push((key.to_owned(), value));
            }
        }
    }
    Ok(row)
}

/// The value of a tag, or what is wrong with it and how to mend it.
fn tag_value(key: &str, cell: &str, delimiter: u8) -> Result<String, (String, &'static str)> {
    let value = if is_numeric(key) {
        number_of(cell, delimiter).map(|number| number.to_string())
    } else {
        Some(cell.to_owned())
    };
    let Some(value) = value else {
        let mend = "write one, such as 2.5, or leave the cell empty";
        return Err((format!("\"{cell}\" is no number"), mend));
    };
    // Where the campaign lies is not known here, and any zone shows whether a start is one.
    match usable(key, &value, Some("UTC")) {
        Ok(_) => Ok(value),
        Err(fault) => Err((format!("\"{cell}\" cannot be used: {}", fault.reason), fault.mend)),
    }
}

/// A number with a decimal point or, where commas do not part the cells, a decimal comma.
fn number_of(value: &str, delimiter: u8) -> Option<f64> {
    let signs = match delimiter {
        b',' => [Decimal::Point, Decimal::Point],
        _ => [Decimal::Point, Decimal::Comma],
    };
    signs
        .into_iter()
        .find_map(|sign| match number::parse(value, sign) {
            Cell::Number(number) => Some(number),
            _ => None,
        })
}

fn damaged(place: &str, found: impl Into<String>, mend: &str) -> Issue {
    Issue::error(IS_DAMAGED, format!("the run sheet is not used: {}", found.into()))
        .at(place)
        .mend(format!(
            "{mend}; runs that it tagged before keep their tags until then"
        ))
}
