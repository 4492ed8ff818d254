//! Run sheets as laboratories keep them: a workbook or a text with names of columns in any language, titles above the
//! table, cells that are merged, no planned ids. They become the text that the reader of run sheets reads.

use super::policy::{DELIMITERS, LARGEST_BYTES, SAID};
use crate::formats::sheet_cells::{self, Place, SheetCell};
use crate::formats::unpacking;
use crate::name_pattern::number_of_name;
use crate::tags::value::shortest;
use crate::text::decode;
use crate::text::header::{Header, Meaning};
use crate::text::names::sheet_column;
use ieap_domain::Quantity;
use ieap_domain::safe_text::from_csv_text;
use ieap_domain::tag::keys;

/// Rows above the names that are looked through.
const MOST_TITLES: usize = 30;
/// Rows and columns beyond which nothing is looked for.
const MOST_ROWS: usize = 10_000;
const MOST_COLUMNS: usize = 256;

/// A sheet of a laboratory as the text of a run sheet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Rewritten {
    /// With tabs between the cells, the names of the columns as tags have them in the first line.
    pub text: String,
    /// Columns that are none of a run sheet's.
    pub unused: Vec<String>,
    /// Rows that name no file.
    pub nameless: usize,
}

/// What a column of a laboratory's sheet states.
enum Column {
    /// A tag, or the name of the file.
    Text(&'static str),
    /// A number in this unit.
    Number(&'static str, Header),
}

fn column(name: &str) -> Option<Column> {
    if let Some(key) = sheet_column(name) {
        return Some(Column::Text(key));
    }
    let header = Header::parse(name);
    let key = match header.meaning.named_quantity()? {
        Quantity::Voltage | Quantity::ControlVoltage => keys::VOLTAGE_V,
        Quantity::RelativeHumidity => keys::RELATIVE_HUMIDITY_PERCENT,
        Quantity::Temperature => keys::TEMPERATURE_C,
        Quantity::Pressure => keys::PRESSURE_PA,
        _ => return None,
    };
    Some(Column::Number(key, header))
}

/// Whether a workbook may be one, by its name.
pub(super) fn may_be_workbook(name: &str) -> bool {
    let name = name.to_lowercase();
    [".xlsx", ".xlsm", ".xls"].iter().any(|end| name.ends_with(end))
}

/// The sheet that a workbook or a text of a laboratory holds; none where it is something else, or a run sheet as the
/// program writes it.
pub(super) fn rewritten(bytes: &[u8]) -> Option<Rewritten> {
    if bytes.len() as u64 > LARGEST_BYTES {
        return None;
    }
    let is_workbook = bytes.starts_with(b"PK") || bytes.starts_with(&[0xD0, 0xCF, 0x11, 0xE0]);
    let grids = if is_workbook {
        let merged = sheet_cells::merged(bytes, unpacking::MOST);
        let of = |(at, sheet)| grid(sheet, merged.get(at).map_or(&[], Vec::as_slice));
        sheet_cells::read(bytes, unpacking::MOST)
            .ok()?
            .iter()
            .enumerate()
            .map(of)
            .collect()
    } else {
        grids(bytes)
    };
    grids.iter().find_map(|grid| of_grid(grid))
}

/// The cells of a text under each delimiter that its first line may have.
fn grids(bytes: &[u8]) -> Vec<Vec<Vec<String>>> {
    let text = decode(bytes).text;
    let grid = |delimiter: u8| {
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .has_headers(false)
            .flexible(true)
            .from_reader(text.as_bytes());
        let cells = |record: csv::StringRecord| record.iter().map(str::to_owned).collect();
        reader.records().map_while(Result::ok).map(cells).collect()
    };
    let used = DELIMITERS
        .into_iter()
        .filter(|&delimiter| text.contains(char::from(delimiter)));
    used.map(grid).collect()
}

/// The cells of a sheet as texts; a merged cell stands in all places that it covers.
fn grid(sheet: &sheet_cells::Sheet, merged: &[(Place, Place)]) -> Vec<Vec<String>> {
    let mut grid: Vec<Vec<String>> = Vec::new();
    let mut put = |row: u32, column: u32, text: &str| {
        let (row, column) = (row as usize, column as usize);
        if row >= MOST_ROWS || column >= MOST_COLUMNS {
            return;
        }
        if grid.len() <= row {
            grid.resize(row + 1, Vec::new());
        }
        if grid[row].len() <= column {
            grid[row].resize(column + 1, String::new());
        }
        text.clone_into(&mut grid[row][column]);
    };
    for row in &sheet.rows {
        for (column, cell) in &row.cells {
            let text = match cell {
                SheetCell::Number(number) => shortest(*number),
                SheetCell::Text(text) | SheetCell::Date(text) | SheetCell::Error(text) => text.clone(),
            };
            put(row.number.saturating_sub(1), *column, &text);
            let from = (row.number.saturating_sub(1), *column);
            for (first, last) in merged.iter().filter(|(first, _)| *first == from) {
                for at in first.0..=last.0.min(MOST_ROWS as u32) {
                    (first.1..=last.1.min(MOST_COLUMNS as u32)).for_each(|column| put(at, column, &text));
                }
            }
        }
    }
    grid
}

fn of_grid(grid: &[Vec<String>]) -> Option<Rewritten> {
    let names_at = grid.iter().take(MOST_TITLES).position(|row| is_header(row))?;
    let columns: Vec<Option<Column>> = grid[names_at].iter().map(|name| column(name)).collect();
    let unused = grid[names_at].iter().zip(&columns);
    let unused = unused.filter(|(name, column)| column.is_none() && !name.trim().is_empty());
    let mut rewritten = Rewritten {
        unused: unused.map(|(name, _)| name.trim().to_owned()).collect(),
        text: String::new(),
        nameless: 0,
    };
    let mut writer = csv::WriterBuilder::new().delimiter(b'\t').from_writer(Vec::new());
    let used: Vec<(usize, &Column)> = columns
        .iter()
        .enumerate()
        .filter_map(|(at, column)| Some((at, column.as_ref()?)))
        .collect();
    let key = |column: &Column| match column {
        Column::Text(key) | Column::Number(key, _) => (*key).to_owned(),
    };
    let file_at = used.iter().position(|(_, column)| key(column) == "file")?;
    let head = std::iter::once("planned".to_owned()).chain(used.iter().map(|(_, column)| key(column)));
    writer.write_record(head).ok()?;
    for row in &grid[names_at + 1..] {
        let cell = |at: usize| row.get(at).map_or("", |cell| cell.trim());
        let mut values: Vec<String> = used.iter().map(|(at, column)| value(column, cell(*at))).collect();
        values[file_at] = stem_of(&values[file_at]);
        if values[file_at].is_empty() {
            rewritten.nameless += usize::from(row.iter().any(|cell| !cell.trim().is_empty()));
            continue;
        }
        let planned = values[file_at].replace(',', ".");
        writer.write_record(std::iter::once(planned).chain(values)).ok()?;
    }
    rewritten.text = String::from_utf8(writer.into_inner().ok()?).ok()?;
    Some(rewritten)
}

/// Whether a row names a column of files and one that tells what is measured, and has no column of the program's own sheets.
fn is_header(row: &[String]) -> bool {
    // Every table of readings is asked: what names no column of files costs a look and no more.
    if !row.iter().any(|cell| sheet_column(cell) == Some("file")) {
        return false;
    }
    let plain: Vec<String> = row
        .iter()
        .map(|cell| from_csv_text(cell.trim()).to_lowercase())
        .collect();
    let of_program = plain
        .iter()
        .any(|cell| cell == "planned" || SAID.contains(&cell.as_str()));
    let found: Vec<Column> = row.iter().filter_map(|cell| column(cell)).collect();
    let has = |wanted: &str| {
        let mut keys = found.iter().map(|column| match column {
            Column::Text(key) | Column::Number(key, _) => *key,
        });
        keys.any(|key| key == wanted)
    };
    let tells = [
        keys::SAMPLE,
        keys::ENVIRONMENT,
        keys::VOLTAGE_V,
        keys::RELATIVE_HUMIDITY_PERCENT,
    ];
    !of_program && has("file") && tells.iter().any(|key| has(key))
}

/// The name of a file without its folder and its ending.
fn stem_of(cell: &str) -> String {
    let name = cell.rsplit(['/', '\\']).next().unwrap_or(cell);
    let is_ending = |end: &str| {
        (1..=5).contains(&end.len())
            && end.starts_with(|c: char| c.is_ascii_alphabetic())
            && end.chars().all(char::is_alphanumeric)
    };
    match name.rsplit_once('.') {
        Some((stem, end)) if is_ending(end) => stem.to_owned(),
        _ => name.to_owned(),
    }
}

/// The value of a cell as a tag states it; what is no number stays, and is refused with its place.
fn value(column: &Column, cell: &str) -> String {
    let Column::Number(key, header) = column else {
        return cell.to_owned();
    };
    match (number_of_name(key, cell), &header.meaning) {
        (Some(number), Meaning::Known { conversion, .. }) => shortest(conversion.apply(number)),
        (Some(number), _) => shortest(number),
        (None, _) => cell.to_owned(),
    }
}
