//! Cells of a workbook, read sparsely: a cell far out in an empty sheet costs nothing.
//!
//! The only place that gives a workbook to the library that reads it, after its container was looked through: what a
//! stranger wrote into it costs time and memory in proportion to the file.

use crate::text::{Cell, Decimal, number};
use std::collections::BTreeSet;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};

use calamine::{Data, DataRef, ExcelDateTime, ExcelDateTimeType, Reader, Style, Xls, Xlsx, XlsxError};

use super::error::{ReadError, escaped};
use super::{compound, unpacking, workbook_parts, xls_extent};

/// Most cells that are read from one workbook.
const MAX_CELLS: u64 = 10_000_000;
/// Bytes that a cell takes while it is read, a text its own beside them: a workbook's cells may take no more than it may
/// unpack to.
const CELL_BYTES: u64 = 64;

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

/// What a workbook may still hold.
struct Budget {
    cells: u64,
    most_cells: u64,
    text_bytes: u64,
    most_text_bytes: u64,
}

impl Budget {
    /// For a workbook that unpacks to at most `limit` bytes.
    fn of(limit: u64) -> Budget {
        Budget {
            cells: 0,
            most_cells: (limit / CELL_BYTES).min(MAX_CELLS),
            text_bytes: 0,
            most_text_bytes: limit,
        }
    }

    /// Counts a cell.
    fn take(
        &mut self,
        sheet: &str,
        (row, column): Place,
        content: Option<&SheetCell>,
    ) -> Result<(), ReadError> {
        self.cells += 1;
        if let Some(SheetCell::Text(text)) = content {
            self.text_bytes += text.len() as u64;
        }
        if self.text_bytes > self.most_text_bytes {
            return Err(ReadError::TooLarge {
                what: "the texts of the workbook's cells".to_owned(),
                found: self.text_bytes,
                limit: self.most_text_bytes,
            });
        }
        if self.cells <= self.most_cells {
            return Ok(());
        }
        Err(ReadError::SheetTooWide {
            sheet: escaped(sheet),
            row: u64::from(row) + 1,
            column: u64::from(column) + 1,
            limit: self.most_cells,
        })
    }
}

/// What is read of a workbook may unpack to this many bytes, where the caller allows `limit`.
fn limit_of(bytes: &[u8], limit: u64) -> u64 {
    limit.min(unpacking::allowance(bytes.len()))
}

/// The merged cells of each sheet of an .xlsx workbook: the first and the last place that each covers. Other workbooks, and
/// damaged ones, have none that are known.
pub fn merged(bytes: &[u8], limit: u64) -> Vec<Vec<(Place, Place)>> {
    let regions = || -> Option<Vec<Vec<(Place, Place)>>> {
        let mut book = open_xlsx(bytes, limit_of(bytes, limit)).ok()?;
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

/// Whether bytes begin as those of a workbook do.
pub fn is_workbook(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\xD0\xCF\x11\xE0")
}

/// Reads every sheet of an .xlsx or .xls workbook, which may unpack to `limit` bytes, and to no more than a file of its
/// size may.
///
/// # Errors
/// The workbook is damaged, or holds more than any measurement fills.
pub fn read(bytes: &[u8], limit: u64) -> Result<Vec<Sheet>, ReadError> {
    let limit = limit_of(bytes, limit);
    // The library indexes into damaged records here and there; such a file is refused and stops no other one.
    let attempt = catch_unwind(AssertUnwindSafe(|| {
        if bytes.starts_with(b"PK") {
            read_xlsx(bytes, limit)
        } else {
            read_xls(bytes, limit)
        }
    }));
    attempt.unwrap_or_else(|_| Err(broken("spreadsheet", &"its records contradict each other")))
}

/// What the library reads of a workbook, counted: sheets that are one and the same part are unpacked for each of them.
struct Counted<'a> {
    bytes: Cursor<&'a [u8]>,
    left: u64,
}

impl Counted<'_> {
    /// Times that a workbook is read: its parts once to be known and once for their cells, once more for what is merged.
    const TIMES: u64 = 4;
    /// Bytes of the head of a part, which is read for each sheet.
    const HEAD: u64 = 256;

    fn of(bytes: &[u8]) -> Counted<'_> {
        let heads = Counted::HEAD * workbook_parts::MOST_SHEETS as u64;
        Counted {
            bytes: Cursor::new(bytes),
            left: bytes.len() as u64 * Counted::TIMES + heads,
        }
    }
}

impl Read for Counted<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let read = self.bytes.read(into)?;
        self.left = self
            .left
            .checked_sub(read as u64)
            .ok_or_else(|| io::Error::other("its sheets are made of the same parts over and over"))?;
        Ok(read)
    }
}

impl Seek for Counted<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.bytes.seek(to)
    }
}

fn open_xlsx(bytes: &[u8], limit: u64) -> Result<Xlsx<Counted<'_>>, ReadError> {
    // The library looks for a password first, in a compound file: it follows a chain of sectors that loops for ever.
    if !bytes.starts_with(b"PK") {
        return Err(broken("spreadsheet (.xlsx)", &"it is no zip archive"));
    }
    workbook_parts::check(bytes, limit)?;
    Xlsx::new(Counted::of(bytes)).map_err(|error| broken("spreadsheet (.xlsx)", &error))
}

fn read_xlsx(bytes: &[u8], limit: u64) -> Result<Vec<Sheet>, ReadError> {
    let mut book = open_xlsx(bytes, limit)?;
    let mut sheets = Vec::new();
    let mut budget = Budget::of(limit);
    for name in book.sheet_names() {
        // Chart sheets and the like have no cells to read.
        let Ok(mut reader) = book.worksheet_cells_reader(&name) else {
            continue;
        };
        let shows_percent: Vec<bool> = reader.styles().iter().map(shows_percent).collect();
        let mut rows = Vec::new();
        // Cells with a formula and no value, in the order of the sheet.
        let mut uncomputed = Vec::new();
        while let Some(cell) = reader
            .next_cell_with_formula_metadata()
            .map_err(|error| broken("spreadsheet (.xlsx)", &error))?
        {
            let content = from_ref(&cell.value);
            budget.take(&name, cell.pos, content.as_ref())?;
            let (row, column) = cell.pos;
            match content {
                Some(content) => place(&mut rows, row, column, content),
                None if cell.formula.is_some() => uncomputed.push(cell.pos),
                None => {}
            }
        }
        drop(reader);
        if shows_percent.contains(&true) {
            let shown = as_shown(&mut book, &name, &shows_percent, &mut rows);
            shown.map_err(|error| broken("spreadsheet (.xlsx)", &error))?;
        }
        let mut sheet = finish(name, rows);
        sheet.formulas_without_value = first_uncomputed(uncomputed);
        sheets.push(sheet);
    }
    Ok(sheets)
}

/// Whether a style of cells shows percent: 0.45 stands there, and the author sees 45.0 %.
fn shows_percent(style: &Style) -> bool {
    let format = style.number_format.as_ref();
    // What stands in quotes is shown as it is.
    format.is_some_and(|format| {
        format
            .format_code
            .split('"')
            .step_by(2)
            .any(|part| part.contains('%'))
    })
}

/// Makes numbers that are shown in percent what their author sees.
fn as_shown(
    book: &mut Xlsx<Counted<'_>>,
    name: &str,
    shows_percent: &[bool],
    rows: &mut [SheetRow],
) -> Result<(), XlsxError> {
    let mut places = BTreeSet::new();
    let mut reader = book.worksheet_cells_reader(name)?;
    while let Some((row, column, style)) = reader.next_style_id()? {
        if shows_percent[style] {
            places.insert((row.saturating_add(1), column));
        }
    }
    for row in rows {
        for (column, cell) in &mut row.cells {
            if let SheetCell::Number(number) = cell
                && places.contains(&(row.number, *column))
            {
                // 0.07 of a binary number is 7.000000000000001 %.
                *number = (*number * 100.0 * 1e10).round() / 1e10;
            }
        }
    }
    Ok(())
}

/// Formulas whose cells hold no value, their number and the first: programs that write workbooks leave the computing to the
/// one that opens them.
fn first_uncomputed(mut places: Vec<Place>) -> Option<(usize, u32, u32)> {
    places.sort_unstable();
    let (row, column) = *places.first()?;
    Some((places.len(), row.saturating_add(1), column.saturating_add(1)))
}

fn read_xls(bytes: &[u8], limit: u64) -> Result<Vec<Sheet>, ReadError> {
    let in_words = |found: &str| broken("spreadsheet (.xls)", &found);
    let mut stream = compound::stream(bytes, &["Workbook", "Book"]).map_err(in_words)?;
    xls_extent::check(&mut stream, limit)?;
    // The library gets a container that was written here: whatever leads astray in the file's own does not reach it.
    let plain = compound::around("Workbook", &stream);
    drop(stream);
    let mut book: Xls<_> =
        Xls::new(Cursor::new(plain)).map_err(|error| broken("spreadsheet (.xls)", &error))?;
    let mut sheets = Vec::new();
    let mut budget = Budget::of(limit);
    for (name, range) in book.worksheets() {
        let (first_row, first_column) = range.start().unwrap_or((0, 0));
        let mut rows = Vec::new();
        for (row, column, value) in range.used_cells() {
            let (row, column) = (first_row + row as u32, first_column + column as u32);
            let content = from_data(value);
            budget.take(&name, (row, column), content.as_ref())?;
            if let Some(content) = content {
                place(&mut rows, row, column, content);
            }
        }
        sheets.push(finish(name, rows));
    }
    Ok(sheets)
}

fn place(rows: &mut Vec<SheetRow>, row: u32, column: u32, content: SheetCell) {
    let number = row.saturating_add(1);
    match rows.last_mut() {
        Some(last) if last.number == number => last.cells.push((column, content)),
        _ => {
            if let Some(last) = rows.last_mut() {
                last.cells.shrink_to_fit();
            }
            let cells = vec![(column, content)];
            rows.push(SheetRow { number, cells });
        }
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
