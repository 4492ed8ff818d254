//! A run on its way into the database: what was read from its files, and the rows that it becomes.

use rusqlite::params;

use super::blob::{pack_f64, pack_u32};
use super::columns::to_json;
use super::origin::{insert_origin, insert_stated_offset};
use super::results::retire_of_run;
use super::run_climate::replace_climate;
use super::{StepError, Subject, Transaction};
use ieap_domain::{
    Channel, ClimateCurve, Drive, Issue, RunClimate, RunKind, RunOrigin, RunState, RunStatus, Tag,
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
        transaction
            .prepare_cached("INSERT OR IGNORE INTO content VALUES (?1, ?2, ?3, ?4)")?
            .execute(params![
                self.hash,
                self.size_bytes.cast_signed(),
                self.archive_path,
                now
            ])?;
        Ok(())
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

/// What the column `state` holds of a state: [`RunState::NoSteps`] is a mark beside it.
pub(super) fn stored_state(state: RunState) -> RunState {
    match state {
        RunState::NoSteps => RunState::NotFitted,
        other => other,
    }
}

/// Stores a run as the new current revision of its name; gives its number.
pub(super) fn insert_run(transaction: &Transaction<'_>, now: &str, run: &NewRun) -> Result<i64, StepError> {
    let revision = supersede(transaction, now, &run.path)? + 1;
    let tagging = &run.tagging;
    let drive = tagging
        .drive
        .as_ref()
        .map(|drive| to_json("a drive", drive))
        .transpose()?;
    let sql =
        "INSERT INTO run (path, revision, state, status, status_evidence, format, reader_version, technique,
                 is_step_response, encoding, time_zero_is_step, original_metadata, drive, area_cm2, length_cm,
                 data_hash, tag_digest, ingested_at, electrode_resistance_ohm_per_sq, kind, no_steps)
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19,
                 ?20, ?21)";
    transaction.prepare_cached(sql)?.execute(params![
        run.path,
        revision,
        stored_state(tagging.state).key(),
        run.status.key(),
        run.status_evidence,
        run.format,
        run.reader_version,
        run.technique,
        run.is_step_response,
        run.encoding,
        run.time_zero_is_step,
        to_json("a file's metadata", &run.original_metadata)?,
        drive,
        tagging.area_cm2,
        tagging.length_cm,
        run.data_hash,
        tagging.digest,
        now,
        tagging.electrode_resistance_ohm_per_sq,
        run.kind.key(),
        tagging.state == RunState::NoSteps,
    ])?;
    let run_id = transaction.last_insert_rowid();
    transaction.made(Subject::Run(run_id));
    transaction.made(Subject::Readings(run_id));
    transaction.made(Subject::ClimateCurves(run_id));
    insert_contents(transaction, now, run_id, &run.contents)?;
    insert_channels(transaction, run_id, &run.channels)?;
    insert_origin(transaction, now, run_id, &run.origin)?;
    insert_issues(transaction, run_id, "read", 0, &run.issues)?;
    insert_tagging(transaction, run_id, tagging)?;
    Ok(revision)
}

/// Retires the current revision of a run; gives the newest revision number so far (0: none).
pub(super) fn supersede(transaction: &Transaction<'_>, now: &str, path: &str) -> Result<i64, StepError> {
    transaction.changes(Subject::Runs)?;
    let current = "SELECT id FROM run WHERE path = ?1 AND superseded_at IS NULL";
    for id in transaction.ids(current, path)? {
        transaction.changes(Subject::Run(id))?;
    }
    transaction
        .prepare_cached("UPDATE run SET superseded_at = ?2 WHERE path = ?1 AND superseded_at IS NULL")?
        .execute(params![path, now])?;
    retire_of_run(transaction, now, path)?;
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
    for (ordinal, content) in contents.iter().enumerate() {
        content.insert(transaction, now)?;
        transaction
            .prepare_cached("INSERT INTO run_file VALUES (?1, ?2, ?3, ?4)")?
            .execute(params![run_id, ordinal as i64, content.path, content.hash])?;
    }
    Ok(())
}

fn insert_channels(
    transaction: &Transaction<'_>,
    run_id: i64,
    channels: &[Channel],
) -> Result<(), StepError> {
    let sql =
        "INSERT INTO channel VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16)";
    for (ordinal, channel) in channels.iter().enumerate() {
        let time_of = channels[..ordinal]
            .iter()
            .position(|earlier| earlier.time_s == channel.time_s);
        let time_blob = match time_of {
            Some(_) => None,
            None => Some(pack_f64(&channel.time_s)?),
        };
        let summary = channel.summary();
        transaction.prepare_cached(sql)?.execute(params![
            run_id,
            ordinal as i64,
            channel.quantity.key(),
            channel.raw_name,
            channel.raw_unit,
            channel.position_mm,
            channel.len() as i64,
            channel.excluded.len() as i64,
            summary.first_time_s,
            summary.last_time_s,
            summary.first,
            summary.last,
            time_of.unwrap_or(ordinal) as i64,
            time_blob,
            pack_f64(&channel.values)?,
            pack_u32(&channel.excluded)?,
        ])?;
    }
    Ok(())
}

/// Adds the tags of a run and what is to be known of them.
pub(super) fn insert_tagging(
    transaction: &Transaction<'_>,
    run_id: i64,
    tagging: &Tagging,
) -> Result<(), StepError> {
    replace_climate(transaction, run_id, &tagging.climate, &tagging.climate_curves)?;
    for (ordinal, tag) in tagging.tags.iter().enumerate() {
        transaction
            .prepare_cached("INSERT INTO tag VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)")?
            .execute(params![
                run_id,
                ordinal as i64,
                tag.key,
                tag.value,
                tag.source.key(),
                tag.detail,
                ordinal < tagging.chosen
            ])?;
    }
    if let Some(offset_s) = tagging.clock_offset_s {
        insert_stated_offset(transaction, run_id, offset_s)?;
    }
    let first: i64 = transaction
        .prepare_cached("SELECT coalesce(max(ordinal) + 1, 0) FROM run_issue WHERE run_id = ?1")?
        .query_row([run_id], |row| row.get(0))?;
    insert_issues(transaction, run_id, "tag", first, &tagging.issues)
}

pub(super) fn insert_issues(
    transaction: &Transaction<'_>,
    run_id: i64,
    stage: &str,
    first: i64,
    issues: &[Issue],
) -> Result<(), StepError> {
    for (ordinal, issue) in (first..).zip(issues) {
        transaction
            .prepare_cached("INSERT INTO run_issue VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)")?
            .execute(params![
                run_id,
                ordinal,
                stage,
                issue.severity.key(),
                issue.code,
                issue.place,
                issue.message,
                issue.mend
            ])?;
    }
    Ok(())
}
