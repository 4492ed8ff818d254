//! Onset HOBO loggers: text of HOBOware (`Plot Title`, in German `Plot-Titel`) and HOBOmobile (`Serial Number`).
//!
//! Names hold quantity, unit and serial numbers: `Temp, °F (LGR S/N: 1, SEN S/N: 2)`, `RH, (%)`. The offset from UTC
//! stands in the name of the date column and is fixed, without summer time. Two-digit years stand in three orders; the
//! one in which all rows are dates that follow each other counts, and two that fit are refused. Columns without a unit
//! are events (`Logged`) and are left out. Relative humidity above 100 % occurs and is kept. Commas, semicolons or tabs
//! stand between the cells, as HOBOware was told; a German one writes decimal commas.

use super::wall_clock::{Log, cells_between, measured, offset};
use crate::Reading;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::stamp::DateOrder;
use crate::formats::{About, Format, ReadContext, ReadError, delimited};
use crate::text::header::Header;
use crate::text::{Delimiter, Line, Lines};
use ieap_domain::RunStatus;

/// Reader of HOBO text.
pub struct Hobo;

const ORDERS: &[DateOrder] = &[DateOrder::MonthFirst, DateOrder::DayFirst, DateOrder::YearFirst];

impl Format for Hobo {
    fn about(&self) -> About {
        About {
            id: "hobo",
            title: "Onset HOBO climate logger, text of HOBOware or HOBOmobile (.csv)",
            extensions: &["csv", "txt"],
            version: 3,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let text = head.text().unwrap_or_default();
        let first = text.trim_start_matches('"');
        let begins = ["Plot Title:", "Plot-Titel:", "Serial Number:"];
        let is_hobo = begins.iter().any(|begin| first.starts_with(begin));
        let mut lines = Lines::new(&text).take(4);
        Match::certain_if(
            is_hobo && lines.any(|line| names_in(line.text).is_some()),
            "Plot Title or Serial Number, then a column Date Time with GMT",
        )
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
            .find_map(|(at, line)| Some((at, names_in(line.text)?)));
        let Some((names_at, (delimiter, names, time_at))) = found else {
            return Err(ReadError::header_only(lines.len(), "no names of columns"));
        };
        let rows = &lines[names_at + 1..];
        let (headers, is_text): (Vec<Header>, Vec<bool>) = names.iter().map(|name| header(name)).unzip();
        let log = Log {
            reader: self.reading(),
            headers,
            is_text,
            time_at,
            clock_at: None,
            orders: ORDERS,
            date_order: context.date_order,
            offset: offset(names[time_at]),
            delimiter,
            decimal: delimited::decimal_of(rows, delimiter)?,
            rows_may_end_early: false,
            header_line: lines[names_at].number,
            rows,
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

/// The delimiter, the names and the index of the column of dates, where a line names one.
fn names_in(text: &str) -> Option<(Delimiter, Vec<&str>, usize)> {
    const DATES: [&str; 3] = ["Date Time", "Time,", "Datum Zeit"];
    let is_time = |name: &&str| DATES.iter().any(|date| name.starts_with(date)) && name.contains("GMT");
    let delimiters = [Delimiter::Comma, Delimiter::Semicolon, Delimiter::Tab];
    delimiters.into_iter().find_map(|delimiter| {
        let names = cells_between(text, delimiter);
        let time_at = names.iter().position(is_time).filter(|_| names.len() > 1)?;
        Some((delimiter, names, time_at))
    })
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
    let is_end = last.is_some_and(|line| {
        let filled = line.text.trim_end_matches([',', ';', '\t']);
        ["Logged", "Protokolliert"]
            .iter()
            .any(|event| filled.ends_with(event))
    });
    match (status, is_end) {
        (RunStatus::Complete, true) => (status, "the last row is an event of the read-out".to_owned()),
        _ => (status, delimited::undeclared(status, evidence)),
    }
}

fn metadata(lines: &[Line<'_>]) -> Vec<(String, String)> {
    let pair = |line: &Line<'_>| {
        let (key, value) = line.text.trim_matches('"').split_once(':')?;
        Some((key.trim().to_owned(), value.trim().to_owned()))
    };
    lines.iter().filter_map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::read;
    use ieap_domain::Quantity;

    #[test]
    fn a_german_log_is_read_between_commas_and_between_semicolons() {
        let title = "\u{feff}\"Plot-Titel: 10347351\"\r\n";
        let commas = format!(
            "{title}\"Anz.\",\"Datum Zeit, GMT+02:00\",\"Temp., \u{b0}C (LGR S/N: 10347351, SEN S/N: 7)\",\"RH, % (LGR S/N: \
             10347351)\",\"Gestoppt\"\r\n1,\"31.05.26 23:50:00\",\"21,5\",\"40,25\",\r\n2,\"01.06.26 00:00:00\",\"21,75\",\"41\",\r\n"
        );
        let semicolons = format!(
            "{title}\"Anz.\";\"Datum Zeit, GMT+02:00\";\"Temperatur, \u{b0}C (LGR S/N: 10347351)\";\"RF, % (LGR S/N: \
             10347351)\"\r\n1;31.05.2026 23:50:00;21,5;40,25\r\n2;01.06.2026 00:00:00;21,75;41\r\n"
        );
        for text in [commas, semicolons] {
            let reading = read("log.csv", text.as_bytes(), &ReadContext::default()).unwrap();
            let start = reading.started_at.unwrap();
            assert_eq!(
                (reading.format, start.local.as_deref()),
                ("hobo", Some("2026-05-31T23:50:00"))
            );
            assert_eq!(start.offset.as_deref(), Some("+02:00"));
            let values = |quantity: Quantity| {
                let channel = reading.tables[0].channels.iter().find(|c| c.quantity == quantity);
                channel.map(|c| (c.time_s.to_vec(), c.values.to_vec()))
            };
            let expected = |first, second| Some((vec![0.0, 600.0], vec![first, second]));
            assert_eq!(values(Quantity::Temperature), expected(21.5, 21.75), "{text}");
            assert_eq!(
                values(Quantity::RelativeHumidity),
                expected(40.25, 41.0),
                "{text}"
            );
        }
    }
}
