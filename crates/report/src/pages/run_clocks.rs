//! The clocks of a run, their offsets, and the readings that instruments marked.

use super::wording::in_unit;
use crate::pages::policy::MOST_FLAGS;
use ieap_domain::number::{fixed, measured};
use ieap_domain::words::counted;
use ieap_domain::{ClockOffset, FlaggedStretch, RunClock, RunRecord, StartedAt, Timestamp};
use ieap_show::{Block, Sheet};

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

/// Offsets against the reference clock; none where there are none.
pub fn offsets(record: &RunRecord) -> Option<Block> {
    let (clocks, offsets) = (&record.origin.clocks, &record.origin.offsets);
    let table = Sheet::<&ClockOffset>::new("offsets", "", 1)
        .plain("Clock of", |offset| {
            clocks.get(offset.clock).map(|clock| clock.file.as_str())
        })
        .plain("Source", |offset| offset.source.label())
        .plain("Offset", |offset| {
            match (offset.offset_s, offset.standard_error_s) {
                (Some(value), Some(error)) => format!("{} s", measured(value, error)),
                (Some(value), None) => format!("{} s, uncertainty not known", fixed(value, 3)),
                (None, _) => "not determined".to_owned(),
            }
        })
        .plain("Used", |offset| offset.applied)
        .plain("Rests on", |offset| offset.detail.as_str())
        .over(offsets);
    let said =
        "Added to a clock's times they give those of the reference clock. Only a stated offset is used.";
    let blocks = vec![Block::say(said), Block::Table(table)];
    (!offsets.is_empty()).then(|| Block::part("Clock offsets", blocks))
}

/// Flagged stretches, with how many are not listed; none where there are none.
pub fn flags(record: &RunRecord) -> Option<Block> {
    let flags = &record.origin.flags;
    let (listed, more) = flags.split_at(flags.len().min(MOST_FLAGS));
    let readings = more.iter().map(|flag| flag.readings).sum::<usize>();
    let left = (!more.is_empty()).then(|| {
        format!(
            "Not listed: {} more, with {}.",
            more.len(),
            counted(readings, "reading")
        )
    });
    let table = Sheet::<&FlaggedStretch>::new("flags", "", 1)
        .said(left)
        .plain("Column", |flag| flag.column.as_str())
        .plain("Mark", |flag| flag.flag.as_str())
        .plain("When", |flag| match flag.readings {
            1 => in_unit(flag.from_s, "s"),
            _ => format!("{} … {}", in_unit(flag.from_s, "s"), in_unit(flag.to_s, "s")),
        })
        .plain("Readings", |flag| flag.readings)
        .plain(
            "Effect",
            |flag| if flag.excludes { "left out of fits" } else { "kept" },
        )
        .over(listed);
    let blocks = vec![Block::Table(table)];
    (!flags.is_empty()).then(|| Block::part("Marked by the instrument", blocks))
}
