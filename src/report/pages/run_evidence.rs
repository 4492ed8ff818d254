//! What a run rests on: tags, channels, drive, files, versions, history.

use serde::Serialize;

use super::run_clocks::{self as clocks, ClockRow, FlagRow, OffsetRow};
use super::wording::{in_unit, moment, voltage_label};
use crate::domain::{ChannelSummary, Drive, Level, Quantity, RunRecord, RunStatus};
use crate::report::number::{plain, significant};
use crate::report::site::Site;

/// Segments of a drive that are spelled out.
const SEGMENTS: usize = 6;

/// Digits of a hash that pages show.
const HASH_DIGITS: usize = 16;

/// The lower half of a run's page.
#[derive(Debug, Serialize)]
pub struct Evidence {
    status: String,
    drive: String,
    tags: Vec<TagGroup>,
    channels: Vec<ChannelRow>,
    clocks: Vec<ClockRow>,
    offsets: Vec<OffsetRow>,
    flags: Vec<FlagRow>,
    files: Vec<FileRow>,
    facts: Vec<(String, String)>,
    history: Vec<Revision>,
}

/// Tags that one source states.
#[derive(Debug, Serialize)]
struct TagGroup {
    origin: String,
    detail: String,
    /// Whether stronger sources overruled them.
    overruled: bool,
    /// Keys with their values.
    tags: Vec<(String, String)>,
}

#[derive(Debug, Serialize)]
struct ChannelRow {
    quantity: String,
    raw: String,
    readings: String,
    times: String,
    values: String,
}

#[derive(Debug, Serialize)]
struct FileRow {
    path: String,
    size: String,
    hash: String,
    aliases: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Revision {
    revision: u32,
    ingested: String,
    hashes: Vec<String>,
    current: bool,
}

/// Gathers the evidence of `record`.
pub fn evidence(site: &Site, record: &RunRecord) -> Evidence {
    Evidence {
        status: status(record),
        drive: record
            .drive
            .as_ref()
            .map_or_else(|| "not known".to_owned(), drive_text),
        tags: tags(record),
        channels: record.channels.iter().map(channel).collect(),
        clocks: clocks::clocks(record),
        offsets: clocks::offsets(record),
        flags: clocks::flags(record),
        files: record.files.iter().map(file).collect(),
        facts: facts(record),
        history: history(site, record),
    }
}

fn status(record: &RunRecord) -> String {
    let word = match record.status {
        RunStatus::Complete => "complete",
        RunStatus::Aborted => "aborted",
        RunStatus::StoppedEarly => "stopped early",
        RunStatus::Cut => "cut off",
        RunStatus::StillRunning => "still running when read",
        RunStatus::Unknown => "not known",
    };
    match record.status_evidence.is_empty() {
        true => word.to_owned(),
        false => format!("{word}: {}", record.status_evidence),
    }
}

/// `from 0 V: 2.5 V at 0 s, open circuit at 600 s`
fn drive_text(drive: &Drive) -> String {
    let segment = |segment: &crate::domain::Segment| {
        let level = match segment.level {
            Level::Voltage(voltage_v) => voltage_label(voltage_v),
            Level::OpenCircuit => "open circuit".to_owned(),
        };
        format!("{level} at {} s", plain(segment.start_s))
    };
    let shown: Vec<String> = drive.segments.iter().take(SEGMENTS).map(segment).collect();
    let more = match drive.segments.len().saturating_sub(SEGMENTS) {
        0 => String::new(),
        more => format!(", and {more} more"),
    };
    format!(
        "from {}: {}{more}",
        voltage_label(drive.baseline_v),
        shown.join(", ")
    )
}

/// The tags by source, in stored order; after the first of a key, others are overruled, and left out where they say the
/// same.
fn tags(record: &RunRecord) -> Vec<TagGroup> {
    let mut groups: Vec<TagGroup> = Vec::new();
    for (index, tag) in record.tags.iter().enumerate() {
        let ruling = record.tags[..index].iter().find(|earlier| earlier.key == tag.key);
        if ruling.is_some_and(|ruling| ruling.value == tag.value) {
            continue;
        }
        let overruled = ruling.is_some();
        let origin = tag.source.label();
        let pair = (tag.key.clone(), tag.value.clone());
        let alike = |group: &&mut TagGroup| {
            (group.origin.as_str(), group.detail.as_str(), group.overruled)
                == (origin, tag.detail.as_str(), overruled)
        };
        match groups.iter_mut().find(alike) {
            Some(group) => group.tags.push(pair),
            None => groups.push(TagGroup {
                origin: origin.to_owned(),
                detail: tag.detail.clone(),
                overruled,
                tags: vec![pair],
            }),
        }
    }
    groups.sort_by_key(|group| group.overruled);
    groups
}

fn channel(channel: &ChannelSummary) -> ChannelRow {
    let unit = channel.quantity.unit();
    let between = |first: Option<f64>, last: Option<f64>, unit: &str| match (first, last) {
        (Some(first), Some(last)) => format!("{} … {}", in_unit(first, unit), in_unit(last, unit)),
        _ => "–".to_owned(),
    };
    let excluded = match channel.excluded {
        0 => String::new(),
        excluded => format!(", {excluded} left out"),
    };
    ChannelRow {
        quantity: match channel.quantity {
            Quantity::Other => "kept as it is".to_owned(),
            quantity => quantity.label().to_owned(),
        },
        raw: match channel.raw_unit.is_empty() {
            true => channel.raw_name.clone(),
            false => format!("{} [{}]", channel.raw_name, channel.raw_unit),
        },
        readings: format!("{}{excluded}", channel.readings),
        times: between(channel.first_time_s, channel.last_time_s, "s"),
        values: between(channel.first, channel.last, unit),
    }
}

fn file(file: &crate::domain::RunFile) -> FileRow {
    FileRow {
        path: file.path.clone(),
        size: size(file.size_bytes),
        hash: short_hash(&file.hash),
        aliases: file.aliases.clone(),
    }
}

/// The beginning of a hash, which tells any two files apart; the export and `explain` have all of it.
fn short_hash(hash: &str) -> String {
    hash.chars().take(HASH_DIGITS).collect()
}

fn size(bytes: u64) -> String {
    match bytes {
        0..=999 => format!("{bytes} B"),
        _ => in_unit(bytes as f64, "B"),
    }
}

fn facts(record: &RunRecord) -> Vec<(String, String)> {
    let mut facts = vec![
        ("Format", clocks::format(record)),
        ("Taken in", moment(&record.ingested_at)),
        ("Data hash", short_hash(&record.data_hash)),
    ];
    if let Some(technique) = &record.technique {
        facts.insert(1, ("Technique", technique.clone()));
    }
    if let Some(area_cm2) = record.area_cm2 {
        facts.insert(1, ("Active area", format!("{} cm²", significant(area_cm2, 3))));
    }
    facts
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
}

/// Every revision of this path, the newest first; empty where there has been one only.
fn history(site: &Site, record: &RunRecord) -> Vec<Revision> {
    let earlier = site.input.superseded.iter().filter(|old| old.path == record.path);
    let mut revisions: Vec<&RunRecord> = earlier.chain([record]).collect();
    if revisions.len() == 1 {
        return vec![];
    }
    revisions.sort_by_key(|run| std::cmp::Reverse(run.revision));
    let revision = |run: &RunRecord| Revision {
        revision: run.revision,
        ingested: moment(&run.ingested_at),
        hashes: run.files.iter().map(|file| short_hash(&file.hash)).collect(),
        current: run.revision == record.revision,
    };
    revisions.into_iter().map(revision).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Segment;

    #[test]
    fn drives_in_words() {
        let mut drive = Drive::step(2.5);
        assert_eq!(drive_text(&drive), "from 0\u{a0}V: 2.5\u{a0}V at 0 s");
        let pulse = |k: i32| Segment {
            start_s: 10.0 * f64::from(k),
            level: Level::OpenCircuit,
        };
        drive.segments = (0..8).map(pulse).collect();
        assert!(drive_text(&drive).ends_with("open circuit at 50 s, and 2 more"));
    }
}
