//! What a run rests on: channels, drive, files, versions, history.

use serde::Serialize;

use super::run_clocks as clocks;
use super::wording::{in_unit, voltage_label};
use crate::pages::policy::MOST_SEGMENTS;
use crate::site::Site;
use ieap_domain::number::{plain, significant};
use ieap_domain::{ChannelSummary, Drive, Quantity, RunCurve, RunRecord, RunStatus};
use ieap_show::{Block, Sheet};

/// Digits of a hash that pages show.
const HASH_DIGITS: usize = 16;

/// What a run rests on, apart from its tags and channels.
#[derive(Debug, Default, Serialize)]
pub struct Evidence {
    /// Each with what it is a fact of.
    pub facts: Vec<Fact>,
    files: Vec<FileRow>,
    /// What stands below them: clock offsets, flagged stretches, revisions.
    #[serde(skip)]
    pub tables: Vec<Block>,
}

/// `Drive`, `from 0 V: 2.5 V at 0 s`
pub type Fact = (String, String);

/// A channel in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelText {
    /// Quantity.
    pub quantity: String,
    /// Name in the file.
    pub name: String,
    /// Name and unit in the file, number of readings, times.
    pub what: String,
    /// `from −2.70 µA to 560 µA`, or the first and the last reading where the extremes are not known.
    pub range: String,
}

#[derive(Debug, Serialize)]
struct FileRow {
    path: String,
    size: String,
    hash: String,
    aliases: Vec<String>,
}

/// Gathers the evidence of a run.
pub fn evidence(site: &Site, run: usize) -> Evidence {
    let record = site.input.record(run);
    Evidence {
        facts: facts(site, record),
        files: record.files.iter().map(file).collect(),
        tables: [clocks::offsets(record), clocks::flags(record), history(site, run)]
            .into_iter()
            .flatten()
            .collect(),
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
    if record.status_evidence.is_empty() {
        word.to_owned()
    } else {
        format!("{word}: {}", record.status_evidence)
    }
}

fn to_millivolt(volts: f64) -> f64 {
    (1e3 * volts).round() / 1e3
}

/// `from 0 V: 2.5 V at 0 s, open circuit at 600 s`
fn drive_text(drive: &Drive) -> String {
    let segment = |(start_s, volts): (f64, Option<f64>)| {
        let level = volts.map_or("open circuit".to_owned(), voltage_label);
        format!("{level} at {} s", plain(start_s))
    };
    if drive.moves() {
        let volts = drive.levels().filter_map(|(_, volts)| volts);
        let (low_v, high_v) = ieap_domain::range_of(volts);
        return format!(
            "from {}: moving all the time between {} and {} from {} s on, as {} steps",
            voltage_label(drive.baseline_v),
            voltage_label(to_millivolt(low_v)),
            voltage_label(to_millivolt(high_v)),
            plain(drive.segments[0].start_s()),
            drive.segments.len()
        );
    }
    let shown: Vec<String> = drive.levels().take(MOST_SEGMENTS).map(segment).collect();
    let more = match drive.segments.len().saturating_sub(MOST_SEGMENTS) {
        0 => String::new(),
        more => format!(", and {more} more"),
    };
    format!(
        "from {}: {}{more}",
        voltage_label(drive.baseline_v),
        shown.join(", ")
    )
}

/// The channels of `record`; extremes come from its drawn curves, which keep them.
pub fn channels(record: &RunRecord, curves: &[RunCurve]) -> Vec<ChannelText> {
    record
        .channels
        .iter()
        .map(|channel| channel_text(channel, curves))
        .collect()
}

fn channel_text(channel: &ChannelSummary, curves: &[RunCurve]) -> ChannelText {
    let unit = channel.quantity.unit();
    let shown = |value: f64| in_unit(value, unit);
    let raw = if channel.raw_unit.is_empty() {
        channel.raw_name.clone()
    } else {
        format!("{} [{}]", channel.raw_name, channel.raw_unit)
    };
    let excluded = match channel.excluded {
        0 => String::new(),
        excluded => format!(", {excluded} left out"),
    };
    let times = match (channel.first_time_s, channel.last_time_s) {
        (Some(first), Some(last)) => format!(", {} … {}", in_unit(first, "s"), in_unit(last, "s")),
        _ => String::new(),
    };
    let drawn = curves
        .iter()
        .find(|curve| curve.quantity == channel.quantity && channel.position_mm.is_none());
    let range = match (drawn.and_then(extremes), channel.first, channel.last) {
        (Some((low, high)), ..) => format!("from {} to {}", shown(low), shown(high)),
        (None, Some(first), Some(last)) => format!("first {}, last {}", shown(first), shown(last)),
        _ => String::new(),
    };
    ChannelText {
        quantity: match channel.quantity {
            Quantity::Other => "kept as it is".to_owned(),
            quantity => quantity.label().to_owned(),
        },
        name: channel.raw_name.clone(),
        what: format!("{raw}, {} readings{excluded}{times}", channel.readings),
        range,
    }
}

/// The smallest and the largest reading of a curve: thinning keeps both.
fn extremes(curve: &RunCurve) -> Option<(f64, f64)> {
    let finite = || curve.measured.iter().copied().filter(|value| value.is_finite());
    Some((finite().reduce(f64::min)?, finite().reduce(f64::max)?))
}

fn file(file: &ieap_domain::RunFile) -> FileRow {
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

fn facts(site: &Site, record: &RunRecord) -> Vec<Fact> {
    let drive = record.drive.as_ref();
    let mut facts = vec![
        ("Ended", status(record)),
        ("Drive", drive.map_or_else(|| "not known".to_owned(), drive_text)),
        ("Format", clocks::format(record)),
    ];
    if let Some(technique) = &record.technique {
        facts.push(("Technique", technique.clone()));
    }
    if let Some(area_cm2) = record.area_cm2 {
        facts.push(("Active area", format!("{} cm²", significant(area_cm2, 3))));
    }
    facts.push(("Taken in", site.zone().moment(&record.ingested_at)));
    facts.push(("Data hash", short_hash(&record.data_hash)));
    facts.extend(clocks::clocks(record).into_iter().map(|clock| ("Times", clock)));
    facts
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
}

/// Every revision of this path, the newest first; none where there has been one only.
fn history(site: &Site, run: usize) -> Option<Block> {
    let record = site.input.record(run);
    let mut revisions: Vec<&RunRecord> = site.superseded(run).chain([record]).collect();
    revisions.sort_by_key(|run| std::cmp::Reverse(run.revision));
    let table = Sheet::<&RunRecord>::new("revisions", "", 1)
        .plain("Revision", |run| match run.revision {
            this if this == record.revision => format!("{this} (this one)"),
            earlier => earlier.to_string(),
        })
        .plain("Taken in", |run| site.zone().moment(&run.ingested_at))
        .plain("Hashes of its files", |run| {
            let hashes = run.files.iter().map(|file| short_hash(&file.hash));
            hashes.collect::<Vec<_>>().join(", ")
        })
        .over(revisions);
    (table.rows.len() > 1).then(|| Block::part("Revisions", vec![Block::Table(table)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::{Level, Segment};

    #[test]
    fn drives_in_words() {
        let mut drive = Drive::step(2.5);
        assert_eq!(drive_text(&drive), "from 0\u{a0}V: 2.5\u{a0}V at 0 s");
        let pulse = |k: i32| Segment::at(10.0 * f64::from(k), Level::OpenCircuit);
        drive.segments = (0..8).map(pulse).collect();
        assert!(drive_text(&drive).ends_with("open circuit at 50 s, and 2 more"));
    }
}
