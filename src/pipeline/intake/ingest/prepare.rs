//! Reads the files of one run: everything that needs neither the database nor the other files.

use std::path::Path;
use std::sync::Arc;

use super::frame_folder;
use crate::domain::fault::caught;
use crate::domain::{Campaign, Channel, FileState, Issue, Quantity, RunClock, RunKind, RunOrigin, Spectrum};
use crate::ingest::archive::{self, Archived};
use crate::ingest::being_read::BeingRead;
use crate::ingest::clocks::{self, FileClock};
use crate::ingest::folder_dates::order_beside;
use crate::ingest::formats::{ReadContext, ReadError};
use crate::ingest::profiles::{self, Profile, Profiles};
use crate::ingest::run_sheet;
use crate::ingest::scan::{ReadFileError, SeenFile};
use crate::ingest::{Reading, RunTable};
use crate::pipeline::campaign::context::ReadFile;

/// Largest file that is read, bytes.
pub const LARGEST_FILE_BYTES: u64 = 1 << 30;

/// The files of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// The run's name.
    pub run_name: String,
    /// What is measured.
    pub kind: RunKind,
    /// Its files, in order of their paths.
    pub files: Vec<Arc<SeenFile>>,
}

/// A file that was read, or why it could not be.
#[derive(Debug)]
pub struct PreparedFile {
    /// The file.
    pub file: SeenFile,
    /// BLAKE3 of its bytes; none where it could not be read or still grows.
    pub hash: Option<String>,
    /// Its bytes, until they are archived.
    pub bytes: Vec<u8>,
    /// Where its bytes lie, from when they are safe there.
    pub archived: Option<Archived>,
    /// What the reader made of it.
    pub outcome: Outcome,
    /// The profile that it was read with.
    pub profile: Option<Profile>,
}

impl PreparedFile {
    /// A file of which nothing was read.
    fn without_bytes(file: &SeenFile, outcome: Outcome) -> PreparedFile {
        PreparedFile {
            file: file.clone(),
            hash: None,
            bytes: Vec::new(),
            archived: None,
            outcome,
            profile: None,
        }
    }

    /// Its path and what the system said, where it could not give the file.
    pub fn unread(&self) -> Option<(String, Issue)> {
        match &self.outcome {
            Outcome::Unread(issue) => Some((self.file.display.clone(), issue.clone())),
            _ => None,
        }
    }
}

/// What a reader made of a file.
#[derive(Debug)]
pub enum Outcome {
    /// It was read.
    Read(Box<Reading>),
    /// It cannot be read.
    Refused(Issue),
    /// The system could not give it: nothing is known of it, and it is tried again.
    Unread(Issue),
    /// It has nothing to read yet.
    Pending(Issue),
    /// It belongs to a run and holds none.
    Sidecar(Issue),
}

impl Outcome {
    /// How a file that holds nothing to store is recorded, and why; none for one that was read, and for one of which
    /// nothing is known.
    pub fn aside(&self) -> Option<(FileState, &Issue)> {
        match self {
            Outcome::Read(_) | Outcome::Unread(_) => None,
            Outcome::Refused(issue) => Some((FileState::Refused, issue)),
            Outcome::Pending(issue) => Some((FileState::Pending, issue)),
            Outcome::Sidecar(issue) => Some((FileState::Sidecar, issue)),
        }
    }
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

/// An error of the system about a file, which says nothing of the file itself.
pub fn not_read_now(message: &str) -> Issue {
    Issue::error("not-read-now", message)
        .mend("nothing is decided about the file: it is tried again whenever the folder is looked through")
}

/// What files are read with.
#[derive(Debug, Clone, Copy)]
pub struct With<'a> {
    /// The campaign folder.
    pub folder: &'a Path,
    /// Its saved profiles.
    pub profiles: &'a Profiles,
    /// What campaign.toml says.
    pub campaign: &'a Campaign,
    /// What gives their bytes.
    pub read_file: ReadFile,
}

/// Reads every file of a group. Refusals are part of the outcome; a fault of a reader refuses its file only, and so does one
/// that ended the program before.
pub fn prepare(with: With<'_>, being_read: &BeingRead, group: &Group) -> Prepared {
    Prepared {
        run_name: group.run_name.clone(),
        kind: group.kind,
        files: group
            .files
            .iter()
            .map(|file| match being_read.begin(file) {
                Ok(_mark) => prepare_file(with, group.kind, file),
                Err(issue) => PreparedFile::without_bytes(file, Outcome::Refused(issue)),
            })
            .collect(),
    }
}

fn prepare_file(with: With<'_>, kind: RunKind, file: &SeenFile) -> PreparedFile {
    let location = file.location(with.folder);
    if location.is_dir() {
        return frame_folder::prepare(with.folder, file, &location);
    }
    let bytes = match (with.read_file)(&location, LARGEST_FILE_BYTES) {
        Ok(bytes) => bytes,
        Err(error) => {
            // Reports name files relative to the campaign, so that they are the same on every machine.
            let message = error
                .to_string()
                .replace(&format!("{}: ", location.display()), "");
            let outcome = match error {
                ReadFileError::StillGrowing { .. } => Outcome::Pending(Issue::note("still-growing", message)),
                error if error.may_pass() => Outcome::Unread(not_read_now(&message)),
                _ => Outcome::Refused(Issue::error("not-read", message)),
            };
            return PreparedFile::without_bytes(file, outcome);
        }
    };
    prepare_bytes(with, kind, file, bytes)
}

/// Reads bytes as those of a file.
pub fn prepare_bytes(with: With<'_>, kind: RunKind, file: &SeenFile, bytes: Vec<u8>) -> PreparedFile {
    let (outcome, profile) = read(with, kind, file, &bytes);
    PreparedFile {
        file: file.clone(),
        hash: Some(archive::hash(&bytes)),
        bytes,
        archived: None,
        outcome,
        profile,
    }
}

fn read(with: With<'_>, kind: RunKind, file: &SeenFile, bytes: &[u8]) -> (Outcome, Option<Profile>) {
    let context = ReadContext {
        // A modulus log may have its humidity in a file of its own.
        needs_response: kind != RunKind::Dma,
        ..ReadContext::of(with.campaign)
    };
    let name = file.display.rsplit('/').next().unwrap_or(&file.display);
    if kind != RunKind::Dma && run_sheet::is_sheet(name, bytes) {
        let outcome = match run_sheet::read(bytes) {
            Ok(rows) => Outcome::Sidecar(run_sheet::note(bytes, &rows)),
            Err(issue) => Outcome::Refused(issue),
        };
        return (outcome, None);
    }
    let read_as = |date_order| {
        let context = ReadContext {
            date_order,
            ..context.clone()
        };
        profiles::read(with.profiles, name, bytes, &context)
    };
    let read = || match read_as(context.date_order) {
        Err(ReadError::AmbiguousDates { first, .. }) if context.date_order.is_none() => {
            read_as(order_beside(&file.location(with.folder), &first))
        }
        read => read,
    };
    let read = caught(read);
    if may_be_of_profile(&read)
        && let Some(refused) = with.profiles.waiting_for(name, bytes)
    {
        return (Outcome::Unread(refused.issue_of_file()), None);
    }
    let outcome = match read {
        Ok(Ok((reading, profile))) => return (Outcome::Read(Box::new(reading)), profile.cloned()),
        Ok(Err(error)) if error.is_pending() => Outcome::Pending(error.issue()),
        Ok(Err(error)) if error.is_sidecar() => Outcome::Sidecar(error.issue()),
        Ok(Err(error)) => Outcome::Refused(error.issue()),
        Err(reason) => {
            let issue = Issue::fault("reader-fault", "the reader", &reason);
            Outcome::Refused(issue.mend("report it with this file; the other files are not affected"))
        }
    };
    (outcome, None)
}

/// Whether what a reader made of a file may be another thing by a profile: no maker's format and no profile knew the file.
fn may_be_of_profile(read: &Result<Result<(Reading, Option<&Profile>), ReadError>, String>) -> bool {
    match read {
        Ok(Ok((reading, profile))) => {
            let mut formats = crate::ingest::formats::ALL.iter();
            let format = formats.find(|format| format.id() == reading.format);
            profile.is_none() && format.is_none_or(|format| format.is_generic())
        }
        Ok(Err(error)) => !error.is_pending() && !error.is_sidecar(),
        Err(_) => true,
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
    /// Clocks, one for each file, and the flags of the readings.
    pub origin: RunOrigin,
    /// Whether time zero is the voltage step.
    pub time_zero_is_step: bool,
}

impl RunPart {
    /// What the part measures, in a folder of measurements of that kind: a spectrum is told by its columns, wherever it
    /// lies, but for the folder of modulus logs.
    pub fn kind(&self, of_folder: RunKind) -> RunKind {
        match of_folder {
            RunKind::Dma => RunKind::Dma,
            _ if Spectrum::of(&self.channels).is_empty() => RunKind::Actuation,
            _ => RunKind::Impedance,
        }
    }
}

/// The runs that a reading holds: every table with a response or a spectrum (of a modulus log: with a modulus), or all
/// tables where none has one.
pub fn run_parts(reading: &Reading, kind: RunKind) -> Vec<RunPart> {
    let responds = |channel: &Channel| match kind {
        RunKind::Actuation | RunKind::Impedance => channel.is_response(),
        RunKind::Dma => channel.quantity.is_modulus(),
    };
    let is_spectrum = |table: &RunTable| kind != RunKind::Dma && !Spectrum::of(&table.channels).is_empty();
    let has_response = |table: &&RunTable| table.channels.iter().any(responds) || is_spectrum(table);
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
            origin: RunOrigin {
                clocks: vec![clock(reading, table, 0, table.channels.len())],
                flags: table.flags.clone(),
                ..RunOrigin::default()
            },
            time_zero_is_step: table.time_zero_is_step,
        })
        .collect()
}

/// The clock of a table; the file's name comes with the run.
fn clock(reading: &Reading, table: &RunTable, first_channel: usize, channels: usize) -> RunClock {
    let (time_column, time_unit) = table.time_column.clone().unzip();
    RunClock {
        file: String::new(),
        is_reference: true,
        first_channel,
        channels,
        time_column,
        time_unit: time_unit.unwrap_or_default(),
        printed_column: table.printed_time.clone(),
        stamp: reading.started_at.clone(),
    }
}

/// Joins the tables of several files of one run: each gives the quantities that no file before it gave.
pub fn joined(readings: &[&Reading]) -> (RunPart, Vec<Issue>) {
    let mut part = RunPart {
        suffix: String::new(),
        channels: Vec::new(),
        rows: 0,
        origin: RunOrigin::default(),
        time_zero_is_step: true,
    };
    let mut issues = Vec::new();
    let mut zero_is_step = Vec::new();
    for reading in readings {
        let first_channel = part.channels.len();
        let tables = &reading.tables;
        for table in tables {
            add(&mut part, table, &mut issues);
        }
        if let Some(table) = tables.first() {
            let channels = part.channels.len() - first_channel;
            part.origin
                .clocks
                .push(clock(reading, table, first_channel, channels));
            zero_is_step.push(table.time_zero_is_step);
        }
    }
    hold_clocks(&mut part, &zero_is_step);
    (part, issues)
}

fn add(part: &mut RunPart, table: &RunTable, issues: &mut Vec<Issue>) {
    part.rows += table.rows;
    part.time_zero_is_step &= table.time_zero_is_step;
    part.origin.flags.extend(table.flags.iter().cloned());
    for channel in &table.channels {
        let same = |c: &Channel| c.quantity == channel.quantity && c.position_mm == channel.position_mm;
        let given = channel.quantity != Quantity::Other && part.channels.iter().any(same);
        if given {
            let message = format!(
                "{} stands in several files of the run; the first one counts",
                channel.quantity.label()
            );
            issues.push(Issue::warning("joined-twice", message).at(format!("column {}", channel.raw_name)));
        } else {
            part.channels.push(channel.clone());
        }
    }
}

/// Holds the clocks of a joined run against each other.
fn hold_clocks(part: &mut RunPart, zero_is_step: &[bool]) {
    let files: Vec<FileClock<'_>> = part
        .origin
        .clocks
        .iter()
        .zip(zero_is_step)
        .map(|(clock, &time_zero_is_step)| FileClock {
            channels: &part.channels[clock.first_channel..clock.first_channel + clock.channels],
            stamp: clock.stamp.as_ref(),
            time_zero_is_step,
        })
        .collect();
    let reference = clocks::reference(&files);
    let offsets = clocks::offsets(&files);
    part.origin.offsets = offsets;
    for (index, clock) in part.origin.clocks.iter_mut().enumerate() {
        clock.is_reference = index == reference;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ingest::formats;

    fn read(name: &str, text: &str) -> Reading {
        formats::read(name, text.as_bytes(), &ReadContext::default()).unwrap()
    }

    /// Quantity, first value and last value of each channel.
    fn values(part: &RunPart) -> Vec<(Quantity, f64, f64)> {
        let ends = |channel: &Channel| (channel.quantity, channel.values[0], channel.values[2]);
        part.channels.iter().map(ends).collect()
    }

    #[test]
    fn of_what_two_files_of_a_run_give_the_first_counts_and_it_is_said() {
        let electrical = read("a.csv", "time_s,voltage_v,current_a\n0,2,0.1\n1,2,0.2\n2,2,0.3\n");
        let camera = read(
            "b.csv",
            "time_s,current_a,curvature_per_cm\n0,7,0.4\n1,8,0.5\n2,9,0.6\n",
        );
        let (voltage, curvature) = ((Quantity::Voltage, 2.0, 2.0), (Quantity::Curvature, 0.4, 0.6));
        for (files, expected, clocks) in [
            (
                [&electrical, &camera],
                [voltage, (Quantity::Current, 0.1, 0.3), curvature],
                [(0, 2), (2, 1)],
            ),
            (
                [&camera, &electrical],
                [(Quantity::Current, 7.0, 9.0), curvature, voltage],
                [(0, 2), (2, 1)],
            ),
        ] {
            let (part, issues) = joined(&files);
            assert_eq!(values(&part), expected);
            let timed = part
                .origin
                .clocks
                .iter()
                .map(|clock| (clock.first_channel, clock.channels));
            assert_eq!(timed.collect::<Vec<_>>(), clocks);
            let said: Vec<&str> = issues.iter().map(|issue| issue.code.as_str()).collect();
            assert_eq!(
                (said, issues[0].place.as_str()),
                (vec!["joined-twice"], "column current_a")
            );
        }
    }
}
