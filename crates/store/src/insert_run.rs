//! Stores a run that was read: its row, its files, its readings.

use rusqlite::{OptionalExtension, params};

use super::blob::{hash_of, pack_f64, pack_u32};
use super::columns::to_json;
use super::measurement::{make_room, supersede_row};
use super::new_run::{ChannelDocument, NewRun, ReadDocument, RunContent};
use super::rows::{RUN, RUN_FILE};
use super::{StepError, StoreError, Transaction};
use ieap_domain::{Channel, RunFile, RunOrigin};

/// Stores a run as the new current revision of its name; gives its number.
pub(super) fn insert_run(transaction: &Transaction<'_>, now: &str, run: &NewRun) -> Result<i64, StepError> {
    let continues = make_room(transaction, now, run)?;
    let revision: i64 = transaction
        .prepare_cached("SELECT coalesce(max(revision), 0) + 1 FROM run WHERE path = ?1")?
        .query_row([&run.path], |row| row.get(0))?;
    let channels = run.channels.iter().enumerate();
    let packed = channels
        .map(|(ordinal, channel)| PackedChannel::of(&run.channels[..ordinal], channel))
        .collect::<Result<Vec<_>, StoreError>>()?;
    let reading = to_json("what was read of a run", &read_document(run, &packed))?;
    let (tagging, curves) = run.tagging.documents()?;
    let run_id = transaction.change(RUN, ("path = ?1 AND superseded_at IS NULL", &run.path), || {
        let sql = "INSERT INTO run (path, revision, kind, state, data_hash, measurement, continues, tag_digest, ingested_at,
                     reading, tagging, climate_curves)
                   VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12)";
        transaction.prepare_cached(sql)?.execute(params![
            run.path,
            revision,
            run.kind.key(),
            run.tagging.state.key(),
            run.data_hash,
            run.measurement,
            continues,
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

/// Retires the current revision of a run.
pub(super) fn supersede(transaction: &Transaction<'_>, now: &str, path: &str) -> Result<(), StepError> {
    let current = transaction
        .prepare_cached("SELECT id FROM run WHERE path = ?1 AND superseded_at IS NULL")?
        .query_row([path], |row| row.get::<_, i64>(0))
        .optional()?;
    current.map_or(Ok(()), |id| supersede_row(transaction, now, id))
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
