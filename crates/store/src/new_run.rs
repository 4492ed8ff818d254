//! A run on its way into the database: what was read from its files, its tags, and the documents that both become.

use std::collections::BTreeMap;

use rusqlite::{OptionalExtension, Row, params};
use serde::{Deserialize, Serialize};

use super::blob::{hash_of, pack_f64, pack_u32, packed_json};
use super::columns::{json_in, key_in, to_json};
use super::results::retire_of_run;
use super::rows::{CONTENT, RUN, RUN_FILE, check};
use super::{StepError, StoreError, Transaction};
use ieap_domain::{
    Channel, ChannelSummary, ClimateCurve, Drive, Issue, RunClimate, RunFile, RunKind, RunOrigin, RunState,
    RunStatus, Tag,
};

/// Raw bytes that are archived.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunContent {
    /// Path of the file, relative, with `/`.
    pub path: String,
    /// BLAKE3 of the bytes, hexadecimal.
    pub hash: String,
    /// Size, bytes.
    pub size_bytes: u64,
    /// Where the archive holds it, relative to the campaign.
    pub archive_path: String,
}

impl RunContent {
    /// Lists its bytes as archived, where they are not yet.
    pub(super) fn insert(&self, transaction: &Transaction<'_>, now: &str) -> Result<(), StepError> {
        transaction.change(CONTENT, ("hash = ?1", &self.hash), || {
            transaction
                .prepare_cached(
                    "INSERT OR IGNORE INTO content (hash, size_bytes, archive_path, ingested_at)
                     VALUES (?1, ?2, ?3, ?4)",
                )?
                .execute(params![
                    self.hash,
                    self.size_bytes.cast_signed(),
                    self.archive_path,
                    now
                ])?;
            Ok(())
        })
    }
}

/// What follows from the tags of a run, and what they came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Tagging {
    /// Whether the run can be fitted.
    pub state: RunState,
    /// Every tag, the chosen ones first.
    pub tags: Vec<Tag>,
    /// How many of `tags` are the chosen ones.
    pub chosen: usize,
    /// Disagreements, unknown samples, missing tags.
    pub issues: Vec<Issue>,
    /// The drive, where it is known.
    pub drive: Option<Drive>,
    /// Active area of the sample, cm2, where it is known.
    pub area_cm2: Option<f64>,
    /// Free length of the sample, cm, where it is known.
    pub length_cm: Option<f64>,
    /// Resistance of both electrodes along the strip, Ohm per square, where it was measured.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
    /// What the tag `clock_offset_s` states, s: added to the times of every clock but the reference.
    pub clock_offset_s: Option<f64>,
    /// BLAKE3 over everything the tags came from.
    pub digest: String,
    /// Climate during the run.
    pub climate: Vec<RunClimate>,
    /// Climate around the run, to draw.
    pub climate_curves: Vec<ClimateCurve>,
}

/// A run that was read from one or several files.
#[derive(Debug, Clone, PartialEq)]
pub struct NewRun {
    /// What is measured.
    pub kind: RunKind,
    /// The run's name.
    pub path: String,
    /// Raw files.
    pub contents: Vec<RunContent>,
    /// Format id of the reader.
    pub format: String,
    /// Version of that reader.
    pub reader_version: u32,
    /// Technique as the file names it.
    pub technique: Option<String>,
    /// Whether that is a response to a piecewise-constant voltage.
    pub is_step_response: bool,
    /// Text encoding.
    pub encoding: Option<String>,
    /// How the measurement ended.
    pub status: RunStatus,
    /// The evidence for `status`.
    pub status_evidence: String,
    /// Whether time zero is known to be the voltage step.
    pub time_zero_is_step: bool,
    /// The vendor's metadata.
    pub original_metadata: Vec<(String, String)>,
    /// Readings.
    pub channels: Vec<Channel>,
    /// BLAKE3 of the readings.
    pub data_hash: String,
    /// Clocks, flags and profiles that the readings rest on.
    pub origin: RunOrigin,
    /// What the reader noticed.
    pub issues: Vec<Issue>,
    /// Tags and what follows from them.
    pub tagging: Tagging,
}

/// What stands in the column `reading`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ReadDocument {
    pub format: String,
    pub reader_version: u32,
    pub technique: Option<String>,
    pub is_step_response: bool,
    pub encoding: Option<String>,
    pub status: RunStatus,
    pub status_evidence: String,
    pub time_zero_is_step: bool,
    pub files: Vec<RunFile>,
    pub channels: Vec<ChannelDocument>,
    pub origin: RunOrigin,
    pub issues: Vec<Issue>,
    pub original_metadata: Vec<(String, String)>,
}

/// A channel without its readings, and the hash of the blobs that hold them.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ChannelDocument {
    pub ordinal: usize,
    pub hash: String,
    #[serde(flatten)]
    pub summary: ChannelSummary,
}

/// What stands in the column `tagging`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct TagDocument {
    pub chosen: BTreeMap<String, String>,
    pub tags: Vec<TagOfSource>,
    pub issues: Vec<Issue>,
    pub drive: Option<Drive>,
    pub area_cm2: Option<f64>,
    pub length_cm: Option<f64>,
    pub electrode_resistance_ohm_per_sq: Option<f64>,
    pub clock_offset_s: Option<f64>,
    pub climate: Vec<RunClimate>,
    /// Hash of the climate around the run, which stands in a column of its own.
    pub climate_curves_hash: Option<String>,
}

/// A tag and whether its value holds.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct TagOfSource {
    #[serde(flatten)]
    pub tag: Tag,
    pub chosen: bool,
}

/// A revision of a run as it is stored.
#[derive(Debug, Clone)]
pub(super) struct RunRow {
    pub id: i64,
    pub path: String,
    pub revision: u32,
    pub kind: RunKind,
    pub state: RunState,
    pub data_hash: String,
    pub tag_digest: String,
    pub ingested_at: String,
    pub reading: ReadDocument,
    pub tagging: TagDocument,
}

impl RunRow {
    /// From a row of [`RUN`].
    pub fn read(row: &Row<'_>) -> Result<RunRow, StepError> {
        Ok(RunRow {
            id: row.get("id")?,
            path: row.get("path")?,
            revision: row.get("revision")?,
            kind: key_in(row, "kind", "a run's kind", RunKind::from_key)?,
            state: key_in(row, "state", "a run's state", RunState::from_key)?,
            data_hash: row.get("data_hash")?,
            tag_digest: row.get("tag_digest")?,
            ingested_at: row.get("ingested_at")?,
            reading: json_in(row, "reading", "what was read of a run")?,
            tagging: json_in(row, "tagging", "the tags of a run")?,
        })
    }

    /// The run of that row id; none where it is no current one.
    pub fn current(transaction: &Transaction<'_>, run_id: i64) -> Result<Option<RunRow>, StepError> {
        let sql = RUN.select("", "WHERE id = ?1 AND superseded_at IS NULL");
        let mut statement = transaction.prepare_cached(&sql)?;
        let mut rows = statement.query([run_id])?;
        let Some(row) = rows.next()? else { return Ok(None) };
        check(RUN, row)?;
        RunRow::read(row).map(Some)
    }
}

/// Stores a run as the new current revision of its name; gives its number.
pub(super) fn insert_run(transaction: &Transaction<'_>, now: &str, run: &NewRun) -> Result<i64, StepError> {
    let revision = supersede(transaction, now, &run.path)? + 1;
    let channels = run.channels.iter().enumerate();
    let packed = channels
        .map(|(ordinal, channel)| PackedChannel::of(&run.channels[..ordinal], channel))
        .collect::<Result<Vec<_>, StoreError>>()?;
    let reading = to_json("what was read of a run", &read_document(run, &packed))?;
    let (tagging, curves) = run.tagging.documents()?;
    let run_id = transaction.change(RUN, ("path = ?1 AND superseded_at IS NULL", &run.path), || {
        let sql = "INSERT INTO run (path, revision, kind, state, data_hash, tag_digest, ingested_at, reading, tagging,
                     climate_curves)
                   VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)";
        transaction.prepare_cached(sql)?.execute(params![
            run.path,
            revision,
            run.kind.key(),
            run.tagging.state.key(),
            run.data_hash,
            run.tagging.digest,
            now,
            reading,
            tagging,
            curves,
        ])?;
        Ok(transaction.last_insert_rowid())
    })?;
    insert_contents(transaction, now, run_id, &run.contents)?;
    insert_profiles(transaction, now, &run.origin)?;
    for (ordinal, channel) in packed.iter().enumerate() {
        channel.insert(transaction, run_id, ordinal)?;
    }
    Ok(revision)
}

fn read_document(run: &NewRun, packed: &[PackedChannel]) -> ReadDocument {
    let file = |content: &RunContent| RunFile {
        path: content.path.clone(),
        hash: content.hash.clone(),
        size_bytes: content.size_bytes,
        aliases: Vec::new(),
    };
    let channels = run.channels.iter().zip(packed).enumerate();
    let channel = |(ordinal, (channel, packed)): (usize, (&Channel, &PackedChannel))| ChannelDocument {
        ordinal,
        hash: packed.hash.clone(),
        summary: channel.summary(),
    };
    ReadDocument {
        format: run.format.clone(),
        reader_version: run.reader_version,
        technique: run.technique.clone(),
        is_step_response: run.is_step_response,
        encoding: run.encoding.clone(),
        status: run.status,
        status_evidence: run.status_evidence.clone(),
        time_zero_is_step: run.time_zero_is_step,
        files: run.contents.iter().map(file).collect(),
        channels: channels.map(channel).collect(),
        origin: run.origin.clone(),
        issues: run.issues.clone(),
        original_metadata: run.original_metadata.clone(),
    }
}

impl Tagging {
    /// What stands in the columns `tagging` and `climate_curves`.
    pub(super) fn documents(&self) -> Result<(String, Option<Vec<u8>>), StoreError> {
        let curves = match &self.climate_curves[..] {
            [] => None,
            curves => Some(packed_json("the climate around a run", curves)?),
        };
        let chosen = self.tags.iter().take(self.chosen);
        let tags = self.tags.iter().enumerate();
        let document = TagDocument {
            chosen: chosen.map(|tag| (tag.key.clone(), tag.value.clone())).collect(),
            tags: tags
                .map(|(ordinal, tag)| TagOfSource {
                    tag: tag.clone(),
                    chosen: ordinal < self.chosen,
                })
                .collect(),
            issues: self.issues.clone(),
            drive: self.drive.clone(),
            area_cm2: self.area_cm2,
            length_cm: self.length_cm,
            electrode_resistance_ohm_per_sq: self.electrode_resistance_ohm_per_sq,
            clock_offset_s: self.clock_offset_s,
            climate: self.climate.clone(),
            climate_curves_hash: curves.as_ref().map(|curves| hash_of(&[curves])),
        };
        Ok((to_json("the tags of a run", &document)?, curves))
    }
}

/// Retires the current revision of a run; gives the newest revision number so far (0: none).
pub(super) fn supersede(transaction: &Transaction<'_>, now: &str, path: &str) -> Result<i64, StepError> {
    let current = transaction
        .prepare_cached("SELECT id FROM run WHERE path = ?1 AND superseded_at IS NULL")?
        .query_row([path], |row| row.get::<_, i64>(0))
        .optional()?;
    if let Some(id) = current {
        transaction.change(RUN, ("id = ?1", &id), || {
            transaction
                .prepare_cached("UPDATE run SET superseded_at = ?2 WHERE id = ?1")?
                .execute(params![id, now])?;
            Ok(())
        })?;
        retire_of_run(transaction, now, id)?;
    }
    Ok(transaction
        .prepare_cached("SELECT coalesce(max(revision), 0) FROM run WHERE path = ?1")?
        .query_row([path], |row| row.get(0))?)
}

fn insert_contents(
    transaction: &Transaction<'_>,
    now: &str,
    run_id: i64,
    contents: &[RunContent],
) -> Result<(), StepError> {
    contents
        .iter()
        .try_for_each(|content| content.insert(transaction, now))?;
    transaction.change(RUN_FILE, ("run_id = ?1", &run_id), || {
        for (ordinal, content) in contents.iter().enumerate() {
            transaction
                .prepare_cached("INSERT INTO run_file (run_id, ordinal, path, hash) VALUES (?1, ?2, ?3, ?4)")?
                .execute(params![run_id, ordinal as i64, content.path, content.hash])?;
        }
        Ok(())
    })
}

fn insert_profiles(transaction: &Transaction<'_>, now: &str, origin: &RunOrigin) -> Result<(), StepError> {
    for profile in &origin.profiles {
        transaction
            .prepare_cached("INSERT OR IGNORE INTO profile VALUES (?1, ?2, ?3, ?4, ?5)")?
            .execute(params![
                profile.digest,
                profile.id,
                profile.version,
                profile.text,
                now
            ])?;
    }
    Ok(())
}

/// The blobs of a channel.
struct PackedChannel {
    time_of: Option<usize>,
    time: Vec<u8>,
    values: Vec<u8>,
    excluded: Vec<u8>,
    hash: String,
}

impl PackedChannel {
    /// `earlier` are the channels before it, one of which may have its times.
    fn of(earlier: &[Channel], channel: &Channel) -> Result<PackedChannel, StoreError> {
        let time_of = earlier
            .iter()
            .position(|earlier| earlier.time_s == channel.time_s);
        let (time, values) = (pack_f64(&channel.time_s)?, pack_f64(&channel.values)?);
        let excluded = pack_u32(&channel.excluded)?;
        Ok(PackedChannel {
            time_of,
            hash: hash_of(&[&time, &values, &excluded]),
            time,
            values,
            excluded,
        })
    }

    fn insert(&self, transaction: &Transaction<'_>, run_id: i64, ordinal: usize) -> Result<(), StepError> {
        transaction
            .prepare_cached("INSERT INTO channel VALUES (?1, ?2, ?3, ?4, ?5, ?6)")?
            .execute(params![
                run_id,
                ordinal as i64,
                self.time_of.unwrap_or(ordinal) as i64,
                self.time_of.is_none().then_some(&self.time),
                self.values,
                self.excluded,
            ])?;
        Ok(())
    }
}
