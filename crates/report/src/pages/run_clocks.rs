//! The clocks of a run, their offsets, and the readings that instruments marked.

use serde::Serialize;

use super::wording::in_unit;
use crate::pages::policy::MOST_FLAGS;
use ieap_domain::number::{fixed, measured, plain};
use ieap_domain::{ClockOffset, RunClock, RunRecord, StartedAt, Timestamp};

/// One offset.
#[derive(Debug, Serialize)]
pub struct OffsetRow {
    file: String,
    source: String,
    offset: String,
    used: bool,
    detail: String,
}

/// One flagged stretch, or how many are not listed.
#[derive(Debug, Serialize)]
pub struct FlagRow {
    column: String,
    flag: String,
    when: String,
    readings: String,
    effect: String,
}

/// `gamry-dta, reader version 1`, or the profile.
pub fn format(record: &RunRecord) -> String {
    let profiles: Vec<String> = record
        .origin
        .profiles
        .iter()
        .map(|p| {
            format!(
                "profile {} version {} ({})",
                p.id,
                p.version,
                &p.digest[..12.min(p.digest.len())]
            )
        })
        .collect();
    if profiles.is_empty() {
        format!("{}, reader version {}", record.format, record.reader_version)
    } else {
        format!(
            "{}, reader version {}",
            profiles.join(", "),
            record.reader_version
        )
    }
}

/// The clocks in the order of the files: `time_s [s]; no date in the file`, and the file where there are several.
pub fn clocks(record: &RunRecord) -> Vec<String> {
    let clocks = &record.origin.clocks;
    let line = |clock: &RunClock| {
        let stamp = clock.stamp.as_ref();
        let stated = stamp.map_or("no date in the file".to_owned(), |stamp| {
            format!("{} ({}); {}", stamp.raw, kind(stamp.kind), read_as(stamp))
        });
        let file = match clocks.len() {
            1 => String::new(),
            _ => format!(" ({})", clock.file),
        };
        format!("{}; {stated}{file}", time(clock))
    };
    clocks.iter().map(line).collect()
}

fn time(clock: &RunClock) -> String {
    let unit = if clock.time_unit.is_empty() {
        String::new()
    } else {
        format!(" [{}]", clock.time_unit)
    };
    match (&clock.time_column, &clock.printed_column) {
        (Some(column), Some(printed)) => format!("{column}; printed in {printed}, which is kept"),
        (Some(column), None) => format!("{column}{unit}"),
        (None, _) => "rows are numbered".to_owned(),
    }
}

fn kind(kind: Timestamp) -> &'static str {
    match kind {
        Timestamp::Start => "start",
        Timestamp::End => "end",
        Timestamp::Export => "moment of the export",
    }
}

fn read_as(stamp: &StartedAt) -> String {
    let zone = stamp.offset.as_deref().unwrap_or(", no zone in the file");
    match &stamp.local {
        Some(local) => format!("{}{zone}: {}", local.replace('T', " "), stamp.basis),
        None => format!("not certain: {}", stamp.basis),
    }
}

/// Offsets against the reference clock.
pub fn offsets(record: &RunRecord) -> Vec<OffsetRow> {
    let file = |offset: &ClockOffset| {
        record
            .origin
            .clocks
            .get(offset.clock)
            .map(|clock| clock.file.clone())
    };
    let row = |offset: &ClockOffset| OffsetRow {
        file: file(offset).unwrap_or_default(),
        source: offset.source.label().to_owned(),
        offset: match (offset.offset_s, offset.standard_error_s) {
            (Some(value), Some(error)) => format!("{} s", measured(value, error)),
            (Some(value), None) => format!("{} s, uncertainty not known", fixed(value, 3)),
            (None, _) => "not determined".to_owned(),
        },
        used: offset.applied,
        detail: offset.detail.clone(),
    };
    record.origin.offsets.iter().map(row).collect()
}

/// Flagged stretches; the last row counts those that are not listed.
pub fn flags(record: &RunRecord) -> Vec<FlagRow> {
    let flags = &record.origin.flags;
    let mut rows: Vec<FlagRow> = flags
        .iter()
        .take(MOST_FLAGS)
        .map(|flag| FlagRow {
            column: flag.column.clone(),
            flag: flag.flag.clone(),
            when: match flag.readings {
                1 => in_unit(flag.from_s, "s"),
                _ => format!("{} … {}", in_unit(flag.from_s, "s"), in_unit(flag.to_s, "s")),
            },
            readings: flag.readings.to_string(),
            effect: if flag.excludes {
                "left out of fits".to_owned()
            } else {
                "kept".to_owned()
            },
        })
        .collect();
    if let Some(more) = flags.get(MOST_FLAGS..).filter(|more| !more.is_empty()) {
        rows.push(FlagRow {
            column: format!("and {} more", plain(more.len() as f64)),
            flag: String::new(),
            when: String::new(),
            readings: more.iter().map(|flag| flag.readings).sum::<usize>().to_string(),
            effect: String::new(),
        });
    }
    rows
}
