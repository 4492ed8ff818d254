//! Text export of IviumSoft: a date, then `time/s I/A E/V` between blanks. Rows may hold one column more than
//! there are names (the measured potential); it is kept under a name of its own.
//!
//! The date is that of the run's start, in the order of the computer's locale. The format says nothing of how the
//! run ended beside the end of its last line.

use crate::formats::assemble::{Raw, assemble};
use crate::formats::recognition::{FileHead, Match};
use crate::formats::{About, Format, ReadContext, ReadError, date, delimited};
use crate::text::grid::Dialect;
use crate::text::header::Header;
use crate::text::{Decimal, Delimiter, Lines};
use crate::{Reading, Timestamp};

/// Reader of the text export.
pub struct IviumText;

impl Format for IviumText {
    fn about(&self) -> About {
        About {
            id: "ivium-text",
            title: "Ivium text export: a date, then the columns time/s I/A E/V",
            extensions: &["txt"],
            version: 4,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let mut lines = Lines::new(text).map(|line| line.text.trim());
        let (first, second) = (lines.next().unwrap_or(""), lines.next().unwrap_or(""));
        let is_date = !first.is_empty() && first.chars().all(|c| c.is_ascii_digit() || " ./:-".contains(c));
        let names: Vec<&str> = second.split_whitespace().collect();
        Match::certain_if(
            is_date && names == ["time/s", "I/A", "E/V"],
            "a date, then time/s I/A E/V between blanks",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        let decoded = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = decoded.lines();
        let (status, status_evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        let [date_line, names, rows @ ..] = lines.as_slice() else {
            return Err(ReadError::header_only(lines.len(), "no names of columns"));
        };
        let mut headers: Vec<Header> = names.text.split_whitespace().map(Header::parse).collect();
        let fields = rows.first().map_or(0, |row| row.text.split_whitespace().count());
        if fields == headers.len() + 1 {
            headers.push(Header::other("unnamed column"));
        }
        let decimal = if rows.first().is_some_and(|row| row.text.contains(',')) {
            Decimal::Comma
        } else {
            Decimal::Point
        };
        let dialect = Dialect::new(Delimiter::Blanks, decimal);
        let cells = delimited::cells_of(names.number, headers.len(), rows, dialect);
        let table = assemble(Raw::of_instrument(String::new(), headers, cells), &mut issues)?;
        let stamp = date_line.text.trim();
        let (date, time) = stamp.split_once(' ').unwrap_or((stamp, ""));
        let (started_at, issue) = date::started_at(date, time.trim(), Timestamp::Start, &[]);
        issues.extend(issue.map(|issue| issue.at("line 1")));
        Ok(Reading {
            is_step_response: true,
            encoding: Some(decoded.encoding),
            status,
            status_evidence: delimited::undeclared(status, status_evidence),
            started_at: Some(started_at),
            tables: vec![table],
            original_metadata: vec![("date".to_owned(), stamp.to_owned())],
            issues,
            ..self.reading()
        })
    }
}
