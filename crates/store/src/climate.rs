//! Climate logs: files of loggers, their series, and what they come to together.

use rusqlite::{OptionalExtension, Row, params};
use serde::{Deserialize, Serialize};

use super::blob::{hash_of, pack_f64, unpack_f64};
use super::columns::{json_in, to_json};
use super::files::upsert_file;
use super::journal::{Entry, NamedBytes};
use super::results::ResultDocument;
use super::rows::CLIMATE_LOG;
use super::{FileRow, RunContent, StepError, Store, StoreError, Transaction};
use ieap_domain::{ClimateAssessment, ClimateQuantity, Issue, LogReadings, LogSeries, RunStatus};

impl ResultDocument for ClimateAssessment {}

/// A log that was read from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct NewLog {
    /// The raw file.
    pub content: RunContent,
    /// Format id of the reader.
    pub format: String,
    /// Version of that reader.
    pub reader_version: u32,
    /// Text encoding.
    pub encoding: Option<String>,
    /// Whole or cut.
    pub status: RunStatus,
    /// The evidence for `status`.
    pub status_evidence: String,
    /// Date of the first row as the file has it.
    pub started_raw: String,
    /// The same, s since 1970-01-01T00:00 on the file's own clock.
    pub clock_start_s: f64,
    /// Offset of that clock from UTC where the file states it.
    pub clock_offset: Option<String>,
    /// Where the clock was set back: time since the first row and by how much, s.
    pub clock_set_back: Vec<(f64, f64)>,
    /// The vendor's metadata.
    pub original_metadata: Vec<(String, String)>,
    /// What a reader must know.
    pub issues: Vec<Issue>,
    /// BLAKE3 of readings and clock.
    pub data_hash: String,
    /// Its series.
    pub series: Vec<NewSeries>,
}

/// A series of a new log.
#[derive(Debug, Clone, PartialEq)]
pub struct NewSeries {
    /// The sensor as the file names it.
    pub sensor: String,
    /// What is measured.
    pub quantity: ClimateQuantity,
    /// Name of the column.
    pub raw_name: String,
    /// Unit of the column.
    pub raw_unit: String,
    /// Why its readings are not used.
    pub not_used: Option<String>,
    /// Time between most readings, s.
    pub interval_s: f64,
    /// Readings, timed from the log's first row.
    pub readings: LogReadings,
}

/// What stands in the column `reading`.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct LogDocument {
    format: String,
    reader_version: u32,
    encoding: Option<String>,
    status: RunStatus,
    status_evidence: String,
    started_raw: String,
    clock_start_s: f64,
    clock_offset: Option<String>,
    clock_set_back: Vec<(f64, f64)>,
    data_hash: String,
    issues: Vec<Issue>,
    series: Vec<SeriesDocument>,
    original_metadata: Vec<(String, String)>,
}

/// A series without its readings, and the hash of the blobs that hold them.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct SeriesDocument {
    sensor: String,
    quantity: ClimateQuantity,
    raw_name: String,
    raw_unit: String,
    not_used: Option<String>,
    readings: usize,
    interval_s: f64,
    first_s: f64,
    length_s: f64,
    hash: String,
}

/// A revision of a log as it is stored.
struct LogRow {
    id: i64,
    path: String,
    hash: String,
    reading: LogDocument,
}

/// A log without its series.
#[derive(Debug, Clone, PartialEq)]
pub struct LogRecord {
    /// Path of its file.
    pub path: String,
    /// Format id of its reader.
    pub format: String,
    /// What a reader must know of it.
    pub issues: Vec<Issue>,
}

impl Store {
    /// Stores a log, whole or not at all: the file, its content, and the log as the current revision of its path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_log(&mut self, now: &str, file: &FileRow, log: &NewLog) -> Result<(), StoreError> {
        self.write("storing a climate log", now, |transaction| {
            let revision = insert_log(transaction, now, log)?;
            let file_of_log = NamedBytes {
                path: log.content.path.clone(),
                hash: log.content.hash.clone(),
            };
            let entry = Entry::Log {
                file: file_of_log,
                revision,
            };
            transaction.says(now, entry)?;
            upsert_file(transaction, file)
        })
    }

    /// Paths of the current logs that hold the bytes of `hash`, with their reader as `id/version`.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn logs_with_content(&self, hash: &str) -> Result<Vec<(String, String)>, StoreError> {
        let mut logs = self.current_logs()?;
        logs.retain(|log| log.hash == hash);
        let of = |log: LogRow| {
            (
                log.path,
                format!("{}/{}", log.reading.format, log.reading.reader_version),
            )
        };
        Ok(logs.into_iter().map(of).collect())
    }

    /// Whether a log of that path was stored, now or earlier.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn has_log(&self, path: &str) -> Result<bool, StoreError> {
        self.connection
            .prepare_cached("SELECT 1 FROM climate_log WHERE path = ?1 LIMIT 1")
            .and_then(|mut statement| statement.query_row([path], |_| Ok(())).optional())
            .map(|found| found.is_some())
            .map_err(|e| self.failed("looking for a climate log", e))
    }

    /// Every current log, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn logs(&self) -> Result<Vec<LogRecord>, StoreError> {
        let of = |log: LogRow| LogRecord {
            path: log.path,
            format: log.reading.format,
            issues: log.reading.issues,
        };
        Ok(self.current_logs()?.into_iter().map(of).collect())
    }

    /// Every series of the current logs, by path and order in the file.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn log_series(&self) -> Result<Vec<LogSeries>, StoreError> {
        let logs = self.current_logs()?;
        Ok(logs.into_iter().flat_map(series_of).collect())
    }

    /// Readings of a series.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn log_readings(&self, series: &LogSeries) -> Result<LogReadings, StoreError> {
        let doing = "reading a climate series";
        let _moment = self.snapshot()?;
        let log = self.kept(
            doing,
            CLIMATE_LOG,
            ("", "WHERE id = ?1"),
            [series.log_id],
            read_log,
        )?;
        let ordinal = series.ordinal as usize;
        let document = log.first().and_then(|log| log.reading.series.get(ordinal));
        let sql = "SELECT coalesce(own.time_blob, shared.time_blob) AS time_blob, own.value_blob
                   FROM climate_series AS own
                   JOIN climate_series AS shared ON shared.log_id = own.log_id AND shared.ordinal = own.time_of
                   WHERE own.log_id = ?1 AND own.ordinal = ?2";
        let blobs = self.rows(doing, sql, params![series.log_id, series.ordinal], |row| {
            let time: Option<Vec<u8>> = row.get("time_blob")?;
            Ok((time.unwrap_or_default(), row.get::<_, Vec<u8>>("value_blob")?))
        })?;
        let is_whole = |(time, values): &&(Vec<u8>, Vec<u8>)| {
            document.is_some_and(|document| document.hash == hash_of(&[time, values]))
        };
        let (time, values) = blobs.iter().find(is_whole).ok_or_else(|| StoreError::Damaged {
            what: format!("series {} of climate log {}", series.ordinal, series.path),
        })?;
        Ok(LogReadings {
            elapsed_s: unpack_f64(time)?,
            values: unpack_f64(values)?,
        })
    }

    /// Path and hash of the file of every current log.
    pub(super) fn log_files(&self) -> Result<Vec<(String, String)>, StoreError> {
        Ok(self
            .current_logs()?
            .into_iter()
            .map(|log| (log.path, log.hash))
            .collect())
    }

    /// Every current log as it is stored, by path.
    fn current_logs(&self) -> Result<Vec<LogRow>, StoreError> {
        let mut logs = self.listed("reading climate logs", CLIMATE_LOG, "climate_log", read_log)?;
        logs.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(logs)
    }
}

fn read_log(row: &Row<'_>) -> Result<LogRow, StepError> {
    Ok(LogRow {
        id: row.get("id")?,
        path: row.get("path")?,
        hash: row.get("hash")?,
        reading: json_in(row, "reading", "what was read of a climate log")?,
    })
}

fn series_of(log: LogRow) -> Vec<LogSeries> {
    let LogRow {
        id, path, reading, ..
    } = log;
    let series = reading.series.into_iter().zip(0..);
    let of = |(series, ordinal): (SeriesDocument, u32)| LogSeries {
        log_id: id,
        ordinal,
        path: path.clone(),
        data_hash: reading.data_hash.clone(),
        sensor: series.sensor,
        quantity: series.quantity,
        not_used: series.not_used,
        readings: series.readings,
        interval_s: series.interval_s,
        clock_start_s: reading.clock_start_s,
        first_s: series.first_s,
        length_s: series.length_s,
        clock_offset: reading.clock_offset.clone(),
        clock_set_back: reading.clock_set_back.clone(),
    };
    series.map(of).collect()
}

fn insert_log(transaction: &Transaction<'_>, now: &str, log: &NewLog) -> Result<i64, StepError> {
    let content = &log.content;
    content.insert(transaction, now)?;
    let packed = log
        .series
        .iter()
        .map(PackedSeries::of)
        .collect::<Result<Vec<_>, _>>()?;
    let reading = to_json("what was read of a climate log", &log_document(log, &packed))?;
    let current = (
        "path = ?1 AND superseded_at IS NULL",
        &content.path as &dyn rusqlite::ToSql,
    );
    let (log_id, revision) = transaction.change(CLIMATE_LOG, current, || {
        transaction
            .prepare_cached("UPDATE climate_log SET superseded_at = ?2 WHERE path = ?1 AND superseded_at IS NULL")?
            .execute(params![content.path, now])?;
        let revision: i64 = transaction
            .prepare_cached("SELECT coalesce(max(revision), 0) + 1 FROM climate_log WHERE path = ?1")?
            .query_row([&content.path], |row| row.get(0))?;
        let sql = "INSERT INTO climate_log (path, revision, hash, ingested_at, reading) VALUES (?1, ?2, ?3, ?4, ?5)";
        let values = params![content.path, revision, content.hash, now, reading];
        transaction.prepare_cached(sql)?.execute(values)?;
        Ok((transaction.last_insert_rowid(), revision))
    })?;
    insert_series(transaction, log_id, &packed)?;
    Ok(revision)
}

fn log_document(log: &NewLog, packed: &[PackedSeries]) -> LogDocument {
    let series = log.series.iter().zip(packed);
    let of = |(series, packed): (&NewSeries, &PackedSeries)| {
        let times = &series.readings.elapsed_s;
        let (first_s, last_s) = (
            times.first().copied().unwrap_or(0.0),
            times.last().copied().unwrap_or(0.0),
        );
        SeriesDocument {
            sensor: series.sensor.clone(),
            quantity: series.quantity,
            raw_name: series.raw_name.clone(),
            raw_unit: series.raw_unit.clone(),
            not_used: series.not_used.clone(),
            readings: series.readings.values.len(),
            interval_s: series.interval_s,
            first_s,
            length_s: last_s - first_s,
            hash: hash_of(&[&packed.time, &packed.values]),
        }
    };
    LogDocument {
        format: log.format.clone(),
        reader_version: log.reader_version,
        encoding: log.encoding.clone(),
        status: log.status,
        status_evidence: log.status_evidence.clone(),
        started_raw: log.started_raw.clone(),
        clock_start_s: log.clock_start_s,
        clock_offset: log.clock_offset.clone(),
        clock_set_back: log.clock_set_back.clone(),
        data_hash: log.data_hash.clone(),
        issues: log.issues.clone(),
        series: series.map(of).collect(),
        original_metadata: log.original_metadata.clone(),
    }
}

/// The blobs of a series.
struct PackedSeries {
    time: Vec<u8>,
    values: Vec<u8>,
}

impl PackedSeries {
    fn of(series: &NewSeries) -> Result<PackedSeries, StoreError> {
        Ok(PackedSeries {
            time: pack_f64(&series.readings.elapsed_s)?,
            values: pack_f64(&series.readings.values)?,
        })
    }
}

/// A series whose times are those of an earlier one is stored without them.
fn insert_series(
    transaction: &Transaction<'_>,
    log_id: i64,
    series: &[PackedSeries],
) -> Result<(), StepError> {
    for (ordinal, one) in series.iter().enumerate() {
        let time_of = series[..ordinal]
            .iter()
            .position(|earlier| earlier.time == one.time);
        transaction
            .prepare_cached("INSERT INTO climate_series VALUES (?1, ?2, ?3, ?4, ?5)")?
            .execute(params![
                log_id,
                ordinal as i64,
                time_of.unwrap_or(ordinal) as i64,
                time_of.is_none().then_some(&one.time),
                one.values,
            ])?;
    }
    Ok(())
}
