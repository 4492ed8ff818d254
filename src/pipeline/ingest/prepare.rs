//! Reads the files of one run: everything that needs neither the database nor the other files.

use std::path::Path;

use crate::domain::{Channel, Issue, Quantity, RunKind};
use crate::ingest::formats::{self, ReadContext};
use crate::ingest::scan::{self, ReadFileError, SeenFile};
use crate::ingest::{Reading, RunTable, archive};

/// Largest file that is read, bytes.
const LARGEST_FILE_BYTES: u64 = 1 << 30;

/// The files of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// The run's name.
    pub run_name: String,
    /// What is measured.
    pub kind: RunKind,
    /// Its files, in order of their paths.
    pub files: Vec<SeenFile>,
}

/// A file that was read, or why it could not be.
#[derive(Debug)]
pub struct PreparedFile {
    /// The file.
    pub file: SeenFile,
    /// Its bytes and their hash; none where it could not be opened or still grows.
    pub bytes: Option<(Vec<u8>, String)>,
    /// What the reader made of it.
    pub outcome: Outcome,
}

/// What a reader made of a file.
#[derive(Debug)]
pub enum Outcome {
    /// It was read.
    Read(Box<Reading>),
    /// It cannot be read.
    Refused(Issue),
    /// It has nothing to read yet.
    Pending(Issue),
    /// It belongs to a run and holds none.
    Sidecar(Issue),
}

/// A group with its files read.
#[derive(Debug)]
pub struct Prepared {
    /// The run's name.
    pub run_name: String,
    /// What is measured.
    pub kind: RunKind,
    /// Its files.
    pub files: Vec<PreparedFile>,
}

/// Reads every file of a group. Refusals are part of the outcome; a fault of a reader refuses its file only.
pub fn prepare(campaign: &Path, group: &Group) -> Prepared {
    Prepared {
        run_name: group.run_name.clone(),
        kind: group.kind,
        files: group
            .files
            .iter()
            .map(|file| prepare_file(campaign, group.kind, file))
            .collect(),
    }
}

fn prepare_file(campaign: &Path, kind: RunKind, file: &SeenFile) -> PreparedFile {
    let location = file.location(campaign);
    let bytes = match scan::read_stable(&location, LARGEST_FILE_BYTES) {
        Ok(bytes) => bytes,
        Err(error) => {
            // Reports name files relative to the campaign, so that they are the same on every machine.
            let message = error
                .to_string()
                .replace(&format!("{}: ", location.display()), "");
            let still_growing = matches!(error, ReadFileError::StillGrowing { .. });
            let outcome = match still_growing {
                true => Outcome::Pending(Issue::note("still-growing", message)),
                false => Outcome::Refused(Issue::error("not-read", message)),
            };
            return PreparedFile {
                file: file.clone(),
                bytes: None,
                outcome,
            };
        }
    };
    let hash = archive::hash(&bytes);
    let outcome = read(kind, file, &bytes);
    PreparedFile {
        file: file.clone(),
        bytes: Some((bytes, hash)),
        outcome,
    }
}

fn read(kind: RunKind, file: &SeenFile, bytes: &[u8]) -> Outcome {
    let context = ReadContext {
        // A modulus log may have its humidity in a file of its own.
        needs_response: kind == RunKind::Actuation,
        ..ReadContext::default()
    };
    let name = file.display.rsplit('/').next().unwrap_or(&file.display);
    match std::panic::catch_unwind(|| formats::read(name, bytes, &context)) {
        Ok(Ok(reading)) => Outcome::Read(Box::new(reading)),
        Ok(Err(error)) if error.is_pending() => Outcome::Pending(error.issue()),
        Ok(Err(error)) if error.is_sidecar() => Outcome::Sidecar(error.issue()),
        Ok(Err(error)) => Outcome::Refused(error.issue()),
        Err(_) => Outcome::Refused(
            Issue::error("reader-fault", "the reader stopped on an internal fault")
                .mend("report it with this file; the other files are not affected"),
        ),
    }
}

/// A table that becomes a run, with the name it adds to the file's.
#[derive(Debug, Clone, PartialEq)]
pub struct RunPart {
    /// `#TABLE` where the file holds several runs, else empty.
    pub suffix: String,
    /// Readings.
    pub channels: Vec<Channel>,
    /// Rows of the table.
    pub rows: usize,
    /// Whether time zero is the voltage step.
    pub time_zero_is_step: bool,
}

/// The runs that a reading holds: every table with a response (of a modulus log: with a modulus), or all tables
/// where none has one.
pub fn run_parts(reading: &Reading, kind: RunKind) -> Vec<RunPart> {
    let responds = |channel: &Channel| match kind {
        RunKind::Actuation => channel.is_response(),
        RunKind::Dma => channel.quantity.is_modulus(),
    };
    let has_response = |table: &&RunTable| table.channels.iter().any(responds);
    let mut tables: Vec<&RunTable> = reading.tables.iter().filter(has_response).collect();
    if tables.is_empty() {
        tables = reading.tables.iter().collect();
    }
    let several = tables.len() > 1;
    tables
        .iter()
        .map(|table| RunPart {
            suffix: if several {
                format!("#{}", table.name)
            } else {
                String::new()
            },
            channels: table.channels.clone(),
            rows: table.rows,
            time_zero_is_step: table.time_zero_is_step,
        })
        .collect()
}

/// Joins the tables of several files of one run: each gives the quantities that no file before it gave.
pub fn joined(readings: &[&Reading]) -> (RunPart, Vec<Issue>) {
    let mut part = RunPart {
        suffix: String::new(),
        channels: Vec::new(),
        rows: 0,
        time_zero_is_step: true,
    };
    let mut issues = Vec::new();
    for table in readings.iter().flat_map(|reading| &reading.tables) {
        part.rows += table.rows;
        part.time_zero_is_step &= table.time_zero_is_step;
        for channel in &table.channels {
            let given = part
                .channels
                .iter()
                .any(|c| c.quantity == channel.quantity && c.quantity != Quantity::Other);
            if given {
                let message = format!(
                    "{} stands in several files of the run; the first one counts",
                    channel.quantity.label()
                );
                issues
                    .push(Issue::warning("joined-twice", message).at(format!("column {}", channel.raw_name)));
            } else {
                part.channels.push(channel.clone());
            }
        }
    }
    (part, issues)
}
