//! NETZSCH Proteus text export (DMA, STA, DSC, dilatometer): `#KEY:value`, then `##` names, then rows.
//!
//! `#SEPARATOR` and `#DECIMAL` are declared and hold for the rows; numbers of the header may use the other decimal sign.
//! The unit stands behind the last slash of a name, maybe in brackets. The date has dots, day first, with or without a
//! zone. Time and temperature are taken as such; everything else keeps its name and unit. `#EXO`, the sign rule of the
//! heat flow, is kept with the metadata. Exports of the type DATA COMPARE, which repeat the header for each curve, were
//! never seen whole and are refused. The format declares no number of rows.

use super::assemble::{Raw, assemble_untimed};
use super::error::{ReadError, quoted};
use super::recognition::{FileHead, Match};
use super::stamp::{self, DateOrder};
use super::{About, Format, ReadContext, delimited};
use crate::text::grid::Dialect;
use crate::text::header::{Header, is_of_any_analyser};
use crate::text::{Decimal, Delimiter, Line};
use crate::{Reading, StartedAt, Timestamp};
use ieap_domain::Issue;
use ieap_domain::tag::keys;

/// Reader of Proteus text.
pub struct Netzsch;

impl Format for Netzsch {
    fn about(&self) -> About {
        About {
            id: "netzsch-text",
            title: "NETZSCH Proteus text export of a thermal analysis (.txt, .csv)",
            extensions: &["txt", "csv"],
            version: 3,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        Match::certain_if(
            head.text().unwrap_or_default().starts_with("#EXPORTTYPE:"),
            "the file begins with #EXPORTTYPE",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        let decoded = delimited::decoded(bytes)?;
        let mut issues = Vec::new();
        let mut lines = decoded.lines();
        let (status, status_evidence) = delimited::drop_cut_line(&mut lines, &mut issues);
        let names_at = lines.iter().position(|line| line.text.starts_with("##"));
        let names_at = names_at.ok_or_else(|| ReadError::header_only(lines.len(), "no names of columns"))?;
        let pairs = pairs(&lines[..names_at]);
        let value = |key: &str| {
            pairs
                .iter()
                .find(|(name, _)| *name == key)
                .map(|(_, value)| *value)
        };
        let kind = value("EXPORTTYPE").unwrap_or("");
        if !matches!(kind, "DATA ALL" | "DATA SINGLE") {
            return Err(ReadError::NeverSeen {
                what: "this type of a Proteus export",
                found: quoted(kind),
            });
        }
        let dialect = Dialect::new(delimiter(value("SEPARATOR"))?, decimal(value("DECIMAL"))?);
        let names = lines[names_at].text.trim_start_matches('#');
        let headers: Vec<Header> = dialect
            .delimiter
            .header_cells(names)
            .iter()
            .map(|cell| header(cell))
            .collect();
        let rows = &lines[names_at + 1..];
        let cells = delimited::cells_of(lines[names_at].number, headers.len(), rows, dialect);
        let table = assemble_untimed(Raw::of_instrument(String::new(), headers, cells), &mut issues)?;
        let instrument = value("INSTRUMENT").filter(|name| !name.is_empty());
        Ok(Reading {
            technique: value("MTYPE").map(str::to_owned),
            is_step_response: false,
            encoding: Some(decoded.encoding),
            status,
            status_evidence: delimited::undeclared(status, status_evidence),
            started_at: value("DATE/TIME").map(|text| started_at(text, &mut issues)),
            header_tags: instrument
                .map(|name| {
                    (
                        keys::INSTRUMENT.to_owned(),
                        name.to_owned(),
                        "#INSTRUMENT".to_owned(),
                    )
                })
                .into_iter()
                .collect(),
            tables: vec![table],
            original_metadata: pairs
                .iter()
                .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
                .collect(),
            issues,
            ..self.reading()
        })
    }
}

/// `#KEY:value` or `#KEY: ;value`.
fn pairs<'a>(lines: &[Line<'a>]) -> Vec<(&'a str, &'a str)> {
    let pair = |line: &Line<'a>| {
        let (key, value) = line.text.strip_prefix('#')?.split_once(':')?;
        Some((key.trim(), value.trim().trim_start_matches([';', '\t']).trim()))
    };
    lines.iter().filter_map(pair).collect()
}

fn delimiter(declared: Option<&str>) -> Result<Delimiter, ReadError> {
    match declared {
        Some("SEMICOLON") => Ok(Delimiter::Semicolon),
        Some("COMMA") => Ok(Delimiter::Comma),
        Some("TAB" | "TABULATOR") => Ok(Delimiter::Tab),
        other => Err(ReadError::NeverSeen {
            what: "this #SEPARATOR of a Proteus export",
            found: quoted(other.unwrap_or("")),
        }),
    }
}

fn decimal(declared: Option<&str>) -> Result<Decimal, ReadError> {
    match declared {
        Some("POINT") => Ok(Decimal::Point),
        Some("COMMA") => Ok(Decimal::Comma),
        other => Err(ReadError::NeverSeen {
            what: "this #DECIMAL of a Proteus export",
            found: quoted(other.unwrap_or("")),
        }),
    }
}

/// `Temp./°C`, `DSC/(mW/mg)`, `Gas Flow(purge1)/(ml/min)`.
fn header(cell: &str) -> Header {
    let bracketed = cell.ends_with(')').then(|| cell.rsplit_once("/(")).flatten();
    let (name, unit) = match bracketed {
        Some((name, unit)) => (name, unit.trim_end_matches(')')),
        None => cell.rsplit_once('/').unwrap_or((cell, "")),
    };
    Header {
        raw_name: cell.to_owned(),
        ..Header::with_unit(name, unit).keeping(is_of_any_analyser)
    }
}

/// `14.10.2024 22:24:04 (UTC+2)`.
fn started_at(text: &str, issues: &mut Vec<Issue>) -> StartedAt {
    let (moment, zone) = text.split_once('(').unwrap_or((text, ""));
    let basis = "day first, as dates with dots are written";
    let (stamp, issue) = stamp::in_order(moment.trim(), DateOrder::DayFirst, Timestamp::Start, basis);
    issues.extend(issue);
    StartedAt {
        raw: text.to_owned(),
        offset: offset(zone.trim_end_matches(')')),
        ..stamp
    }
}

/// `UTC+2`, `UTC-3:30`.
fn offset(zone: &str) -> Option<String> {
    let zone = zone.strip_prefix("UTC")?;
    let (sign, hours) = zone
        .split_at_checked(1)
        .filter(|(sign, _)| matches!(*sign, "+" | "-"))?;
    let (hours, minutes) = hours.split_once(':').unwrap_or((hours, "0"));
    let (hours, minutes): (u8, u8) = (hours.parse().ok()?, minutes.parse().ok()?);
    (hours <= 14 && minutes < 60).then(|| format!("{sign}{hours:02}:{minutes:02}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zones_and_units() {
        assert_eq!(offset("UTC+2").as_deref(), Some("+02:00"));
        assert_eq!(offset("UTC-3:30").as_deref(), Some("-03:30"));
        assert_eq!((offset("UTC"), offset(""), offset("UTC+99")), (None, None, None));
        let shown = |cell: &str| (header(cell).raw_unit, header(cell).meaning.quantity().is_some());
        assert_eq!(shown("Temp./°C"), ("°C".to_owned(), true));
        assert_eq!(shown("Gas Flow(purge1)/(ml/min)"), ("ml/min".to_owned(), false));
        assert_eq!(shown("tan(d)/-"), ("-".to_owned(), false));
    }
}
