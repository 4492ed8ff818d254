//! PicoLog text: a first column without a name that counts Unix seconds, then quoted names with units.
//!
//! Every name (`Outside Ave. (C)`) is kept as it is: the file does not say which of its sensors stands beside the
//! sample. Seconds are UTC.

use jiff::Timestamp as Moment;

use super::wall_clock::cells;
use crate::formats::assemble::{Raw, assemble};
use crate::formats::cells::CellTable;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::{About, Format, ReadContext, ReadError, delimited};
use crate::text::header::Header;
use crate::text::{Decimal, Lines, number};
use crate::{Reading, StartedAt, Timestamp};

/// Reader of PicoLog text.
pub struct Picolog;

impl Format for Picolog {
    fn about(&self) -> About {
        About {
            id: "picolog",
            title: "Pico Technology PicoLog climate logger, text with Unix seconds (.csv)",
            extensions: &["csv"],
            version: 3,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let mut lines = Lines::new(&text).map(|line| line.text);
        let (first, second) = (lines.next().unwrap_or(""), lines.next().unwrap_or(""));
        let seconds = cells(second).first().and_then(|cell| cell.parse::<u64>().ok());
        // 1e9 s is the year 2001.
        Match::certain_if(
            first.starts_with("\"\",\"") && seconds.is_some_and(|seconds| seconds > 1_000_000_000),
            "a first column without a name that counts Unix seconds",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        let text = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = text.lines();
        let (status, evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        let Some((names, rows)) = lines.split_first() else {
            return Err(ReadError::header_only(1, "no names of columns"));
        };
        let mut headers: Vec<Header> = cells(names.text).iter().map(|cell| Header::other(cell)).collect();
        headers[0] = Header {
            raw_name: "Unix time".to_owned(),
            ..Header::with_unit("time", "s")
        };
        let mut table = CellTable::new(names.number, &vec![false; headers.len()], rows.len());
        for row in rows.iter().filter(|row| !row.text.trim().is_empty()) {
            let found = cells(row.text);
            for (column, text) in table.columns.iter_mut().zip(&found) {
                column.push(row.number, number::parse(text, Decimal::Point), || {
                    (*text).to_owned()
                });
            }
            table.end_row(row.number, found.len());
        }
        let seconds = &mut table.columns[0].numbers;
        let first = seconds
            .first()
            .copied()
            .filter(|first| first.is_finite())
            .unwrap_or(0.0);
        seconds.iter_mut().for_each(|second| *second -= first);
        let tables = vec![assemble(
            Raw::of_instrument(String::new(), headers, table),
            &mut issues,
        )?];
        Ok(Reading {
            is_step_response: false,
            encoding: Some(text.encoding),
            status,
            status_evidence: delimited::undeclared(status, evidence),
            started_at: started_at(first),
            tables,
            issues,
            ..self.reading()
        })
    }
}

fn started_at(seconds: f64) -> Option<StartedAt> {
    let moment = Moment::from_second(seconds as i64).ok()?;
    Some(StartedAt {
        raw: format!("{seconds}"),
        kind: Timestamp::Start,
        local: Some(moment.to_zoned(jiff::tz::TimeZone::UTC).datetime().to_string()),
        offset: Some("+00:00".to_owned()),
        basis: "Unix seconds of the first row".to_owned(),
    })
}
