//! Columns of cells as read from a file, before units, order and completeness are judged.

use super::policy::BAD_SHARE;
use crate::text::Cell;

/// How often something was met, and where first.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tally {
    /// How often.
    pub count: usize,
    /// Line and text of the first one.
    pub first: Option<(usize, String)>,
}

impl Tally {
    /// Counts one more, on `line`.
    pub fn add(&mut self, line: usize, text: impl FnOnce() -> String) {
        self.count += 1;
        if self.first.is_none() {
            self.first = Some((line, text()));
        }
    }

    /// Line of the first one; 0 where there is none.
    pub fn line(&self) -> usize {
        self.first.as_ref().map_or(0, |(line, _)| *line)
    }
}

/// Most different texts among the numbers of a column that may stand for readings that were not taken. Chosen.
pub const MOST_WORDS: usize = 3;

/// One column of cells.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CellColumn {
    /// The number in each row; NaN marks a row without one and never leaves this module's users.
    pub numbers: Vec<f64>,
    /// Cells that hold anything.
    pub filled: usize,
    /// Cells that hold a text where a number must stand.
    pub text: Tally,
    /// What these cells hold, each text once, as far as they are few.
    pub words: Vec<String>,
    /// Cells that hold `NaN`, `inf` or a number that is too large.
    pub not_finite: Tally,
    /// Row and content of text cells, collected where `keep_text` is set.
    pub texts: Vec<(u32, String)>,
    /// Whether the column is a column of texts, such as overload flags.
    pub keep_text: bool,
}

impl CellColumn {
    /// A column of numbers with `rows` rows; numbers that are not finite are counted and left out.
    fn of_numbers(mut numbers: Vec<f64>, rows: usize) -> CellColumn {
        let mut column = CellColumn {
            filled: numbers.len(),
            ..CellColumn::default()
        };
        if numbers.iter().any(|number| !number.is_finite()) {
            for (row, number) in numbers.iter_mut().enumerate().filter(|(_, n)| !n.is_finite()) {
                column.not_finite.add(row + 1, || number.to_string());
                *number = f64::NAN;
            }
        }
        numbers.resize(rows, f64::NAN);
        column.numbers = numbers;
        column
    }

    /// Whether so many cells hold text that the column is none of numbers. A few words that stand again and again, `No Data`, say
    /// only that there was no reading.
    pub fn holds_text(&self) -> bool {
        let count = self.text.count;
        let has_digit = |word: &String| word.contains(|c: char| c.is_ascii_digit());
        let are_words = self.words.len() <= MOST_WORDS && !self.words.iter().any(has_digit);
        2 * count > self.filled || (!are_words && count > 1 && count as f64 > BAD_SHARE * self.filled as f64)
    }

    /// Adds the cell of the next row, which stands on `line`.
    pub fn push(&mut self, line: usize, cell: Cell, raw: impl Fn() -> String) {
        let row = self.numbers.len() as u32;
        self.filled += usize::from(cell != Cell::Empty);
        let number = match cell {
            Cell::Number(number) => number,
            Cell::Empty => f64::NAN,
            Cell::NotFinite => {
                self.not_finite.add(line, raw);
                f64::NAN
            }
            Cell::Text => {
                if self.keep_text {
                    self.texts.push((row, raw()));
                } else {
                    if self.words.len() <= MOST_WORDS && !self.words.contains(&raw()) {
                        self.words.push(raw());
                    }
                    self.text.add(line, raw);
                }
                f64::NAN
            }
        };
        self.numbers.push(number);
    }
}

/// A table of cells.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CellTable {
    /// Line (or sheet row) of the header, from 1.
    pub header_line: usize,
    /// Columns, all of the same length.
    pub columns: Vec<CellColumn>,
    /// Line (or sheet row) of each row, from 1.
    pub line_of_row: Vec<u32>,
    /// Rows with another number of fields than the header has; the text is the number of fields.
    pub ragged: Tally,
}

impl CellTable {
    /// An empty table; `keep_text` says for each column whether it is one of texts.
    pub fn new(header_line: usize, keep_text: &[bool], rows_expected: usize) -> CellTable {
        let column = |&keep_text: &bool| CellColumn {
            numbers: Vec::with_capacity(rows_expected),
            keep_text,
            ..CellColumn::default()
        };
        CellTable {
            header_line,
            columns: keep_text.iter().map(column).collect(),
            line_of_row: Vec::with_capacity(rows_expected),
            ragged: Tally::default(),
        }
    }

    /// A table of numbers, as binary files hold them; columns that end before the longest one are empty from there.
    pub fn of_numbers(columns: Vec<Vec<f64>>) -> CellTable {
        let rows = columns.iter().map(Vec::len).max().unwrap_or(0);
        CellTable {
            columns: columns
                .into_iter()
                .map(|numbers| CellColumn::of_numbers(numbers, rows))
                .collect(),
            line_of_row: (1..=rows as u32).collect(),
            ..CellTable::default()
        }
    }

    /// The table with some of its rows only, in their order; none stands for all.
    pub fn only(&self, rows: Option<&[usize]>) -> CellTable {
        let Some(rows) = rows else {
            return self.clone();
        };
        let column = |column: &CellColumn| {
            let numbers: Vec<f64> = rows.iter().map(|row| column.numbers[*row]).collect();
            let new_row = |old: u32| rows.binary_search(&(old as usize)).ok();
            let texts = column
                .texts
                .iter()
                .filter_map(|(row, text)| Some((new_row(*row)? as u32, text.clone())));
            CellColumn {
                filled: column.filled.min(numbers.len()),
                texts: texts.collect(),
                numbers,
                // Said once, of the table as a whole.
                text: Tally::default(),
                not_finite: Tally::default(),
                words: Vec::new(),
                keep_text: column.keep_text || column.holds_text(),
            }
        };
        CellTable {
            columns: self.columns.iter().map(column).collect(),
            line_of_row: rows.iter().map(|row| self.line_of_row[*row]).collect(),
            ..self.clone()
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.line_of_row.len()
    }

    /// Ends the row on `line`, of which `found` fields were read: missing cells stay empty.
    pub fn end_row(&mut self, line: usize, found: usize) {
        let needed = self.columns.len();
        if found != needed {
            self.ragged.add(line, || found.to_string());
        }
        self.line_of_row.push(line as u32);
        let rows = self.rows();
        for column in &mut self.columns {
            column.numbers.resize(rows, f64::NAN);
        }
    }
}
