//! Climate logs: files of loggers, their series, and what they come to together.

use rusqlite::{Row, params};

use super::blob::pack_f64;
use super::columns::{count_in, json_in, key_in, series_in, to_json};
use super::files::{take_new_name, upsert_file};
use super::journal::{Entry, NamedBytes};
use super::{FileRow, RunContent, StepError, Store, StoreError, Subject, Transaction};
use ieap_domain::{ClimateAssessment, ClimateQuantity, Issue, LogReadings, LogSeries, RunStatus};

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
            transaction.says(now, entry);
            upsert_file(transaction, file)
        })
    }

    /// Gives a log the name of the file that now holds its bytes.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn rename_log(&mut self, now: &str, old: &str, new: &str, file: &FileRow) -> Result<(), StoreError> {
        self.write("renaming a climate log", now, |transaction| {
            transaction.changes(Subject::Logs)?;
            for id in transaction.ids("SELECT id FROM climate_log WHERE path = ?1", old)? {
                transaction.changes(Subject::Log(id))?;
            }
            transaction.execute("UPDATE climate_log SET path = ?2 WHERE path = ?1", [old, new])?;
            take_new_name(transaction, now, old, file)
        })
    }

    /// Paths of the current logs that hold the bytes of `hash`, with their reader as `id/version`.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn logs_with_content(&self, hash: &str) -> Result<Vec<(String, String)>, StoreError> {
        let sql = "SELECT path, format || '/' || reader_version FROM climate_log
                   WHERE hash = ?1 AND superseded_at IS NULL ORDER BY path";
        self.all_of(sql, [hash], |row| Ok((row.get(0)?, row.get(1)?)))
    }

    /// Whether a log of that path was stored, now or earlier.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn has_log(&self, path: &str) -> Result<bool, StoreError> {
        let sql = "SELECT 1 FROM climate_log WHERE path = ?1 LIMIT 1";
        Ok(!self.all_of(sql, [path], |_| Ok(()))?.is_empty())
    }

    /// Every current log, by path.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn logs(&self) -> Result<Vec<LogRecord>, StoreError> {
        self.check_logs()?;
        let sql = "SELECT path, format, issues FROM climate_log WHERE superseded_at IS NULL ORDER BY path";
        self.all_of(sql, [], |row| {
            Ok(LogRecord {
                path: row.get("path")?,
                format: row.get("format")?,
                issues: json_in(row, "issues", "a log's issues")?,
            })
        })
    }

    /// Every series of the current logs, by path and order in the file.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn log_series(&self) -> Result<Vec<LogSeries>, StoreError> {
        self.check_logs()?;
        let sql = "SELECT id, ordinal, path, data_hash, sensor, quantity, not_used, readings, interval_s,
                          clock_start_s, clock_offset, clock_set_back, first_s, length_s
                   FROM climate_series JOIN climate_log ON climate_log.id = climate_series.log_id
                   WHERE superseded_at IS NULL ORDER BY path, ordinal";
        self.all_of(sql, [], read_series)
    }

    /// Readings of a series.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn log_readings(&self, series: &LogSeries) -> Result<LogReadings, StoreError> {
        self.check_seal(&Subject::Series(series.log_id, series.ordinal.into()))?;
        let sql = "SELECT coalesce(own.time_blob, shared.time_blob) AS time_blob, own.value_blob
                   FROM climate_series AS own
                   JOIN climate_series AS shared ON shared.log_id = own.log_id AND shared.ordinal = own.time_of
                   WHERE own.log_id = ?1 AND own.ordinal = ?2";
        let found = self.all_of(sql, params![series.log_id, series.ordinal], |row| {
            Ok(LogReadings {
                elapsed_s: series_in(row, "time_blob")?,
                values: series_in(row, "value_blob")?,
            })
        })?;
        let whole = found
            .into_iter()
            .find(|readings| readings.elapsed_s.len() == readings.values.len());
        whole.ok_or_else(|| StoreError::BadValue {
            what: "a climate series",
            detail: format!("{} of {}", series.quantity.key(), series.path),
        })
    }

    /// What the logs came to when it was last computed, with the digest of what it was computed from.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn climate_assessment(&self) -> Result<Option<(String, ClimateAssessment)>, StoreError> {
        self.check_seal(&Subject::Assessment)?;
        let sql = "SELECT inputs, document FROM climate_assessment";
        let found = self.rows("reading the climate", sql, [], |row| {
            Ok((row.get("inputs")?, json_in(row, "document", "the climate")?))
        });
        Ok(found?.into_iter().next())
    }

    /// Puts a new assessment in place of the one before.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_climate_assessment(
        &mut self,
        now: &str,
        inputs: &str,
        assessment: &ClimateAssessment,
    ) -> Result<(), StoreError> {
        let document = to_json("the climate", assessment)?;
        self.write("storing the climate", now, |transaction| {
            transaction.changes(Subject::Assessment)?;
            let sql = "INSERT OR REPLACE INTO climate_assessment VALUES (1, ?1, ?2)";
            transaction.execute(sql, [inputs, &document])?;
            Ok(())
        })
    }

    /// Holds the current logs against their seals.
    fn check_logs(&self) -> Result<(), StoreError> {
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Logs)?;
        let sql = "SELECT id FROM climate_log WHERE superseded_at IS NULL ORDER BY path";
        let ids: Vec<i64> = self.all_of(sql, [], |row| Ok(row.get(0)?))?;
        ids.into_iter()
            .try_for_each(|id| self.check_seal(&Subject::Log(id)))
    }

    /// Rows of `sql`, read one by one.
    fn all_of<T>(
        &self,
        sql: &str,
        parameters: impl rusqlite::Params,
        read: impl Fn(&Row<'_>) -> Result<T, StepError>,
    ) -> Result<Vec<T>, StoreError> {
        self.rows("reading climate logs", sql, parameters, read)
    }
}

fn read_series(row: &Row<'_>) -> Result<LogSeries, StepError> {
    let first_s: f64 = row.get("first_s")?;
    let set_back: Vec<(f64, f64)> = json_in(row, "clock_set_back", "a clock")?;
    Ok(LogSeries {
        log_id: row.get("id")?,
        ordinal: row.get("ordinal")?,
        path: row.get("path")?,
        data_hash: row.get("data_hash")?,
        sensor: row.get("sensor")?,
        quantity: key_in(row, "quantity", "a quantity", ClimateQuantity::from_key)?,
        not_used: row.get("not_used")?,
        readings: count_in(row, "readings")?,
        interval_s: row.get("interval_s")?,
        clock_start_s: row.get("clock_start_s")?,
        first_s,
        length_s: row.get("length_s")?,
        clock_offset: row.get("clock_offset")?,
        clock_set_back: set_back,
    })
}

fn insert_log(transaction: &Transaction<'_>, now: &str, log: &NewLog) -> Result<i64, StepError> {
    let content = &log.content;
    content.insert(transaction, now)?;
    transaction.changes(Subject::Logs)?;
    let current = "SELECT id FROM climate_log WHERE path = ?1 AND superseded_at IS NULL";
    for id in transaction.ids(current, &content.path)? {
        transaction.changes(Subject::Log(id))?;
    }
    transaction
        .prepare_cached(
            "UPDATE climate_log SET superseded_at = ?2 WHERE path = ?1 AND superseded_at IS NULL",
        )?
        .execute(params![content.path, now])?;
    let revision: i64 = transaction
        .prepare_cached("SELECT coalesce(max(revision), 0) + 1 FROM climate_log WHERE path = ?1")?
        .query_row([&content.path], |row| row.get(0))?;
    let sql = "INSERT INTO climate_log (path, revision, hash, format, reader_version, encoding, status,
                 status_evidence, started_raw, clock_start_s, clock_offset, clock_set_back, original_metadata,
                 issues, data_hash, ingested_at)
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16)";
    transaction.prepare_cached(sql)?.execute(params![
        content.path,
        revision,
        content.hash,
        log.format,
        log.reader_version,
        log.encoding,
        log.status.key(),
        log.status_evidence,
        log.started_raw,
        log.clock_start_s,
        log.clock_offset,
        to_json("a clock", &log.clock_set_back)?,
        to_json("a file's metadata", &log.original_metadata)?,
        to_json("a log's issues", &log.issues)?,
        log.data_hash,
        now
    ])?;
    let log_id = transaction.last_insert_rowid();
    transaction.made(Subject::Log(log_id));
    insert_series(transaction, log_id, &log.series)?;
    Ok(revision)
}

fn insert_series(transaction: &Transaction<'_>, log_id: i64, series: &[NewSeries]) -> Result<(), StepError> {
    let sql =
        "INSERT INTO climate_series VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14)";
    for (ordinal, one) in series.iter().enumerate() {
        let times = &one.readings.elapsed_s;
        let time_of = series[..ordinal]
            .iter()
            .position(|earlier| earlier.readings.elapsed_s == *times);
        let time_blob = match time_of {
            Some(_) => None,
            None => Some(pack_f64(times)?),
        };
        let (first_s, last_s) = (
            times.first().copied().unwrap_or(0.0),
            times.last().copied().unwrap_or(0.0),
        );
        transaction.made(Subject::Series(log_id, ordinal as i64));
        transaction.prepare_cached(sql)?.execute(params![
            log_id,
            ordinal as i64,
            one.sensor,
            one.quantity.key(),
            one.raw_name,
            one.raw_unit,
            one.not_used,
            one.readings.values.len() as i64,
            one.interval_s,
            first_s,
            last_s - first_s,
            time_of.unwrap_or(ordinal) as i64,
            time_blob,
            pack_f64(&one.readings.values)?,
        ])?;
    }
    Ok(())
}
