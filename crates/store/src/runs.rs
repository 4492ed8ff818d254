//! Runs: their readings, tags and issues, revision by revision.

use std::collections::BTreeMap;
use std::sync::Arc;

use rusqlite::{OptionalExtension, Row, params};

use super::blob::{unpack_f64, unpack_u32};
use super::columns::{count_in, from_json, key_in, series_in, to_json};
use super::files::{take_new_name, upsert_file};
use super::journal::{Entry, NamedBytes, NamedRun};
use super::new_run::{NewRun, Tagging, insert_run, insert_tagging, stored_state};
use super::origin::{delete_stated_offset, shift};
use super::read_files::supersede_parts;
use super::results::{self, retire_of_run};
use super::tags::read_tag;
use super::{FileRow, RunContent, StepError, Store, StoreError, Subject};
use ieap_domain::data_hash::data_hash;
use ieap_domain::left_out;
use ieap_domain::tag::keys;
use ieap_domain::{
    Channel, ChannelSummary, Issue, Quantity, RunFile, RunKind, RunOrigin, RunRecord, RunState, RunStatus,
    Severity, Standing, Tag,
};

impl Store {
    /// Stores what was read from files, whole or not at all: the files, their contents, and each run as the
    /// new current revision of its name.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_runs(&mut self, now: &str, files: &[FileRow], runs: &[NewRun]) -> Result<(), StoreError> {
        self.write("storing a run", now, |transaction| {
            let mut named = Vec::with_capacity(runs.len());
            for run in runs {
                let revision = insert_run(transaction, now, run)?;
                let name = run.path.clone();
                named.push(NamedRun { name, revision });
            }
            if let Some(first) = runs.first() {
                let named_bytes = |content: &RunContent| NamedBytes {
                    path: content.path.clone(),
                    hash: content.hash.clone(),
                };
                let read = Entry::Read {
                    kind: first.kind,
                    reader: first.format.clone(),
                    files: first.contents.iter().map(named_bytes).collect(),
                    runs: named,
                };
                transaction.says(now, read);
            }
            supersede_parts(transaction, now, runs)?;
            files.iter().try_for_each(|file| upsert_file(transaction, file))
        })
    }

    /// Puts new tags, and what follows from them, in place of those of a run.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn retag(&mut self, now: &str, run_id: i64, tagging: &Tagging) -> Result<(), StoreError> {
        self.write("storing tags", now, |transaction| {
            transaction.changes(Subject::Run(run_id))?;
            transaction.execute("DELETE FROM tag WHERE run_id = ?1", [run_id])?;
            transaction.execute(
                "DELETE FROM run_issue WHERE run_id = ?1 AND stage = 'tag'",
                [run_id],
            )?;
            let sql = "UPDATE run SET state = ?2, drive = ?3, area_cm2 = ?4, length_cm = ?5, tag_digest = ?6,
                       electrode_resistance_ohm_per_sq = ?7, no_steps = ?8 WHERE id = ?1";
            delete_stated_offset(transaction, run_id)?;
            let drive = tagging
                .drive
                .as_ref()
                .map(|drive| to_json("a drive", drive))
                .transpose()?;
            transaction.prepare_cached(sql)?.execute(params![
                run_id,
                stored_state(tagging.state).key(),
                drive,
                tagging.area_cm2,
                tagging.length_cm,
                tagging.digest,
                tagging.electrode_resistance_ohm_per_sq,
                tagging.state == RunState::NoSteps
            ])?;
            if tagging.state != RunState::Ready {
                let name: String = transaction
                    .prepare_cached("SELECT path FROM run WHERE id = ?1")?
                    .query_row([run_id], |row| row.get(0))?;
                retire_of_run(transaction, now, &name)?;
            }
            insert_tagging(transaction, run_id, tagging)
        })
    }

    /// Gives a run the name of the file that now holds its bytes.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn rename_run(&mut self, now: &str, old: &str, new: &str, file: &FileRow) -> Result<(), StoreError> {
        self.write("renaming a run", now, |transaction| {
            transaction.changes(Subject::Runs)?;
            for id in transaction.ids("SELECT id FROM run WHERE path = ?1", old)? {
                transaction.changes(Subject::Run(id))?;
            }
            for name in [old, new] {
                transaction.changes(Subject::HandTags(name.to_owned()))?;
            }
            transaction.changes(Subject::RunWords)?;
            transaction.changes(Subject::AskedFits)?;
            transaction.execute(
                "UPDATE run_file SET path = ?2 WHERE path = ?1 AND run_id IN (SELECT id FROM run WHERE path = ?1)",
                [old, new],
            )?;
            transaction.execute(
                "UPDATE run_clock SET file = ?2 WHERE file = ?1 AND run_id IN (SELECT id FROM run WHERE path = ?1)",
                [old, new],
            )?;
            transaction.execute("UPDATE run SET path = ?2 WHERE path = ?1", [old, new])?;
            transaction.execute("UPDATE hand_tag SET run_path = ?2 WHERE run_path = ?1", [old, new])?;
            transaction.execute("UPDATE run_word SET run_path = ?2 WHERE run_path = ?1", [old, new])?;
            transaction.execute("UPDATE OR REPLACE asked_fit SET run_path = ?2 WHERE run_path = ?1", [old, new])?;
            results::rename(transaction, old, new)?;
            take_new_name(transaction, now, old, file)
        })
    }

    /// Names of current runs and their files' paths that hold the bytes of `hash`.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn runs_with_content(&self, hash: &str) -> Result<Vec<(String, String)>, StoreError> {
        let doing = "looking for known bytes";
        let sql = "SELECT run.path, run_file.path FROM run_file JOIN run ON run.id = run_file.run_id
                   WHERE run_file.hash = ?1 AND run.superseded_at IS NULL ORDER BY run.path, run_file.ordinal";
        self.rows(doing, sql, [hash], |row| Ok((row.get(0)?, row.get(1)?)))
    }

    /// Paths and hashes of the files of the current run of that name, in order.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn contents_of(&self, path: &str) -> Result<Vec<(String, String)>, StoreError> {
        let doing = "reading a run";
        let sql = "SELECT run_file.path, run_file.hash FROM run_file JOIN run ON run.id = run_file.run_id
                   WHERE run.path = ?1 AND run.superseded_at IS NULL ORDER BY run_file.ordinal";
        self.rows(doing, sql, [path], |row| Ok((row.get(0)?, row.get(1)?)))
    }

    /// Whether a run of that name was stored, now or earlier.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn has_run(&self, path: &str) -> Result<bool, StoreError> {
        self.connection
            .prepare_cached("SELECT count(*) FROM run WHERE path = ?1")
            .and_then(|mut statement| statement.query_row([path], |row| row.get::<_, i64>(0)))
            .map(|count| count > 0)
            .map_err(|e| self.failed("looking for a run", e))
    }

    /// Format id and reader version of the current run of that name, as `id/version`.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn reader_of(&self, path: &str) -> Result<Option<String>, StoreError> {
        let sql = "SELECT format || '/' || reader_version FROM run WHERE path = ?1 AND superseded_at IS NULL";
        self.connection
            .prepare_cached(sql)
            .and_then(|mut statement| statement.query_row([path], |row| row.get(0)).optional())
            .map_err(|e| self.failed("looking for a run", e))
    }

    /// Row id, name and tag digest of every current run.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn tag_digests(&self) -> Result<Vec<(i64, String, String)>, StoreError> {
        let sql = "SELECT id, path, tag_digest FROM run WHERE superseded_at IS NULL ORDER BY path";
        self.rows("reading tag digests", sql, [], |row| {
            Ok((row.get("id")?, row.get("path")?, row.get("tag_digest")?))
        })
    }

    /// Row id of every current run, its chosen `started_at`, and the first and last time of its readings, s.
    ///
    /// # Errors
    /// See [`StoreError`].
    #[allow(clippy::type_complexity)]
    pub fn run_times(&self) -> Result<Vec<(i64, Option<String>, Option<(f64, f64)>)>, StoreError> {
        let sql = "SELECT id,
                     (SELECT value FROM tag WHERE run_id = run.id AND +key = 'started_at' AND chosen = 1) AS started_at,
                     (SELECT min(first_time_s) FROM channel WHERE run_id = run.id) AS first_s,
                     (SELECT max(last_time_s) FROM channel WHERE run_id = run.id) AS last_s
                   FROM run WHERE superseded_at IS NULL ORDER BY id";
        self.rows("reading when runs were", sql, [], |row| {
            let (first_s, last_s): (Option<f64>, Option<f64>) = (row.get("first_s")?, row.get("last_s")?);
            Ok((row.get("id")?, row.get("started_at")?, first_s.zip(last_s)))
        })
    }

    /// Paths of a run's files, in order.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn file_paths(&self, run_id: i64) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT path FROM run_file WHERE run_id = ?1 ORDER BY ordinal";
        self.rows_of(run_id, sql, |row| Ok(row.get(0)?))
    }

    /// Whether the run's clock starts at the voltage step, and whether its technique is a step response.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn reading_facts(&self, run_id: i64) -> Result<(bool, bool), StoreError> {
        self.connection
            .query_row(
                "SELECT time_zero_is_step, is_step_response FROM run WHERE id = ?1",
                [run_id],
                |row| Ok((row.get(0)?, row.get(1)?)),
            )
            .map_err(|e| self.failed("reading a run", e))
    }

    /// Readings of a run, with the clock offsets applied that are stated, and those left out that its tags leave out.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn channels(&self, run_id: i64) -> Result<Vec<Channel>, StoreError> {
        let mut channels = self.channels_as_read(run_id)?;
        if let Some((index, area_cm2)) =
            self.density_as_current(run_id, channels.iter().map(|c| c.quantity))?
        {
            channels[index] = channels[index].as_current(area_cm2);
        }
        if let Some(tag) = self.chosen_tag(run_id, keys::LEAVE_OUT_MARKED)? {
            left_out::leave_out_marked(&mut channels, &tag, &self.origin_of_checked(run_id)?.flags);
        }
        for (first, count, offset_s) in self.applied_offsets(run_id)? {
            let timed = first.min(channels.len())..(first + count).min(channels.len());
            shift(&mut channels[timed], offset_s);
        }
        for (first, count) in self.own_clocks(run_id)? {
            let timed = first.min(channels.len())..(first + count).min(channels.len());
            channels[timed]
                .iter_mut()
                .for_each(|channel| channel.own_clock = true);
        }
        // What is no list of stretches was pointed out when the run was tagged.
        let stretches = self.chosen_tag(run_id, keys::LEAVE_OUT)?;
        let stretches = stretches.and_then(|text| left_out::stretches(&text));
        left_out::leave_out(&mut channels, &stretches.unwrap_or_default());
        Ok(channels)
    }

    /// Which channel is a current density that stands for the current, and the active area, cm2, that makes it one: the
    /// first, where no current was measured and the area is known.
    fn density_as_current(
        &self,
        run_id: i64,
        mut quantities: impl Iterator<Item = Quantity> + Clone,
    ) -> Result<Option<(usize, f64)>, StoreError> {
        let has_current = quantities.clone().any(|quantity| quantity == Quantity::Current);
        let density = quantities.position(|quantity| quantity == Quantity::CurrentDensity);
        let Some(index) = density.filter(|_| !has_current) else {
            return Ok(None);
        };
        let sql = "SELECT area_cm2 FROM run WHERE id = ?1";
        let area_cm2: Option<f64> = self
            .connection
            .query_row(sql, [run_id], |row| row.get(0))
            .map_err(|e| self.failed("reading an area", e))?;
        Ok(area_cm2.map(|area_cm2| (index, area_cm2)))
    }

    fn chosen_tag(&self, run_id: i64, key: &str) -> Result<Option<String>, StoreError> {
        self.connection
            .prepare_cached("SELECT value FROM tag WHERE run_id = ?1 AND +key = ?2 AND chosen = 1")
            .and_then(|mut statement| {
                statement
                    .query_row(params![run_id, key], |row| row.get(0))
                    .optional()
            })
            .map_err(|e| self.failed("reading a tag", e))
    }

    /// Readings of a run with the times of their files.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn channels_as_read(&self, run_id: i64) -> Result<Vec<Channel>, StoreError> {
        let doing = "reading channels";
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Run(run_id))?;
        self.check_seal(&Subject::Readings(run_id))?;
        let sql =
            "SELECT quantity, raw_name, raw_unit, position_mm, time_of, time_blob, value_blob, excluded_blob
                   FROM channel WHERE run_id = ?1 ORDER BY ordinal";
        let mut statement = self
            .connection
            .prepare_cached(sql)
            .map_err(|e| self.failed(doing, e))?;
        let mut rows = statement.query([run_id]).map_err(|e| self.failed(doing, e))?;
        let mut channels: Vec<Channel> = Vec::new();
        while let Some(row) = rows.next().map_err(|e| self.failed(doing, e))? {
            let channel = read_channel(row, &channels).map_err(self.named(doing))?;
            channels.push(channel);
        }
        let stored: String = self
            .connection
            .prepare_cached("SELECT data_hash FROM run WHERE id = ?1")
            .and_then(|mut statement| statement.query_row([run_id], |row| row.get(0)))
            .map_err(|e| self.failed(doing, e))?;
        if stored == data_hash(&channels) {
            Ok(channels)
        } else {
            Err(StoreError::Damaged {
                what: format!("readings of run {run_id}"),
            })
        }
    }

    /// Every current actuation run with tags, issues, channels (without readings) and its current fit, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn runs(&self) -> Result<Vec<RunRecord>, StoreError> {
        self.current(RunKind::Actuation)
    }

    /// Every current modulus log with tags, issues and channels (without readings), by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn dma_logs(&self) -> Result<Vec<RunRecord>, StoreError> {
        self.current(RunKind::Dma)
    }

    /// Every current impedance spectrum with tags, issues and channels (without readings), by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn spectra(&self) -> Result<Vec<RunRecord>, StoreError> {
        self.current(RunKind::Impedance)
    }

    fn current(&self, kind: RunKind) -> Result<Vec<RunRecord>, StoreError> {
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Runs)?;
        let aliases = self.aliases()?;
        // Every row is held against its seal where the runs are read; to look for a few logs and spectra among them it need
        // not be done again.
        let sql = match kind {
            RunKind::Actuation => "SELECT id FROM run WHERE superseded_at IS NULL ORDER BY path".to_owned(),
            _ => format!(
                "SELECT id FROM run WHERE superseded_at IS NULL AND kind = '{}' ORDER BY path",
                kind.key()
            ),
        };
        let mut records = self.records(&sql, kind, |record| self.complete(record, &aliases))?;
        if kind == RunKind::Actuation {
            self.fill_in_fits(&mut records)?;
        }
        Ok(records)
    }

    /// The runs of a kind among those whose ids a query gives, with what `complete` fills in from other tables.
    pub(super) fn records(
        &self,
        ids: &str,
        kind: RunKind,
        complete: impl Fn(&mut RunRecord) -> Result<(), StoreError>,
    ) -> Result<Vec<RunRecord>, StoreError> {
        let doing = "reading runs";
        let ids: Vec<i64> = self.rows(doing, ids, [], |row| Ok(row.get(0)?))?;
        let sql = "SELECT id, path, revision, state, status, status_evidence, format, reader_version, technique, drive,
                          area_cm2, data_hash, ingested_at, kind, no_steps FROM run WHERE id = ?1";
        let mut records = Vec::new();
        for id in ids {
            self.check_seal(&Subject::Run(id))?;
            for mut record in self.rows(doing, sql, [id], read_record)? {
                if record.kind == kind {
                    complete(&mut record)?;
                    records.push(record);
                }
            }
        }
        Ok(records)
    }

    /// Fills in what other tables hold of a run.
    pub(super) fn complete(
        &self,
        record: &mut RunRecord,
        aliases: &BTreeMap<String, Vec<String>>,
    ) -> Result<(), StoreError> {
        record.files = self.run_files(record.id, aliases)?;
        record.tags = self.tags(record.id)?;
        record.channels = self.channel_summaries(record.id)?;
        record.origin = self.origin_of_checked(record.id)?;
        record.issues = self.run_issues(record.id)?;
        record.climate = self.run_climate(record.id)?;
        Ok(())
    }

    pub(super) fn run_files(
        &self,
        run_id: i64,
        aliases: &BTreeMap<String, Vec<String>>,
    ) -> Result<Vec<RunFile>, StoreError> {
        let sql = "SELECT path, hash, size_bytes FROM run_file JOIN content USING (hash)
                   WHERE run_id = ?1 ORDER BY ordinal";
        self.rows_of(run_id, sql, |row| {
            let hash: String = row.get("hash")?;
            Ok(RunFile {
                path: row.get("path")?,
                aliases: aliases.get(&hash).cloned().unwrap_or_default(),
                hash,
                size_bytes: row.get::<_, i64>("size_bytes")?.unsigned_abs(),
            })
        })
    }

    fn tags(&self, run_id: i64) -> Result<Vec<Tag>, StoreError> {
        let sql = "SELECT key, value, source, detail FROM tag WHERE run_id = ?1 ORDER BY ordinal";
        self.rows_of(run_id, sql, read_tag)
    }

    fn channel_summaries(&self, run_id: i64) -> Result<Vec<ChannelSummary>, StoreError> {
        let sql =
            "SELECT quantity, raw_name, raw_unit, readings, excluded, first_time_s, last_time_s, first_value,
                          last_value, position_mm FROM channel WHERE run_id = ?1 ORDER BY ordinal";
        let mut channels = self.rows_of(run_id, sql, |row| {
            Ok(ChannelSummary {
                quantity: key_in(row, "quantity", "a quantity", Quantity::from_key)?,
                raw_name: row.get("raw_name")?,
                raw_unit: row.get("raw_unit")?,
                readings: count_in(row, "readings")?,
                excluded: count_in(row, "excluded")?,
                first_time_s: row.get("first_time_s")?,
                last_time_s: row.get("last_time_s")?,
                first: row.get("first_value")?,
                last: row.get("last_value")?,
                position_mm: row.get("position_mm")?,
            })
        })?;
        let quantities = channels.iter().map(|channel| channel.quantity);
        if let Some((index, area_cm2)) = self.density_as_current(run_id, quantities)? {
            let channel = &mut channels[index];
            channel.quantity = Quantity::Current;
            let scaled = |density: Option<f64>| density.map(|density| density * area_cm2);
            (channel.first, channel.last) = (scaled(channel.first), scaled(channel.last));
        }
        Ok(channels)
    }

    fn run_issues(&self, run_id: i64) -> Result<Vec<Issue>, StoreError> {
        let sql =
            "SELECT severity, code, place, message, mend FROM run_issue WHERE run_id = ?1 ORDER BY ordinal";
        self.rows_of(run_id, sql, read_issue)
    }

    /// Rows of `sql` (one parameter: the run's id), read one by one.
    pub(super) fn rows_of<T>(
        &self,
        run_id: i64,
        sql: &str,
        read: impl Fn(&Row<'_>) -> Result<T, StepError>,
    ) -> Result<Vec<T>, StoreError> {
        self.rows("reading a run", sql, [run_id], read)
    }
}

fn read_channel(row: &Row<'_>, earlier: &[Channel]) -> Result<Channel, StepError> {
    let time_blob: Option<Vec<u8>> = row.get("time_blob")?;
    let time_s: Arc<[f64]> = match time_blob {
        Some(blob) => unpack_f64(&blob)?.into(),
        None => {
            let ordinal: i64 = row.get("time_of")?;
            let shared = usize::try_from(ordinal)
                .ok()
                .and_then(|ordinal| earlier.get(ordinal));
            let bad = StoreError::BadValue {
                what: "a channel's times",
                detail: format!("channel {ordinal}"),
            };
            shared.ok_or(bad)?.time_s.clone()
        }
    };
    let values: Arc<[f64]> = series_in(row, "value_blob")?.into();
    if values.len() != time_s.len() {
        let detail = format!("{} times, {} values", time_s.len(), values.len());
        return Err(StoreError::BadValue {
            what: "a channel's readings",
            detail,
        }
        .into());
    }
    Ok(Channel {
        quantity: key_in(row, "quantity", "a quantity", Quantity::from_key)?,
        raw_name: row.get("raw_name")?,
        raw_unit: row.get("raw_unit")?,
        position_mm: row.get("position_mm")?,
        time_s,
        values,
        excluded: unpack_u32(&row.get::<_, Vec<u8>>("excluded_blob")?)?.into(),
        own_clock: false,
    })
}

/// An issue from a row of `run_issue`.
pub(super) fn read_issue(row: &Row<'_>) -> Result<Issue, StepError> {
    Ok(Issue {
        severity: key_in(row, "severity", "a severity", Severity::from_key)?,
        code: row.get("code")?,
        place: row.get("place")?,
        message: row.get("message")?,
        mend: row.get("mend")?,
    })
}

fn read_record(row: &Row<'_>) -> Result<RunRecord, StepError> {
    let drive: Option<String> = row.get("drive")?;
    Ok(RunRecord {
        id: row.get("id")?,
        kind: key_in(row, "kind", "a run's kind", RunKind::from_key)?,
        path: row.get("path")?,
        revision: row.get("revision")?,
        state: if row.get("no_steps")? {
            RunState::NoSteps
        } else {
            key_in(row, "state", "a run's state", RunState::from_key)?
        },
        status: key_in(row, "status", "a run's status", RunStatus::from_key)?,
        status_evidence: row.get("status_evidence")?,
        format: row.get("format")?,
        reader_version: row.get("reader_version")?,
        technique: row.get("technique")?,
        files: Vec::new(),
        tags: Vec::new(),
        channels: Vec::new(),
        origin: RunOrigin::default(),
        drive: drive.map(|text| from_json("a run's drive", &text)).transpose()?,
        area_cm2: row.get("area_cm2")?,
        data_hash: row.get("data_hash")?,
        ingested_at: row.get("ingested_at")?,
        issues: Vec::new(),
        fit: None,
        fit_code_version: None,
        climate: Vec::new(),
        standing: Standing::default(),
    })
}
