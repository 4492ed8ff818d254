//! Stores what was read from a logger's file: a new log, a new revision, an alias, or why it was refused.

use schemars::JsonSchema;
use serde::Serialize;

use crate::analysis::climate::checks::{Checked, check};
use crate::analysis::climate::sensors::FOLDERS;
use crate::domain::{FileState, Issue};
use crate::ingest::Reading;
use crate::ingest::climate_log::{Log, Series, log};
use crate::pipeline::campaign::context::now;
use crate::pipeline::intake::ingest::{Outcome, PreparedFile, Readers, content_of, file_row, set_aside};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{FileRow, NewLog, NewSeries};

/// What became of the climate logs.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct LogSummary {
    /// Files in the folder of climate logs.
    pub files: usize,
    /// Logs that came in for the first time.
    pub new: Vec<String>,
    /// Logs whose file has new content.
    pub revised: Vec<String>,
    /// Logs that took the name of a moved file: old and new.
    pub renamed: Vec<(String, String)>,
    /// Files that hold the same bytes as a log, found now.
    pub aliases: Vec<String>,
    /// Files that the system could not give now, with what it said; told among all of [`crate::pipeline::IngestSummary`].
    #[serde(skip)]
    pub unread: Vec<(String, Issue)>,
}

impl LogSummary {
    /// Whether the database changed.
    pub fn changed(&self) -> bool {
        let lists = [&self.new, &self.revised, &self.aliases];
        lists.iter().any(|list| !list.is_empty()) || !self.renamed.is_empty()
    }
}

/// Whether climate logs are looked for at that path, where runs lie in `runs_folder`.
pub fn holds_logs(path: &str, runs_folder: &str) -> bool {
    FOLDERS
        .iter()
        .any(|folder| is_below(path, folder) && !is_below(runs_folder, folder))
}

/// Whether a path is a folder, or lies below it.
pub fn is_below(path: &str, folder: &str) -> bool {
    let rest = path.strip_prefix(folder);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// Folders of logs beside the runs folder.
pub fn log_folders(runs_folder: &str) -> Vec<&'static str> {
    (FOLDERS.into_iter())
        .filter(|folder| holds_logs(folder, runs_folder))
        .collect()
}

/// Stores a file of the folder of climate logs.
///
/// # Errors
/// The archive or the database refuses.
pub fn settle_log(
    context: &mut Context,
    readers: &Readers,
    prepared: &PreparedFile,
    summary: &mut LogSummary,
    observer: &dyn Observer,
) -> Result<(), PipelineError> {
    if let Some((state, issue)) = prepared.outcome.aside() {
        return set_aside(context, readers, prepared, state, issue, observer);
    }
    let Outcome::Read(reading) = &prepared.outcome else {
        summary.unread.extend(prepared.unread());
        return Ok(());
    };
    if is_known(context, readers, prepared, reading, summary)? {
        return Ok(());
    }
    let path = &prepared.file.display;
    match log(reading, path) {
        Err(issue) => set_aside(context, readers, prepared, FileState::Refused, &issue, observer),
        Ok(log) => store(context, readers, prepared, reading, log, summary, observer),
    }
}

/// Whether the bytes are those of a current log: then the file is that log's, or an alias of it.
fn is_known(
    context: &mut Context,
    readers: &Readers,
    prepared: &PreparedFile,
    reading: &Reading,
    summary: &mut LogSummary,
) -> Result<bool, PipelineError> {
    let Some(hash) = &prepared.hash else {
        return Ok(false);
    };
    let path = &prepared.file.display;
    let reader = readers.of_file(reading, prepared.profile.as_ref());
    let row = |state| file_row(&prepared.file, Some(hash.clone()), state, reader.clone(), None);
    let holders = context.store.logs_with_content(hash)?;
    let Some((holder, read_by)) = holders
        .iter()
        .find(|(holder, _)| holder == path)
        .or(holders.first())
    else {
        return Ok(false);
    };
    let now = now();
    if holder == path {
        let same_reader = *read_by == reader;
        if same_reader {
            context.store.record_files(&now, &[row(FileState::Log)])?;
        }
        return Ok(same_reader);
    }
    context.store.record_files(&now, &[row(FileState::Alias)])?;
    summary.aliases.push(path.clone());
    Ok(true)
}

fn store(
    context: &mut Context,
    readers: &Readers,
    prepared: &PreparedFile,
    reading: &Reading,
    log: Log,
    summary: &mut LogSummary,
    observer: &dyn Observer,
) -> Result<(), PipelineError> {
    let path = prepared.file.display.clone();
    let count = log.series.len();
    let Some((row, new)) = new_log(readers, prepared, reading, log) else {
        return Ok(());
    };
    let known = context.store.has_log(&path)?;
    let words = if known { "new revision of log" } else { "read log" };
    observer.say(&format!("{words} {path} ({}, {count} series)", reading.format));
    context.store.save_log(&now(), &row, &new)?;
    if known {
        &mut summary.revised
    } else {
        &mut summary.new
    }
    .push(path);
    Ok(())
}

/// A log as it is stored, with what is known of its file; none where its bytes are not archived.
pub fn new_log(
    readers: &Readers,
    prepared: &PreparedFile,
    reading: &Reading,
    log: Log,
) -> Option<(FileRow, NewLog)> {
    let content = content_of(prepared)?;
    let mut issues = reading.issues.clone();
    issues.extend(log.issues.clone());
    let data_hash = log.data_hash();
    let series = checked(&log.series, &mut issues);
    let new = NewLog {
        content,
        format: reading.format.to_owned(),
        reader_version: reading.reader_version,
        encoding: reading.encoding.map(str::to_owned),
        status: reading.status,
        status_evidence: reading.status_evidence.clone(),
        started_raw: log.started_raw,
        clock_start_s: log.clock_start_s,
        clock_offset: log.clock_offset,
        clock_set_back: log.clock_set_back,
        original_metadata: reading.original_metadata.clone(),
        issues,
        data_hash,
        series,
    };
    let reader = readers.of_file(reading, prepared.profile.as_ref());
    let row = file_row(
        &prepared.file,
        prepared.hash.clone(),
        FileState::Log,
        reader,
        None,
    );
    Some((row, new))
}

/// The series with what their readings show of the sensors.
fn checked(series: &[Series], issues: &mut Vec<Issue>) -> Vec<NewSeries> {
    let other = |one: &Series| {
        let is_other = |other: &&Series| other.sensor == one.sensor && other.quantity != one.quantity;
        series.iter().find(is_other)
    };
    series
        .iter()
        .map(|one| {
            let (found, not_used) = check(view(one), other(one).map(view));
            issues.extend(found);
            NewSeries {
                sensor: one.sensor.clone(),
                quantity: one.quantity,
                raw_name: one.raw_name.clone(),
                raw_unit: one.raw_unit.clone(),
                not_used,
                interval_s: one.interval_s,
                readings: one.readings.clone(),
            }
        })
        .collect()
}

fn view(series: &Series) -> Checked<'_> {
    Checked {
        sensor: &series.sensor,
        column: &series.raw_name,
        quantity: series.quantity,
        times_s: &series.readings.elapsed_s,
        values: &series.readings.values,
    }
}
