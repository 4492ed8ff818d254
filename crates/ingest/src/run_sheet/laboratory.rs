//! Run sheets as laboratories keep them: a workbook or a text with names of columns in any language, titles above the
//! table, cells that are merged, no planned ids. They become the text that the reader of run sheets reads.

use std::collections::BTreeSet;

use super::policy::{
    DELIMITERS, FEWEST_CELLS, LARGEST_BYTES, MOST_COLUMNS, MOST_ROWS, MOST_TITLES, MOSTLY, SAID, WITH,
};
use crate::formats::sheet_cells::{self, Place, SheetCell};
use crate::formats::unpacking;
use crate::name_pattern::number_of_name;
use crate::tags::value::shortest;
use crate::text::decode;
use crate::text::header::{Header, Meaning};
use crate::text::names::sheet_column;
use ieap_domain::Quantity;
use ieap_domain::safe_text::from_csv_text;
use ieap_domain::surroundings::id_of_word;
use ieap_domain::tag::keys;
use ieap_domain::unit;

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

impl Column {
    /// The tag, or `file`.
    fn key(&self) -> &'static str {
        match self {
            Column::Text(key) | Column::Number(key, _) => key,
        }
    }
}

fn column(name: &str) -> Option<Column> {
    if let Some(key) = sheet_column(name) {
        return Some(Column::Text(key));
    }
    let header = Header::parse(name);
    // A unit says it where the name is in a language that is not known.
    let by_unit = || {
        let quantities = [
            Quantity::Voltage,
            Quantity::RelativeHumidity,
            Quantity::Temperature,
        ];
        let of_unit = |quantity: &Quantity| unit::conversion(*quantity, &header.raw_unit).is_ok();
        (!header.raw_unit.is_empty() && header.meaning == Meaning::Other && !name.is_ascii())
            .then(|| quantities.into_iter().find(of_unit))
            .flatten()
    };
    let quantity = header.meaning.named_quantity().or_else(by_unit)?;
    let header = match &header.meaning {
        Meaning::Other => Header {
            meaning: unit::conversion(quantity, &header.raw_unit).map_or(Meaning::Other, |conversion| {
                Meaning::Known { quantity, conversion }
            }),
            ..header
        },
        _ => header,
    };
    let key = match quantity {
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
    grids_of(bytes)?.iter().find_map(|grid| of_grid(grid))
}

/// The cells of each tab of a workbook, or of a text; none of one that is too large or damaged.
pub(super) fn grids_of(bytes: &[u8]) -> Option<Vec<Vec<Vec<String>>>> {
    if bytes.len() as u64 > LARGEST_BYTES {
        return None;
    }
    let is_workbook = bytes.starts_with(b"PK") || bytes.starts_with(&[0xD0, 0xCF, 0x11, 0xE0]);
    Some(if is_workbook {
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
    })
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

/// The table of a sheet: its names, which may stand in two rows of which the upper one heads several of the lower, and its rows.
pub(super) struct Laid<'g> {
    pub names: Vec<Name>,
    pub rows: &'g [Vec<String>],
}

/// The name of a column, and what stands above it.
pub(super) struct Name {
    above: String,
    own: String,
}

impl Name {
    pub fn shown(&self) -> String {
        format!("{} {}", self.above, self.own).trim().to_owned()
    }

    /// What the column states: by both rows of names, else by one of them.
    fn column(&self) -> Option<Column> {
        let parts = [self.shown(), self.own.clone(), self.above.clone()];
        parts.iter().find_map(|name| column(name))
    }
}

/// The rows of a sheet below names that begin at a row, in one row or in two.
pub(super) fn laid(grid: &[Vec<String>], at: usize) -> Vec<Laid<'_>> {
    let cell = |row: usize, column: usize| {
        grid.get(row)
            .and_then(|row| row.get(column))
            .map_or("", |cell| cell.trim())
    };
    let name = |above: &str, own: &str| Name {
        above: above.to_owned(),
        own: own.to_owned(),
    };
    let width = grid[at].len();
    let plain = Laid {
        names: (0..width).map(|column| name("", cell(at, column))).collect(),
        rows: &grid[at + 1..],
    };
    let width = width.max(grid.get(at + 1).map_or(0, Vec::len));
    let mut heading = "";
    let mut names = Vec::new();
    let mut divides = false;
    for column in 0..width {
        let (top, own) = (cell(at, column), cell(at + 1, column));
        // A heading over several columns stands in the first of them, or in all of them where it was merged.
        let is_below_one = top.is_empty() && !own.is_empty();
        divides |= is_below_one || (!top.is_empty() && top == heading && own != top);
        heading = if is_below_one { heading } else { top };
        names.push(match own {
            "" => name("", heading),
            own if own == heading => name("", own),
            own => name(heading, own),
        });
    }
    let is_word = |cell: &String| {
        let cell = cell.trim();
        cell.is_empty() || (cell.parse::<f64>().is_err() && !is_file(cell))
    };
    let is_of_names = divides && grid.get(at + 1).is_some_and(|row| row.iter().all(is_word));
    let stacked = is_of_names.then(|| Laid {
        names,
        rows: &grid[at + 2..],
    });
    stacked.into_iter().chain([plain]).collect()
}

impl Laid<'_> {
    /// The cells of a column that hold anything.
    fn cells(&self, column: usize) -> impl Iterator<Item = &str> {
        let cells = self
            .rows
            .iter()
            .filter_map(move |row| Some(row.get(column)?.trim()));
        cells.filter(|cell| !cell.is_empty())
    }

    /// Whether nearly all cells of a column are so, and there are some.
    fn mostly(&self, column: usize, is_so: impl Fn(&str) -> bool) -> bool {
        let all = self.cells(column).count();
        let so = self.cells(column).filter(|cell| is_so(cell)).count();
        so >= FEWEST_CELLS && so as f64 >= MOSTLY * all as f64
    }

    /// What each column states: by its name, else by what its cells are; of two that state one thing the plainer counts.
    fn columns(&self) -> Vec<Option<Column>> {
        let mut columns: Vec<Option<Column>> = self.names.iter().map(Name::column).collect();
        for (at, column) in columns.iter_mut().enumerate() {
            let names_files = matches!(column, Some(Column::Text("file")));
            if names_files && !self.holds_files(at) {
                *column = None;
            } else if !names_files && self.mostly(at, is_file) {
                *column = Some(Column::Text("file"));
            }
        }
        let has = |columns: &[Option<Column>], key: &str| {
            columns.iter().flatten().any(|column| column.key() == key)
        };
        for at in 0..columns.len() {
            let is_open = columns[at].is_none();
            if is_open
                && !has(&columns, keys::ENVIRONMENT)
                && self.mostly(at, |cell| id_of_word(cell).is_some())
            {
                columns[at] = Some(Column::Text(keys::ENVIRONMENT));
            }
        }
        if !has(&columns, keys::SAMPLE)
            && let Some(at) = self.samples_at(&columns)
        {
            columns[at] = Some(Column::Text(keys::SAMPLE));
        }
        self.leave_doubles(&mut columns);
        columns
    }

    /// Whether the cells of a column that is named so are files: each run has its own, and runs that are still to come have none.
    /// `End Of File` of a logger is an event: one word, which is the name of nothing.
    fn holds_files(&self, at: usize) -> bool {
        let words: BTreeSet<&str> = self.cells(at).collect();
        let is_name = |word: &&str| is_file(word) || word.contains(|c: char| c.is_ascii_digit());
        let mut of_one = words
            .first()
            .into_iter()
            .filter(|word| self.rows.len() == 1 || is_name(word));
        words.len() > 1 || of_one.next().is_some()
    }

    /// The one column whose words are parts of the names of files.
    fn samples_at(&self, columns: &[Option<Column>]) -> Option<usize> {
        let files: Vec<usize> = (0..columns.len())
            .filter(|at| matches!(columns[*at], Some(Column::Text("file"))))
            .collect();
        let is_part = |row: &Vec<String>, cell: &str| {
            let names = files
                .iter()
                .filter_map(|at| row.get(*at))
                .map(|name| name.to_lowercase());
            let cell = cell.to_lowercase();
            cell.contains(char::is_alphabetic) && names.into_iter().any(|name| name.contains(&cell))
        };
        let names_strips = |at: &usize| {
            let rows = self
                .rows
                .iter()
                .filter(|row| row.get(*at).is_some_and(|cell| !cell.trim().is_empty()));
            let (all, parts) = rows.fold((0, 0), |(all, parts), row| {
                (all + 1, parts + usize::from(is_part(row, row[*at].trim())))
            });
            columns[*at].is_none() && parts >= FEWEST_CELLS && parts as f64 >= MOSTLY * f64::from(all)
        };
        let mut found = (0..columns.len()).filter(names_strips);
        found.next().filter(|_| found.next().is_none())
    }

    /// Leaves of two columns of one tag the one with the plainer name; neither where both are as plain and differ.
    fn leave_doubles(&self, columns: &mut [Option<Column>]) {
        for at in 0..columns.len() {
            let Some(key) = columns[at].as_ref().map(Column::key).filter(|key| *key != "file") else {
                continue;
            };
            let twin =
                (at + 1..columns.len()).find(|other| columns[*other].as_ref().map(Column::key) == Some(key));
            if let Some(twin) = twin {
                let words = |at: usize| self.names[at].shown().split_whitespace().count();
                if words(twin) <= words(at) && !self.cells(at).eq(self.cells(twin)) {
                    columns[at] = None;
                }
                if words(twin) >= words(at) {
                    columns[twin] = None;
                }
            }
        }
    }

    /// Whether it is a sheet of runs: a column of files, and one that tells what is measured; none of the program's own sheets.
    fn is_of_runs(&self, columns: &[Option<Column>]) -> bool {
        let is_own = |name: &Name| {
            let plain = from_csv_text(&name.own).to_lowercase();
            plain == "planned" || SAID.contains(&plain.as_str())
        };
        let has = |wanted: &str| columns.iter().flatten().any(|column| column.key() == wanted);
        let tells = [
            keys::SAMPLE,
            keys::ENVIRONMENT,
            keys::VOLTAGE_V,
            keys::RELATIVE_HUMIDITY_PERCENT,
        ];
        !self.names.iter().any(is_own)
            && has("file")
            && tells.iter().any(|key| has(key))
            && !self.is_log(columns)
    }

    /// Whether more rows are readings than name a file: they hold numbers, and neither a file nor of what the run would be.
    fn is_log(&self, columns: &[Option<Column>]) -> bool {
        let holds = |row: &Vec<String>, is_so: &dyn Fn(&Column) -> bool| {
            let of_row = row.iter().zip(columns);
            let mut filled = of_row.filter(|(cell, _)| !cell.trim().is_empty());
            filled.any(|(_, column)| column.as_ref().is_some_and(is_so))
        };
        let is_number = |column: &Column| matches!(column, Column::Number(..));
        let names_run = |column: &Column| ["file", keys::SAMPLE, keys::ENVIRONMENT].contains(&column.key());
        let readings = self
            .rows
            .iter()
            .filter(|row| holds(row, &is_number) && !holds(row, &names_run));
        let files = self
            .rows
            .iter()
            .filter(|row| holds(row, &|column| column.key() == "file"));
        readings.count() > files.count()
    }

    fn rewritten(&self, columns: &[Option<Column>]) -> Option<Rewritten> {
        let unused = self.names.iter().zip(columns);
        let unused = unused.filter(|(name, column)| column.is_none() && !name.shown().is_empty());
        let mut rewritten = Rewritten {
            unused: unused.map(|(name, _)| name.shown()).collect(),
            text: String::new(),
            nameless: 0,
        };
        let used = || {
            columns
                .iter()
                .enumerate()
                .filter_map(|(at, column)| Some((at, column.as_ref()?)))
        };
        let is_file = |column: &Column| column.key() == "file";
        let files: Vec<usize> = used()
            .filter(|(_, column)| is_file(column))
            .map(|(at, _)| at)
            .collect();
        let tags: Vec<(usize, &Column)> = used().filter(|(_, column)| !is_file(column)).collect();
        let mut writer = csv::WriterBuilder::new().delimiter(b'\t').from_writer(Vec::new());
        let head = ["planned", "file", WITH]
            .into_iter()
            .chain(tags.iter().map(|(_, column)| column.key()));
        writer.write_record(head).ok()?;
        for row in self.rows {
            let cell = |at: usize| row.get(at).map_or("", |cell| cell.trim());
            let mut names: Vec<String> = files.iter().map(|at| stem_of(cell(*at))).collect();
            names.retain(|name| !name.is_empty());
            names.dedup();
            if names.is_empty() {
                rewritten.nameless += usize::from(row.iter().any(|cell| !cell.trim().is_empty()));
            }
            let values: Vec<String> = tags.iter().map(|(at, column)| value(column, cell(*at))).collect();
            for (at, name) in names.iter().enumerate() {
                // Of a run in two files the first names the other.
                let other = names.get(1).filter(|_| at == 0).cloned().unwrap_or_default();
                let head = [name.replace(',', "."), name.clone(), other];
                writer.write_record(head.iter().chain(&values)).ok()?;
            }
        }
        rewritten.text = String::from_utf8(writer.into_inner().ok()?).ok()?;
        Some(rewritten)
    }
}

fn of_grid(grid: &[Vec<String>]) -> Option<Rewritten> {
    (0..grid.len().min(MOST_TITLES)).find_map(|at| {
        // A row of names has few cells that are numbers or files.
        let filled = grid[at].iter().filter(|cell| !cell.trim().is_empty());
        // A title may cover all columns.
        let names: BTreeSet<&String> = filled.clone().collect();
        if names.len() < 2
            || filled
                .clone()
                .any(|cell| is_file(cell) || cell.trim().parse::<f64>().is_ok())
        {
            return None;
        }
        laid(grid, at).into_iter().find_map(|laid| {
            let columns = laid.columns();
            laid.is_of_runs(&columns)
                .then(|| laid.rewritten(&columns))
                .flatten()
        })
    })
}

/// Whether a cell is the name of a file, by its ending.
fn is_file(cell: &str) -> bool {
    let cell = cell.trim();
    stem_of(cell).len() < cell.rsplit(['/', '\\']).next().map_or(0, str::len)
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
