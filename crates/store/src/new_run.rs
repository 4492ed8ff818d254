//! A run on its way into the database: what was read from its files, its tags, and the documents that both become.

use std::collections::BTreeMap;

use rusqlite::{Row, params};
use serde::{Deserialize, Serialize};

use super::blob::{hash_of, packed_json};
use super::columns::{json_in, key_in, to_json};
use super::rows::{CONTENT, RUN, RowHash, check, stated};
use super::{StepError, StoreError, Transaction};
use ieap_domain::{
    Channel, ChannelSummary, ClimateCurve, Drive, Issue, Quantity, RunClimate, RunFile, RunKind, RunOrigin,
    RunState, RunStatus, Tag, TagSource,
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

/// Whether what was read is what had its name before, with other bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Continues {
    /// It is: measured on, or mended.
    Same,
    /// Another measurement was saved under the name.
    Another,
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
    /// What it is known by ([`super::measurement`]).
    pub measurement: String,
    /// Whether it is what had its name before.
    pub continues: Continues,
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
#[serde(from = "FlatChannel")]
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
#[serde(from = "FlatTag")]
pub(super) struct TagOfSource {
    #[serde(flatten)]
    pub tag: Tag,
    pub chosen: bool,
}

/// A tag as its document has it. Every look at a campaign reads those of all runs, and what is flattened is read twice.
#[derive(Deserialize)]
struct FlatTag {
    key: String,
    value: String,
    source: TagSource,
    detail: String,
    chosen: bool,
}

impl From<FlatTag> for TagOfSource {
    fn from(flat: FlatTag) -> TagOfSource {
        TagOfSource {
            tag: Tag {
                key: flat.key,
                value: flat.value,
                source: flat.source,
                detail: flat.detail,
            },
            chosen: flat.chosen,
        }
    }
}

/// A channel as its document has it, for the same reason.
#[derive(Deserialize)]
struct FlatChannel {
    ordinal: usize,
    hash: String,
    quantity: Quantity,
    raw_name: String,
    raw_unit: String,
    position_mm: Option<f64>,
    readings: usize,
    excluded: usize,
    first_time_s: Option<f64>,
    last_time_s: Option<f64>,
    first: Option<f64>,
    last: Option<f64>,
}

impl From<FlatChannel> for ChannelDocument {
    fn from(flat: FlatChannel) -> ChannelDocument {
        ChannelDocument {
            ordinal: flat.ordinal,
            hash: flat.hash,
            summary: ChannelSummary {
                quantity: flat.quantity,
                raw_name: flat.raw_name,
                raw_unit: flat.raw_unit,
                position_mm: flat.position_mm,
                readings: flat.readings,
                excluded: flat.excluded,
                first_time_s: flat.first_time_s,
                last_time_s: flat.last_time_s,
                first: flat.first,
                last: flat.last,
            },
        }
    }
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
    pub measurement: String,
    pub continues: String,
    pub tag_digest: String,
    pub ingested_at: String,
    pub row_hash: RowHash,
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
            measurement: row.get("measurement")?,
            continues: row.get("continues")?,
            tag_digest: row.get("tag_digest")?,
            ingested_at: row.get("ingested_at")?,
            row_hash: stated(row)?,
            reading: json_in(row, "reading", "what was read of a run")?,
            tagging: json_in(row, "tagging", "the tags of a run")?,
        })
    }

    /// What was noticed when it was read and when it was tagged.
    pub fn issues(&self) -> impl Iterator<Item = &Issue> {
        self.reading.issues.iter().chain(&self.tagging.issues)
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
