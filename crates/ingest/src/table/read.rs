//! The rows of a table: its numbers, and the texts of columns that hold none.

use std::collections::BTreeMap;

use jiff::civil::DateTime;

use super::dates_above::{Dated, dated};
use super::kind::{self, Kind};
use super::layout::{self, Layout};
use super::numbers;
use super::order::orders;
use crate::StartedAt;
use crate::formats::ReadContext;
use crate::formats::cells::CellTable;
use crate::formats::climate::moments::{NoOrder, moments};
use crate::formats::error::ReadError;
use crate::formats::policy::GAP_FACTOR;
use crate::formats::stamp::{self, DateOrder};
use crate::text::Line;
use crate::text::grid::push_line_in;
use crate::text::header::Header;
use crate::text::names::is_unit_of_time;
use crate::text::number::unquote;
use ieap_domain::Quantity;
use ieap_numerics::robust::upper_median;

/// A table of cells with what its columns are named.
#[derive(Debug)]
pub struct Table<'a> {
    /// How it is written and where it stands.
    pub layout: Layout,
    /// The columns as their names and units describe them.
    pub headers: Vec<Header>,
    /// Their numbers.
    pub cells: CellTable,
    /// The texts of columns that hold no numbers, one for each row.
    texts: BTreeMap<usize, Vec<&'a str>>,
    /// The cells of the first row, as the file has them.
    pub first_row: Vec<&'a str>,
    /// The full dates above the table that can be read in one order: witnesses of numbers that are moments.
    pub dates_above: Vec<DateTime>,
}

/// What was settled of the times of a table; the column that times it holds seconds now, or numbers in its unit.
#[derive(Debug, Default)]
pub struct Settled {
    /// When the file began, by the dates of its rows.
    pub started_at: Option<StartedAt>,
    /// Whether rows are timed by dates, from the first.
    pub is_clock: bool,
    /// Columns that are spent on that: dates and times of day.
    pub spent: Vec<usize>,
    /// Where the clock was set back: time since the first row and by how much, s.
    pub set_back: Vec<(f64, f64)>,
}

/// Reads the rows of a layout: those of lines in `part`. `keeps_words` says which columns hold words that mean something.
pub fn read<'a>(
    lines: &[Line<'a>],
    layout: &Layout,
    part: std::ops::Range<usize>,
    keeps_words: impl Fn(&Header) -> bool,
) -> Table<'a> {
    let headers = layout.headers();
    let shape = &layout.shape;
    let header_line = shape.names_at.map_or(0, |at| lines[at].number);
    let is_text: Vec<bool> = shape
        .kinds
        .iter()
        .map(|kind| matches!(kind, Kind::Moment | Kind::Date | Kind::Clock | Kind::Word))
        .collect();
    let keep_text: Vec<bool> = headers.iter().map(keeps_words).collect();
    let mut cells = CellTable::new(header_line, &keep_text, part.len());
    let mut texts: BTreeMap<usize, Vec<&str>> = BTreeMap::new();
    let text_columns: Vec<usize> = (0..is_text.len()).filter(|column| is_text[*column]).collect();
    let mut first_row = Vec::new();
    for line in lines[part].iter().filter(|line| !layout.is_no_reading(line.text)) {
        if first_row.is_empty() {
            layout
                .dialect
                .delimiter
                .split(line.text, |_, text| first_row.push(unquote(text)));
        }
        push_row(&mut cells, *line, layout);
        if text_columns.is_empty() {
            continue;
        }
        for column in &text_columns {
            texts.entry(*column).or_default().push("");
        }
        layout.dialect.delimiter.split(line.text, |index, text| {
            if is_text.get(index) == Some(&true)
                && let Some(last) = texts.get_mut(&index).and_then(|texts| texts.last_mut())
            {
                *last = unquote(text);
            }
        });
    }
    if let Some(stated) = &layout.stated {
        stated.scale(&mut cells);
    }
    // Names may be taken over several lines, the date's among them.
    let above: Vec<&str> = lines[..shape.data_at.min(lines.len())]
        .iter()
        .take(LINES_ABOVE)
        .map(|line| line.text)
        .collect();
    Table {
        dates_above: dates_of(&above),
        headers,
        first_row,
        layout: layout.clone(),
        cells,
        texts,
    }
}

/// Lines above a table in which dates are looked for. Chosen.
const LINES_ABOVE: usize = 200;

fn dates_of(above: &[&str]) -> Vec<DateTime> {
    let read = |dated: &Dated<'_>| match orders(&dated.date)[..] {
        [order] => stamp::civil(&dated.date, order),
        _ => None,
    };
    dated(above).iter().filter_map(read).collect()
}

/// Adds a row; one that ends early where columns may be left away is whole.
fn push_row(cells: &mut CellTable, line: Line<'_>, layout: &Layout) {
    let is_short = || layout.dialect.delimiter.split(line.text, |_, _| {}) < layout.shape.names.len();
    if !layout.shape.ends_early || !is_short() {
        push_line_in(cells, line, layout.dialect, &layout.own_numbers);
        return;
    }
    let ragged = cells.ragged.clone();
    push_line_in(cells, line, layout.dialect, &layout.own_numbers);
    cells.ragged = ragged;
}

impl Table<'_> {
    /// What a column holds.
    pub fn kind(&self, column: usize) -> Kind {
        self.layout
            .shape
            .kinds
            .get(column)
            .copied()
            .unwrap_or(Kind::Empty)
    }

    /// The texts of a column, one for each row; empty ones where it holds numbers.
    pub fn texts_of(&self, column: usize) -> Vec<&str> {
        self.texts
            .get(&column)
            .cloned()
            .unwrap_or_else(|| vec![""; self.cells.rows()])
    }

    /// Puts the last row first.
    pub fn reverse(&mut self) {
        for column in &mut self.cells.columns {
            let rows = column.numbers.len() as u32;
            column.numbers.reverse();
            column.texts.reverse();
            column
                .texts
                .iter_mut()
                .for_each(|(row, _)| *row = rows - 1 - *row);
        }
        self.cells.line_of_row.reverse();
        self.texts.values_mut().for_each(|texts| texts.reverse());
    }

    /// Takes away columns that were spent on the time.
    pub fn drop_columns(&mut self, spent: &[usize]) {
        let mut spent = spent.to_vec();
        spent.sort_unstable();
        for column in spent.into_iter().rev() {
            self.headers.remove(column);
            self.cells.columns.remove(column);
        }
    }

    /// Whether cells of a column are texts that are numbers in another form than the table's.
    fn holds_other_numbers(&self) -> bool {
        let first = |column: &crate::formats::cells::CellColumn| column.text.first.clone();
        self.cells
            .columns
            .iter()
            .filter_map(first)
            .any(|(_, text)| kind::pattern(&text).is_some_and(|found| numbers::is_readable(&found)))
    }
}

/// Whether the elapsed time of parts under the same names goes on from each to the next: then nothing started anew.
fn goes_on(whole: &Table<'_>, parts: &[Table<'_>]) -> bool {
    let is_elapsed = |column: &usize| {
        let header = &whole.headers[*column];
        whole.kind(*column) == Kind::Number
            && (header.meaning.named_quantity() == Some(Quantity::Time) || is_unit_of_time(&header.raw_name))
    };
    let Some(column) = (0..whole.headers.len()).find(is_elapsed) else {
        return false;
    };
    let numbers = &whole.cells.columns[column].numbers;
    let mut at = 0;
    let starts = parts.iter().map(|part| {
        at += part.cells.rows();
        at
    });
    starts
        .take(parts.len() - 1)
        .all(|at| numbers[at] > numbers[at - 1])
}

/// Whether the dates of parts under the same names go on from each to the next: with no longer pause than `pause` usual steps
/// between two of them, where that is asked.
pub fn dates_go_on(whole: &Table<'_>, parts: &[Table<'_>], pause: Option<f64>) -> bool {
    let of_kind = |kind: Kind| (0..whole.headers.len()).find(|column| whole.kind(*column) == kind);
    let texts: Vec<String> = match (of_kind(Kind::Moment), of_kind(Kind::Date), of_kind(Kind::Clock)) {
        (Some(column), ..) => whole
            .texts_of(column)
            .iter()
            .map(|text| (*text).to_owned())
            .collect(),
        (None, Some(date), Some(clock)) => (whole.texts_of(date).iter())
            .zip(whole.texts_of(clock))
            .map(|(date, clock)| format!("{date} {clock}"))
            .collect(),
        _ => return false,
    };
    let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
    let found = match moments(&texts, &DateOrder::ALL) {
        Err(NoOrder::Several(orders)) => moments(&texts, &orders[..1]),
        found => found,
    };
    let Ok(found) = found else {
        return false;
    };
    let steps = |at: usize| found.elapsed_s[at] - found.elapsed_s[at - 1];
    let mut usual: Vec<f64> = (1..found.elapsed_s.len()).map(steps).collect();
    let usual = upper_median(&mut usual).unwrap_or(0.0);
    let mut at = 0;
    let starts = parts.iter().map(|part| {
        at += part.cells.rows();
        at
    });
    starts.take(parts.len() - 1).all(|at| {
        let step = steps(at);
        step > 0.0 && pause.is_none_or(|pause| step <= pause * usual)
    })
}

/// The rows of all parts as one table.
pub fn joined<'a>(lines: &[Line<'a>], layout: &Layout, keeps_words: impl Fn(&Header) -> bool) -> Table<'a> {
    let lines = layout.joined(lines, &layout.parts(lines));
    read(&lines, layout, layout.shape.data_at..lines.len(), keeps_words)
}

/// The tables of lines: more than one where a logger was started anew and wrote its names again.
///
/// # Errors
/// No names, no rows, or something that a person must answer.
pub fn tables<'a>(
    lines: &[Line<'a>],
    keeps_words: impl Fn(&Header) -> bool,
    context: &ReadContext,
) -> Result<Vec<Table<'a>>, ReadError> {
    let mut layout = layout::decide(lines, context)?;
    let parts = layout.parts(lines);
    let mut tables: Vec<Table<'a>> = parts
        .iter()
        .map(|part| read(lines, &layout, part.clone(), &keeps_words))
        .collect();
    if tables.iter().any(Table::holds_other_numbers) {
        // Rows beyond those that were asked are written otherwise: all are asked.
        layout.ask_all(lines, context)?;
        tables = parts
            .into_iter()
            .map(|part| read(lines, &layout, part, &keeps_words))
            .collect();
    }
    tables.retain(|table| table.cells.rows() > 0);
    if tables.len() > 1 {
        let whole = joined(lines, &layout, &keeps_words);
        if goes_on(&whole, &tables) || dates_go_on(&whole, &tables, Some(GAP_FACTOR)) {
            tables = vec![whole];
        }
    }
    if tables.is_empty() {
        return Err(ReadError::header_only(
            layout.shape.names_at.map_or(0, |at| lines[at].number),
            "no row",
        ));
    }
    Ok(tables)
}
