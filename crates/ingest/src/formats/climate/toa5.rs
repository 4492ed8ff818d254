//! Campbell Scientific TOA5: four header lines (station, names, units, kind of value), then rows between commas.
//!
//! Written from the maker's public description, with look-alikes typed by hand. Dates are in the logger's local time
//! without a zone. The temperature of the logger's own panel (`PTemp`) keeps its name.

use super::table::read_lines;
use crate::Reading;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::{About, Format, ReadContext, ReadError, delimited};

/// Reader of TOA5.
pub struct Toa5;

impl Format for Toa5 {
    fn about(&self) -> About {
        About {
            id: "campbell-toa5",
            title: "Campbell Scientific climate logger, TOA5 (.dat)",
            extensions: &["dat", "csv"],
            version: 4,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        Match::certain_if(
            text.starts_with("\"TOA5\"") || text.starts_with("TOA5,"),
            "the file begins with TOA5",
        )
    }

    fn read(&self, bytes: &[u8], context: &ReadContext) -> Result<Reading, ReadError> {
        let mut issues = Vec::new();
        let decoded = delimited::decoded(bytes)?;
        let text = delimited::text(&decoded, &mut issues)?;
        let [station, table @ ..] = text.lines.as_slice() else {
            return Err(ReadError::Empty);
        };
        let (head, rows) = table.split_at_checked(3).unwrap_or((table, &[]));
        if rows.is_empty() {
            let line = head.first().unwrap_or(station).number;
            return Err(ReadError::header_only(line, "no row"));
        }
        let status = (text.status, text.evidence());
        let reading = read_lines(
            self.reading(),
            Some(text.encoding),
            context,
            table,
            status,
            issues,
        )?;
        Ok(Reading {
            original_metadata: vec![("station".to_owned(), station.text.to_owned())],
            ..reading
        })
    }
}
