//! Rows with a date and time each: cells, the order of day and month, and seconds from the first row.

use super::moments::{Moments, NoOrder, moments};
use crate::formats::assemble::{Raw, assemble};
use crate::formats::cells::CellTable;
use crate::formats::error::{ReadError, quoted};
use crate::formats::stamp::DateOrder;
use crate::text::header::{Header, Meaning};
use crate::text::{Cell, Decimal, Delimiter, Line, number};
use crate::{Reading, RunTable, StartedAt, Timestamp};
use ieap_domain::words::in_a_row;
use ieap_domain::{Issue, RunStatus};

/// What a logger's file says, before its rows are read.
pub struct Log<'a> {
    /// Its reader, before it read anything.
    pub reader: Reading,
    /// The columns; the time is the one at `time_at`.
    pub headers: Vec<Header>,
    /// Columns that hold words, such as events.
    pub is_text: Vec<bool>,
    /// Index of the column of dates.
    pub time_at: usize,
    /// Index of the column of times of day, where they stand beside the dates.
    pub clock_at: Option<usize>,
    /// Orders that its dates may have.
    pub orders: &'static [DateOrder],
    /// The order that counts where its dates leave several.
    pub date_order: Option<DateOrder>,
    /// Offset from UTC, where the file states one.
    pub offset: Option<String>,
    /// Between the cells.
    pub delimiter: Delimiter,
    /// Inside the numbers.
    pub decimal: Decimal,
    /// Whether what is empty at the end of a row may be left out with its delimiters.
    pub rows_may_end_early: bool,
    /// Line of the header.
    pub header_line: usize,
    /// The rows.
    pub rows: &'a [Line<'a>],
}

/// Cells of a line between commas, without their quotes.
pub fn cells(text: &str) -> Vec<&str> {
    cells_between(text, Delimiter::Comma)
}

/// Cells of a line between delimiters, without their quotes.
pub fn cells_between(text: &str, delimiter: Delimiter) -> Vec<&str> {
    let mut cells = Vec::new();
    delimiter.split(text, |_, cell| cells.push(number::unquote(cell)));
    cells
}

/// A column that measures what its name's last word says, such as `H08 Temp.`; other columns keep their names.
pub fn measured(raw_name: &str, name: &str, unit: &str) -> Header {
    let word = match name.split_whitespace().next_back().unwrap_or("") {
        // Relative Feuchte.
        "RF" | "rF" => "RH",
        word => word,
    };
    let header = Header::with_unit(word, unit);
    let is_known = matches!(
        word,
        "Temp"
            | "Temp."
            | "Temperature"
            | "Temperatur"
            | "RH"
            | "Feuchte"
            | "Luftfeuchte"
            | "Luftfeuchtigkeit"
    );
    Header {
        raw_name: raw_name.to_owned(),
        meaning: if is_known { header.meaning } else { Meaning::Other },
        ..header
    }
}

impl Log<'_> {
    /// Reads the rows and makes the reading; its status is that of the text.
    ///
    /// # Errors
    /// No row, dates that cannot be read, or dates that can be read in two orders.
    pub fn read(
        mut self,
        encoding: Option<&'static str>,
        (status, status_evidence): (RunStatus, String),
        original_metadata: Vec<(String, String)>,
        mut issues: Vec<Issue>,
    ) -> Result<Reading, ReadError> {
        let rows: Vec<&Line<'_>> = self
            .rows
            .iter()
            .filter(|row| !row.text.trim().is_empty())
            .collect();
        let Some(first_row) = rows.first() else {
            return Err(ReadError::header_only(self.header_line, "no row"));
        };
        let (mut table, dates, clocks) = self.cells(&rows);
        let joined: Vec<String>;
        let texts = match self.clock_at {
            None => dates,
            Some(_) => {
                let pairs = dates.iter().zip(&clocks);
                joined = pairs.map(|(date, clock)| format!("{date} {clock}")).collect();
                joined.iter().map(String::as_str).collect()
            }
        };
        let (moments, reason) = self.moments(&texts, first_row.number)?;
        let column = &mut table.columns[self.time_at];
        column.numbers = moments.elapsed_s;
        column.filled = column.numbers.len();
        let mut headers = std::mem::take(&mut self.headers);
        let time = &mut headers[self.time_at];
        time.raw_unit = String::new();
        time.meaning = Header::with_unit("time", "s").meaning;
        if let Some(clock_at) = self.clock_at {
            // It is part of the moments now, and no column of its own.
            headers.remove(clock_at);
            table.columns.remove(clock_at);
        }
        let raw = Raw::of_instrument(String::new(), headers, table);
        let table = RunTable {
            clock_set_back: moments.set_back,
            ..assemble(raw, &mut issues)?
        };
        Ok(Reading {
            encoding,
            status,
            status_evidence,
            started_at: Some(StartedAt {
                raw: texts[0].to_owned(),
                kind: Timestamp::Start,
                local: Some(moments.first.to_string()),
                offset: if moments.in_utc {
                    Some("+00:00".to_owned())
                } else {
                    self.offset
                },
                basis: format!("the first row, {}{reason}", moments.order.words()),
            }),
            tables: vec![table],
            original_metadata,
            issues,
            ..self.reader
        })
    }

    /// The cells of all rows, and the texts of dates and of times of day; the columns of these two are left empty.
    fn cells<'t>(&self, rows: &[&Line<'t>]) -> (CellTable, Vec<&'t str>, Vec<&'t str>) {
        let mut found: Vec<&str> = Vec::with_capacity(self.headers.len());
        let (mut dates, mut clocks) = (Vec::with_capacity(rows.len()), Vec::new());
        let mut table = CellTable::new(self.header_line, &self.is_text, rows.len());
        let last_time = self.time_at.max(self.clock_at.unwrap_or(0));
        for row in rows {
            found.clear();
            self.delimiter
                .split(row.text, |_, cell| found.push(number::unquote(cell)));
            let text_at = |at: usize| found.get(at).copied().unwrap_or("");
            dates.push(text_at(self.time_at));
            clocks.extend(self.clock_at.map(text_at));
            for (index, (column, text)) in table.columns.iter_mut().zip(&found).enumerate() {
                let cell = if index == self.time_at || Some(index) == self.clock_at {
                    Cell::Empty
                } else {
                    number::parse(text, self.decimal)
                };
                column.push(row.number, cell, || (*text).to_owned());
            }
            let needed = table.columns.len();
            let is_short = self.rows_may_end_early && found.len() < needed && found.len() > last_time + 1;
            table.end_row(row.number, if is_short { needed } else { found.len() });
        }
        (table, dates, clocks)
    }

    /// The moments of all rows under the one order in which all are dates that follow each other, and why that order
    /// was taken where the rows leave several.
    fn moments(&self, texts: &[&str], line: usize) -> Result<(Moments, &'static str), ReadError> {
        let reason = match moments(texts, self.orders) {
            Ok(moments) => return Ok((moments, "")),
            Err(NoOrder::Fits) => {
                "no order of day, month and year makes all rows dates that follow each other".to_owned()
            }
            Err(NoOrder::Several(orders)) => {
                if let Some((order, reason)) = self.taken(texts[0], &orders)
                    && let Ok(moments) = moments(texts, &[order])
                {
                    return Ok((moments, reason));
                }
                let orders: Vec<&str> = orders.into_iter().map(DateOrder::words).collect();
                format!("{} fit all rows alike", in_a_row(&orders))
            }
        };
        Err(ReadError::AmbiguousDates {
            line,
            column: quoted(&self.headers[self.time_at].raw_name),
            found: format!("{reason}, first {}", quoted(texts[0])),
            first: texts[0].to_owned(),
        })
    }

    /// Of several orders day first, where dots stand between the numbers; else the one that somebody states.
    fn taken(&self, first: &str, orders: &[DateOrder]) -> Option<(DateOrder, &'static str)> {
        let with_dots = first.chars().find(|c| matches!(c, '.' | '/' | '-')) == Some('.');
        if with_dots && orders.contains(&DateOrder::DayFirst) {
            return Some((DateOrder::DayFirst, ", as dates with dots are written"));
        }
        let stated = self.date_order.filter(|order| orders.contains(order))?;
        Some((
            stated,
            ", as campaign.toml states or other files of the folder show",
        ))
    }
}

/// `GMT-07:00`, `GMT +05:00` behind a column's name; `UTC` alone is no offset.
pub fn offset(name: &str) -> Option<String> {
    let (_, zone) = name.split_once("GMT").or_else(|| name.split_once("UTC"))?;
    let zone = zone.trim_matches([' ', ')', ']']);
    if zone.is_empty() {
        return Some("+00:00".to_owned());
    }
    let is_offset = zone.len() == 6 && zone.starts_with(['+', '-']) && zone.as_bytes()[3] == b':';
    is_offset.then(|| zone.to_owned())
}
