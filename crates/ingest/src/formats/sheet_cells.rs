//! Cells of a workbook, read sparsely: a cell far out in an empty sheet costs nothing.

use crate::text::{Cell, Decimal, number};
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use calamine::{Data, DataRef, ExcelDateTime, ExcelDateTimeType, Reader, Xls, Xlsx};

use super::error::{ReadError, escaped};
use super::xls_extent;

/// Most cells that are read from one workbook.
const MAX_CELLS: u64 = 10_000_000;

/// A cell that is not empty.
#[derive(Debug, Clone, PartialEq)]
pub enum SheetCell {
    /// A number; booleans are 1 and 0.
    Number(f64),
    /// A text.
    Text(String),
    /// A date or duration, as text: its number counts days and means nothing beside a unit of seconds.
    Date(String),
    /// An error value such as `#DIV/0!`.
    Error(String),
}

/// A row with its cells in the order of columns.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetRow {
    /// Row number from 1.
    pub number: u32,
    /// Column (from 0) and cell.
    pub cells: Vec<(u32, SheetCell)>,
}

impl SheetRow {
    /// The cell in a column, numbers that stand as text among them, and its text where it has any.
    pub fn cell(&self, column: u32, decimal: Decimal) -> (Cell, &str) {
        let found = self.cells.binary_search_by_key(&column, |(column, _)| *column);
        match found.map(|at| &self.cells[at].1) {
            Ok(SheetCell::Number(number)) => (Cell::Number(*number), ""),
            Ok(SheetCell::Error(text)) => (Cell::NotFinite, text.as_str()),
            Ok(SheetCell::Date(text)) => (Cell::Text, text.as_str()),
            Ok(SheetCell::Text(text)) => (number::parse(text, decimal), text.as_str()),
            Err(_) => (Cell::Empty, ""),
        }
    }
}

/// A sheet with its rows in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Name of the sheet.
    pub name: String,
    /// Rows that hold any cell.
    pub rows: Vec<SheetRow>,
    /// Formulas that no program has computed: how many, and row and column of the first, from 1.
    pub formulas_without_value: Option<(usize, u32, u32)>,
}

/// Row and column, from 0.
pub type Place = (u32, u32);

/// The merged cells of each sheet of an .xlsx workbook: the first and the last place that each covers. Other workbooks, and
/// damaged ones, have none that are known.
pub fn merged(bytes: &[u8]) -> Vec<Vec<(Place, Place)>> {
    let regions = || -> Option<Vec<Vec<(Place, Place)>>> {
        let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).ok()?;
        let names = book.sheet_names();
        let of_sheet = |name: String| {
            let found = book.merge_cells_by_sheet_name(&name).unwrap_or_default();
            found
                .into_iter()
                .map(|region| (region.start, region.end))
                .collect()
        };
        Some(names.into_iter().map(of_sheet).collect())
    };
    catch_unwind(AssertUnwindSafe(regions))
        .ok()
        .flatten()
        .unwrap_or_default()
}

/// Reads every sheet of an .xlsx or .xls workbook.
///
/// # Errors
/// The workbook is damaged, or holds more cells than any measurement fills.
pub fn read(bytes: &[u8]) -> Result<Vec<Sheet>, ReadError> {
    // The library indexes into damaged records here and there; such a file is refused and stops no other one.
    let attempt = catch_unwind(AssertUnwindSafe(|| {
        if bytes.starts_with(b"PK") {
            read_xlsx(bytes)
        } else {
            read_xls(bytes)
        }
    }));
    attempt.unwrap_or_else(|_| Err(broken("spreadsheet", &"its records contradict each other")))
}

fn read_xlsx(bytes: &[u8]) -> Result<Vec<Sheet>, ReadError> {
    let mut book: Xlsx<_> =
        Xlsx::new(Cursor::new(bytes)).map_err(|error| broken("spreadsheet (.xlsx)", &error))?;
    let mut sheets = Vec::new();
    let mut count = 0;
    for name in book.sheet_names() {
        // Chart sheets and the like have no cells to read.
        let Ok(mut reader) = book.worksheet_cells_reader(&name) else {
            continue;
        };
        let mut rows = Vec::new();
        while let Some(cell) = reader
            .next_cell()
            .map_err(|error| broken("spreadsheet (.xlsx)", &error))?
        {
            let (row, column) = cell.get_position();
            count += 1;
            check_count(&name, row, column, count)?;
            if let Some(content) = from_ref(cell.get_value()) {
                place(&mut rows, row, column, content);
            }
        }
        drop(reader);
        let mut sheet = finish(name, rows);
        sheet.formulas_without_value = uncomputed(&mut book, &sheet);
        sheets.push(sheet);
    }
    Ok(sheets)
}

/// Formulas whose cells hold no value: programs that write workbooks leave the computing to the one that opens them.
fn uncomputed(book: &mut Xlsx<Cursor<&[u8]>>, sheet: &Sheet) -> Option<(usize, u32, u32)> {
    let formulas = book.worksheet_formula(&sheet.name).ok()?;
    let (first_row, first_column) = formulas.start()?;
    let holds_value = |row: u32, column: u32| {
        let found = sheet.rows.binary_search_by_key(&(row + 1), |own| own.number);
        found.is_ok_and(|at| sheet.rows[at].cells.iter().any(|(own, _)| *own == column))
    };
    let cells = formulas
        .used_cells()
        .filter(|(_, _, formula)| !formula.is_empty());
    let places = cells.map(|(row, column, _)| (first_row + row as u32, first_column + column as u32));
    let mut empty = places.filter(|(row, column)| !holds_value(*row, *column));
    let (row, column) = empty.next()?;
    Some((1 + empty.count(), row + 1, column + 1))
}

fn read_xls(bytes: &[u8]) -> Result<Vec<Sheet>, ReadError> {
    xls_extent::check(bytes)?;
    let mut book: Xls<_> =
        Xls::new(Cursor::new(bytes)).map_err(|error| broken("spreadsheet (.xls)", &error))?;
    let mut sheets = Vec::new();
    let mut count = 0;
    for (name, range) in book.worksheets() {
        let (first_row, first_column) = range.start().unwrap_or((0, 0));
        let mut rows = Vec::new();
        for (row, column, value) in range.used_cells() {
            let (row, column) = (first_row + row as u32, first_column + column as u32);
            count += 1;
            check_count(&name, row, column, count)?;
            if let Some(content) = from_data(value) {
                place(&mut rows, row, column, content);
            }
        }
        sheets.push(finish(name, rows));
    }
    Ok(sheets)
}

fn check_count(sheet: &str, row: u32, column: u32, count: u64) -> Result<(), ReadError> {
    if count <= MAX_CELLS {
        return Ok(());
    }
    Err(ReadError::SheetTooWide {
        sheet: escaped(sheet),
        row: u64::from(row) + 1,
        column: u64::from(column) + 1,
        limit: MAX_CELLS,
    })
}

fn place(rows: &mut Vec<SheetRow>, row: u32, column: u32, content: SheetCell) {
    let number = row.saturating_add(1);
    match rows.last_mut() {
        Some(last) if last.number == number => last.cells.push((column, content)),
        _ => rows.push(SheetRow {
            number,
            cells: vec![(column, content)],
        }),
    }
}

/// Rows and cells in order: a workbook may store them in any, and may repeat one (the first counts).
fn finish(name: String, mut rows: Vec<SheetRow>) -> Sheet {
    rows.sort_by_key(|row| row.number);
    rows.dedup_by(|next, kept| {
        let is_same = next.number == kept.number;
        if is_same {
            kept.cells.append(&mut next.cells);
        }
        is_same
    });
    for row in &mut rows {
        row.cells.sort_by_key(|(column, _)| *column);
        row.cells.dedup_by_key(|(column, _)| *column);
    }
    Sheet {
        name,
        rows,
        formulas_without_value: None,
    }
}

fn from_ref(value: &DataRef<'_>) -> Option<SheetCell> {
    match value {
        DataRef::SharedString(text) => from_text(text),
        other => from_data(&Data::from(other.clone())),
    }
}

fn from_data(value: &Data) -> Option<SheetCell> {
    Some(match value {
        Data::Int(number) => SheetCell::Number(*number as f64),
        Data::Float(number) => SheetCell::Number(*number),
        Data::Bool(is_true) => SheetCell::Number(f64::from(u8::from(*is_true))),
        Data::String(text) => return from_text(text),
        Data::DateTime(date) if date.is_duration() => SheetCell::Date(format!("duration {}", date.as_f64())),
        Data::DateTime(date) => SheetCell::Date(format!("date {}", day_number(date))),
        Data::DateTimeIso(text) | Data::DurationIso(text) => SheetCell::Date(text.clone()),
        Data::Error(error) => SheetCell::Error(error.to_string()),
        Data::Empty => return None,
    })
}

/// Days since 1899-12-30; some workbooks count theirs from 1904-01-01.
fn day_number(date: &ExcelDateTime) -> f64 {
    const FROM_1904: f64 = 1462.0;
    let from_1900 = ExcelDateTime::new(date.as_f64(), ExcelDateTimeType::DateTime, false);
    if date.is_duration() || date.to_ymd_hms_milli() == from_1900.to_ymd_hms_milli() {
        date.as_f64()
    } else {
        date.as_f64() + FROM_1904
    }
}

fn from_text(text: &str) -> Option<SheetCell> {
    (!text.trim().is_empty()).then(|| SheetCell::Text(text.to_owned()))
}

fn broken(kind: &'static str, error: &dyn std::fmt::Display) -> ReadError {
    ReadError::BrokenContainer {
        kind,
        found: escaped(&error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_counted_from_one_epoch() {
        let days = |days: f64, kind, is_1904| day_number(&ExcelDateTime::new(days, kind, is_1904));
        // 2026-03-01 12:00 under both.
        assert_eq!(days(46082.5, ExcelDateTimeType::DateTime, false), 46082.5);
        assert_eq!(days(44620.5, ExcelDateTimeType::DateTime, true), 46082.5);
        assert_eq!(days(0.25, ExcelDateTimeType::TimeDelta, true), 0.25);
    }
}
