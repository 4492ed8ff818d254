//! Campbell Scientific TOA5: four header lines (station, names, units, kind of value), then rows between commas.
//!
//! Written from the maker's public description, with look-alikes typed by hand. Dates are in the logger's local time
//! without a zone. The temperature of the logger's own panel (`PTemp`) keeps its name.

use super::table::read_text;
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
        let mut station = String::new();
        let reading = read_text(self.reading(), &delimited::decoded(bytes)?, context, |lines| {
            station = lines.first().map_or("", |line| line.text).to_owned();
            match lines {
                [_, _, _, _, _, ..] => Ok(1),
                _ => Err(ReadError::header_only(
                    lines.get(1).or(lines.first()).map_or(1, |line| line.number),
                    "no row",
                )),
            }
        })?;
        Ok(Reading {
            original_metadata: vec![("station".to_owned(), station)],
            ..reading
        })
    }
}
