//! PalmSens session (.pssession): JSON in UTF-16 with one more byte order mark behind it.
//!
//! The unit is that of the array's unit TYPE: the symbol beside it says `A` where the type is `MicroAmpere` and the
//! values are microamperes. Types other than those of voltages, currents, times and frequencies are kept under their own
//! names. What an array measures follows from its description, else from the quantity that its unit states. Time
//! stamps are ticks of 100 ns since the year 1, local and UTC; their difference is the offset. The file is one JSON
//! document, so a cut file cannot be read.

use encoding_rs::UTF_16LE;
use jiff::civil::{Date, DateTime};
use serde_json::Value;

use super::session_json::{ArrayGroup, DataArray, Measurement, get, measurements};
use crate::formats::assemble::{Raw, RowFlag, assemble_untimed};
use crate::formats::cells::CellTable;
use crate::formats::error::ReadError;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::{About, Format, ReadContext, stamp};
use crate::text::header::Header;
use crate::text::{Cell, decode};
use crate::{Reading, StartedAt, Timestamp};
use ieap_domain::RunStatus;
use ieap_domain::tag::keys;

/// Reader of PalmSens sessions.
pub struct PalmsensSession;

impl Format for PalmsensSession {
    fn about(&self) -> About {
        About {
            id: "palmsens-session",
            title: "PalmSens session of PSTrace (.pssession)",
            extensions: &["pssession"],
            version: 4,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        let start = &head.bytes[..head.bytes.len().min(256)];
        let even = &start[..start.len() & !1];
        let text = decode(even).text.to_ascii_lowercase();
        Match::certain_if(
            text.starts_with('{') && text.contains("palmsens.datafiles.sessionfile"),
            "JSON of the type PalmSens.DataFiles.SessionFile",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        let session = parse(bytes)?;
        let measurements = measurements(&session);
        let mut issues = Vec::new();
        let mut tables = Vec::new();
        let groups: Vec<(&Measurement, &ArrayGroup)> = measurements
            .iter()
            .flat_map(|measurement| measurement.groups.iter().map(move |group| (measurement, group)))
            .filter(|(_, group)| group.arrays.iter().any(|array| !array.values.is_empty()))
            .collect();
        for (index, (_, group)) in groups.iter().enumerate() {
            let name = match groups.len() {
                1 => String::new(),
                _ => format!("{} ({})", group.title, index + 1),
            };
            tables.push(assemble_untimed(raw(name, group), &mut issues)?);
        }
        let Some((first, _)) = groups.first() else {
            return Err(ReadError::header_only(
                0,
                format!("{} measurements without readings", measurements.len()),
            ));
        };
        Ok(Reading {
            technique: Some(first.title.clone()),
            is_step_response: groups
                .iter()
                .all(|(from, _)| from.title.starts_with("Chronoamperometry")),
            encoding: Some(decode(&bytes[..bytes.len().min(2)]).encoding),
            status: RunStatus::Complete,
            status_evidence: "the JSON document is whole; it declares no number of rows".to_owned(),
            started_at: stamp::shared(
                groups.iter().filter_map(|(from, _)| started_at(from)),
                &mut issues,
            ),
            header_tags: match first.serial.as_str() {
                "" => Vec::new(),
                serial => vec![(
                    keys::INSTRUMENT.to_owned(),
                    serial.to_owned(),
                    "deviceserial".to_owned(),
                )],
            },
            tables,
            original_metadata: metadata(&session),
            issues,
            ..self.reading()
        })
    }
}

fn parse(bytes: &[u8]) -> Result<Value, ReadError> {
    let decoded = match bytes {
        [b'{', 0, ..] => UTF_16LE.decode_without_bom_handling(bytes).0,
        _ => decode(bytes).text,
    };
    let text = decoded.trim_end_matches(|c: char| c == '\u{feff}' || c.is_whitespace());
    serde_json::from_str(text).map_err(|error| ReadError::Structure {
        offset: 0,
        found: format!(
            "no whole JSON document (line {}, column {})",
            error.line(),
            error.column()
        ),
        needed: "the JSON of a PalmSens session",
    })
}

fn raw(name: String, group: &ArrayGroup) -> Raw {
    let headers = headers(group);
    let rows = group
        .arrays
        .iter()
        .map(|array| array.values.len())
        .max()
        .unwrap_or(0);
    let mut cells = CellTable::new(0, &vec![false; headers.len()], rows);
    for row in 0..rows {
        for (column, array) in cells.columns.iter_mut().zip(&group.arrays) {
            let cell = match array.values.get(row) {
                Some(value) if value.is_finite() => Cell::Number(*value),
                _ => Cell::Empty,
            };
            column.push(row + 1, cell, String::new);
        }
        cells.end_row(row + 1, headers.len());
    }
    Raw {
        flags: flags(group),
        ..Raw::of_instrument(name, headers, cells)
    }
}

/// Status of readings other than 0. What the numbers mean is not published, so nothing is left out of fits for them.
fn flags(group: &ArrayGroup) -> Vec<RowFlag> {
    let of_array = |array: &DataArray| -> Vec<RowFlag> {
        let flag = |(row, status): &(u32, i64)| RowFlag {
            row: *row,
            column: array.description.clone(),
            flag: format!("S = {status}"),
            excludes: false,
        };
        array.marked.iter().map(flag).collect()
    };
    group.arrays.iter().flat_map(of_array).collect()
}

/// What the arrays of a group measure. Where no description is the name of a quantity, the array whose unit states it is
/// taken, if it is the only one of the group.
fn headers(group: &ArrayGroup) -> Vec<Header> {
    let mut headers: Vec<Header> = group
        .arrays
        .iter()
        .map(|array| header(&array.description, &array.unit_type))
        .collect();
    for (stated, name) in [
        ("Time", "time"),
        ("Potential", "potential"),
        ("Current", "current"),
    ] {
        let wanted = Header::with_unit(name, "").meaning.named_quantity();
        if headers.iter().any(|header| header.meaning.quantity() == wanted) {
            continue;
        }
        let mut of_quantity = (0..headers.len()).filter(|&at| group.arrays[at].quantity == stated);
        if let (Some(only), None) = (of_quantity.next(), of_quantity.next()) {
            headers[only].meaning = header(name, &group.arrays[only].unit_type).meaning;
        }
    }
    headers
}

/// The unit follows from the type; the symbol in the file lacks its prefix.
fn header(description: &str, unit_type: &str) -> Header {
    // Parts of an impedance have a type of their own, which says the sign as well.
    let part = match unit_type {
        "ZRe" => Some(("Z'", "Ohm")),
        "ZIm" => Some(("-Z''", "Ohm")),
        "Z" => Some(("Z", "Ohm")),
        "Phase" => Some(("-Phase", "\u{b0}")),
        _ => None,
    };
    if let Some((name, unit)) = part {
        return Header {
            raw_name: description.to_owned(),
            ..Header::with_unit(name, unit)
        };
    }
    let unit = match unit_type {
        "Volt" => "V",
        "MilliVolt" => "mV",
        "Ampere" => "A",
        "MilliAmpere" => "mA",
        "MicroAmpere" => "\u{b5}A",
        "NanoAmpere" => "nA",
        "PicoAmpere" => "pA",
        "Time" | "Second" => "s",
        "Hertz" => "Hz",
        other => {
            return Header {
                raw_unit: other.to_owned(),
                ..Header::other(description)
            };
        }
    };
    Header::with_unit(description, unit)
}

fn started_at(measurement: &Measurement) -> Option<StartedAt> {
    let ticks = measurement.local_ticks?;
    let offset_s = measurement.utc_ticks.map(|utc| (ticks - utc) / 10_000_000);
    let offset = offset_s
        .filter(|s| s.abs() <= 26 * 3600 / 2 + 3600)
        .map(|seconds| {
            let sign = if seconds < 0 { '-' } else { '+' };
            format!(
                "{sign}{:02}:{:02}",
                seconds.abs() / 3600,
                seconds.abs() % 3600 / 60
            )
        });
    Some(StartedAt {
        raw: ticks.to_string(),
        kind: Timestamp::Start,
        local: Some(from_ticks(ticks)?.to_string()),
        offset,
        basis: "ticks of 100 ns since the year 1, local time beside UTC".to_owned(),
    })
}

fn from_ticks(ticks: i64) -> Option<DateTime> {
    let epoch = Date::new(1, 1, 1)
        .ok()?
        .to_datetime(jiff::civil::Time::midnight());
    // Ticks of a damaged file may be more than any span of time holds.
    let whole = jiff::Span::new().try_seconds(ticks / 10_000_000).ok()?;
    let rest = jiff::Span::new()
        .try_milliseconds(ticks % 10_000_000 / 10_000)
        .ok()?;
    epoch.checked_add(whole).ok()?.checked_add(rest).ok()
}

fn metadata(session: &Value) -> Vec<(String, String)> {
    let keys = ["type", "coreversion", "methodformeasurement"];
    let pair = |key: &&str| Some(((*key).to_owned(), get(session, key)?.as_str()?.to_owned()));
    keys.iter().filter_map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::from_ticks;

    #[test]
    fn ticks_count_from_the_year_1_and_impossible_ones_give_no_date() {
        let day = 24 * 3600 * 10_000_000;
        assert_eq!(
            from_ticks(day + 15_000_000).unwrap().to_string(),
            "0001-01-02T00:00:01.5"
        );
        for impossible in [i64::MAX, i64::MIN, 4_000_000 * day] {
            assert_eq!(from_ticks(impossible), None, "{impossible}");
        }
    }
}
