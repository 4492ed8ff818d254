//! Onset HOBO loggers: text of HOBOware (`Plot Title`) and HOBOmobile (`Serial Number`), between commas.
//!
//! Names hold quantity, unit and serial numbers: `Temp, °F (LGR S/N: 1, SEN S/N: 2)`, `RH, (%)`. The offset from UTC
//! stands in the name of the date column and is fixed, without summer time. Two-digit years stand in three orders; the
//! one in which all rows are dates that follow each other counts, and two that fit are refused. Columns without a unit
//! are events (`Logged`) and are left out. Relative humidity above 100 % occurs and is kept.

use super::wall_clock::{Log, cells, measured, offset};
use crate::Reading;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::stamp::DateOrder;
use crate::formats::{Format, ReadContext, ReadError, delimited};
use crate::text::header::Header;
use crate::text::{Decimal, Delimiter, Line, Lines};
use ieap_domain::RunStatus;

/// Reader of HOBO text.
pub struct Hobo;

const ORDERS: &[DateOrder] = &[DateOrder::MonthFirst, DateOrder::DayFirst, DateOrder::YearFirst];

impl Format for Hobo {
    fn id(&self) -> &'static str {
        "hobo"
    }

    fn title(&self) -> &'static str {
        "Onset HOBO climate logger, text of HOBOware or HOBOmobile (.csv)"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["csv", "txt"]
    }

    fn version(&self) -> u32 {
        1
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let first = text.trim_start_matches('"');
        let begins = first.starts_with("Plot Title:") || first.starts_with("Serial Number:");
        match begins
            && Lines::new(&text)
                .take(4)
                .any(|line| time_at(&cells(line.text)).is_some())
        {
            true => Match::Certain("Plot Title or Serial Number, then a column Date Time with GMT"),
            false => Match::No,
        }
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        let text = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = text.lines();
        let (status, evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        let found = lines
            .iter()
            .enumerate()
            .take(4)
            .find_map(|(at, line)| Some((at, time_at(&cells(line.text))?)));
        let Some((names_at, time_at)) = found else {
            return Err(ReadError::HeaderOnly {
                line: lines.len(),
                found: "no names of columns".to_owned(),
            });
        };
        let names = cells(lines[names_at].text);
        let (headers, is_text): (Vec<Header>, Vec<bool>) = names.iter().map(|name| header(name)).unzip();
        let log = Log {
            reader: (self.id(), self.version()),
            headers,
            is_text,
            time_at,
            clock_at: None,
            orders: ORDERS,
            date_order: context.date_order,
            offset: offset(names[time_at]),
            delimiter: Delimiter::Comma,
            decimal: Decimal::Point,
            rows_may_end_early: false,
            header_line: lines[names_at].number,
            rows: &lines[names_at + 1..],
        };
        let evidence = end(status, evidence, lines.last());
        log.read(
            Some(text.encoding),
            evidence,
            metadata(&lines[..names_at]),
            issues,
        )
    }
}

/// Index of the column of dates.
fn time_at(names: &[&str]) -> Option<usize> {
    let is_time =
        |name: &&str| (name.starts_with("Date Time") || name.starts_with("Time,")) && name.contains("GMT");
    names.iter().position(is_time)
}

/// The column, and whether it holds events: those have no unit.
fn header(cell: &str) -> (Header, bool) {
    if cell == "#" || cell.contains("GMT") {
        return (Header::other(cell), false);
    }
    // `Temp, °F (LGR S/N: 1)`, `Temp, °C()`, `Temp, (*F)`
    let described = cell.find("(LGR").or(cell.find("()")).unwrap_or(cell.len());
    match cell[..described].trim().rsplit_once(", ") {
        Some((name, unit)) => (measured(cell, name, unit), false),
        None => (Header::other(cell), true),
    }
}

/// The last row of a log that was read out names the end of the file as an event.
fn end(status: RunStatus, evidence: String, last: Option<&Line<'_>>) -> (RunStatus, String) {
    let is_end = last.is_some_and(|line| line.text.trim_end_matches(',').ends_with("Logged"));
    match (status, is_end) {
        (RunStatus::Complete, true) => (status, "the last row is an event of the read-out".to_owned()),
        (RunStatus::Complete, false) => (status, evidence + "; the format declares no number of rows"),
        _ => (status, evidence),
    }
}

fn metadata(lines: &[Line<'_>]) -> Vec<(String, String)> {
    let pair = |line: &Line<'_>| {
        let (key, value) = line.text.trim_matches('"').split_once(':')?;
        Some((key.trim().to_owned(), value.trim().to_owned()))
    };
    lines.iter().filter_map(pair).collect()
}
