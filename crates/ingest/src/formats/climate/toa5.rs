//! Campbell Scientific TOA5: four header lines (station, names, units, kind of value), then rows between commas.
//!
//! Written from the maker's public description, with look-alikes typed by hand. Dates are year first, in the logger's
//! local time without a zone. Air temperature and relative humidity are taken as such where their names say so
//! (`AirTC_Avg`, `Temp_C`, `RH`); the temperature of the logger's own panel (`PTemp`) keeps its name.

use super::wall_clock::{Log, cells};
use crate::Reading;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::stamp::DateOrder;
use crate::formats::{About, Format, ReadContext, ReadError, delimited};
use crate::text::header::Header;
use crate::text::{Decimal, Delimiter};

/// Reader of TOA5.
pub struct Toa5;

impl Format for Toa5 {
    fn about(&self) -> About {
        About {
            id: "campbell-toa5",
            title: "Campbell Scientific climate logger, TOA5 (.dat)",
            extensions: &["dat", "csv"],
            version: 3,
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
        let text = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = text.lines();
        let (status, evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        let [station, names, units, _, rows @ ..] = lines.as_slice() else {
            return Err(ReadError::header_only(
                lines.len(),
                "fewer than four header lines",
            ));
        };
        let (names_found, units) = (cells(names.text), cells(units.text));
        let time_at = names_found
            .iter()
            .position(|name| *name == "TIMESTAMP")
            .ok_or_else(|| ReadError::NoHeader {
                line: names.number,
                found: crate::formats::error::quoted(names.text),
            })?;
        let unit = |index: usize| units.get(index).copied().unwrap_or("");
        let headers: Vec<Header> = names_found
            .iter()
            .enumerate()
            .map(|(index, name)| header(name, unit(index)))
            .collect();
        let log = Log {
            reader: self.reading(),
            is_text: vec![false; headers.len()],
            headers,
            time_at,
            clock_at: None,
            orders: &[DateOrder::YearFirst],
            date_order: context.date_order,
            offset: None,
            delimiter: Delimiter::Comma,
            decimal: Decimal::Point,
            rows_may_end_early: false,
            header_line: names.number,
            rows,
        };
        let evidence = delimited::undeclared(status, evidence);
        let metadata = vec![("station".to_owned(), station.text.to_owned())];
        log.read(Some(text.encoding), (status, evidence), metadata, issues)
    }
}

fn header(name: &str, unit: &str) -> Header {
    let lower = name.to_lowercase();
    let quantity = if lower.starts_with("airt") || lower.starts_with("temp") {
        "temperature"
    } else if lower == "rh" || lower.starts_with("rh_") {
        "rh"
    } else {
        return Header {
            raw_unit: unit.to_owned(),
            ..Header::other(name)
        };
    };
    Header {
        raw_name: name.to_owned(),
        ..Header::with_unit(quantity, unit)
    }
}
