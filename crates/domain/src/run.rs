//! A run as it is stored: files, tags, channels, issues and its current fit.

use crate::string_enum;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::tag::keys;
use super::{
    ChannelSummary, ClimateQuantity, Drive, Fit, Issue, MadeBy, Quantity, RunClimate, RunOrigin, Standing,
    Tag,
};

string_enum! {
    /// What is measured: a modulus log is told by the folder that the file lies in, the others by their columns.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum RunKind {
        /// A drive and the responses of an actuator to it.
        Actuation = "actuation",
        /// A modulus log: dynamic mechanical analysis of a sample.
        Dma = "dma",
        /// An impedance spectrum of a sample.
        Impedance = "impedance",
    }
}

impl RunKind {
    /// Tags without which nothing can be made of such a measurement.
    pub fn needed_tags(self) -> &'static [&'static str] {
        match self {
            RunKind::Actuation => &[keys::SAMPLE, keys::ENVIRONMENT, keys::VOLTAGE_V],
            RunKind::Dma | RunKind::Impedance => &[keys::SAMPLE],
        }
    }
}

string_enum! {
    /// Whether a run can be fitted.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum RunState {
        /// Tagged and readable: fitted, or waiting for its fit.
        Ready = "ready",
        /// A needed tag is missing; the issues say which.
        Untagged = "untagged",
        /// Tagged, but the technique or the channels are not those of a step response.
        NotFitted = "not_fitted",
        /// The voltage does not go in steps, as in a sweep: it is kept, waits for nothing and is not fitted.
        NoSteps = "no_steps",
    }
}

impl RunState {
    /// Why a run has no fit, in words.
    pub fn why_unfitted(self) -> &'static str {
        match self {
            RunState::Ready => "the run is not fitted yet",
            RunState::Untagged => "a needed tag is missing",
            RunState::NotFitted => "the run is not a step response that the model describes",
            RunState::NoSteps => "the voltage does not go in steps",
        }
    }
}

string_enum! {
    /// How the measurement ended, as far as the file shows.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum RunStatus {
        /// The file is whole.
        Complete = "complete",
        /// The instrument says that the run was aborted.
        Aborted = "aborted",
        /// The run ended before its plan, in order.
        StoppedEarly = "stopped_early",
        /// The file ends in the middle of a line or a table.
        Cut = "cut",
        /// The instrument had not finished when the file was read.
        StillRunning = "still_running",
        /// The format says nothing of it.
        Unknown = "unknown",
    }
}

/// A raw file that belongs to a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct RunFile {
    /// Path relative to the campaign, with `/`.
    pub path: String,
    /// BLAKE3 of the bytes, hexadecimal.
    pub hash: String,
    /// Size, bytes.
    pub size_bytes: u64,
    /// Other paths at which the same bytes lie.
    pub aliases: Vec<String>,
}

/// A run with everything but its readings.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRecord {
    /// Row id in the database.
    pub id: i64,
    /// What is measured.
    pub kind: RunKind,
    /// Path relative to the campaign, with `/`: the run's name for people and scripts.
    pub path: String,
    /// 1 for the first content under this name, 2 for the next, ...
    pub revision: u32,
    /// Whether it can be fitted.
    pub state: RunState,
    /// How the measurement ended.
    pub status: RunStatus,
    /// The evidence for `status`.
    pub status_evidence: String,
    /// Format id of the reader, `gamry-dta`.
    pub format: String,
    /// Version of that reader.
    pub reader_version: u32,
    /// Technique as the file names it.
    pub technique: Option<String>,
    /// Raw files, one or several joined.
    pub files: Vec<RunFile>,
    /// Every tag from every source, the chosen one of each key first.
    pub tags: Vec<Tag>,
    /// Channels without readings.
    pub channels: Vec<ChannelSummary>,
    /// Clocks, flags and profiles that the readings rest on.
    pub origin: RunOrigin,
    /// The drive, where it is known.
    pub drive: Option<Drive>,
    /// Sample's active area used, cm2.
    pub area_cm2: Option<f64>,
    /// Hash of readings, drive and area: what a fit depends on.
    pub data_hash: String,
    /// When it was taken in, RFC 3339 UTC.
    pub ingested_at: String,
    /// What a reader must know.
    pub issues: Vec<Issue>,
    /// Climate during the run: the chosen sensor's quantities first.
    pub climate: Vec<RunClimate>,
    /// The current fit.
    pub fit: Option<Fit>,
    /// The program that made the fit.
    pub fit_made_by: Option<MadeBy>,
    /// Whether it takes part in results.
    pub standing: Standing,
}

impl RunRecord {
    /// The chosen value of a tag.
    pub fn tag(&self, key: &str) -> Option<&str> {
        self.tags
            .iter()
            .find(|tag| tag.key == key)
            .map(|tag| tag.value.as_str())
    }

    /// Whether the log of a sensor says what climate it had.
    pub fn is_covered_by_log(&self) -> bool {
        let follows = |quantity| !ClimateQuantity::MEASURED.contains(&quantity);
        self.climate
            .iter()
            .any(|found| found.own_name().is_none() && !follows(found.quantity))
    }

    /// Whether what people or the file's head state of the climate is not what was measured while the run went on.
    pub fn climate_label_differs(&self) -> bool {
        ClimateQuantity::MEASURED.into_iter().any(|quantity| {
            let tags = || self.tags.iter().filter(|tag| tag.key == quantity.key());
            let number = |tag: &Tag| tag.value.parse::<f64>().ok();
            let stated = tags().find(|tag| tag.source.is_stated()).and_then(number);
            let mut means = (tags().filter(|tag| tag.source.is_measured_climate())).filter_map(number);
            stated.is_some_and(|stated| means.any(|mean| !quantity.agree(stated, mean)))
        })
    }

    /// Number of places along the strip at which `quantity` was measured.
    pub fn places(&self, quantity: Quantity) -> usize {
        let placed =
            |channel: &&ChannelSummary| channel.quantity == quantity && channel.position_mm.is_some();
        self.channels.iter().filter(placed).count()
    }

    /// Whether curvature or voltage was measured at several places along the strip.
    pub fn is_along(&self) -> bool {
        self.places(Quantity::Curvature) > 1 || self.places(Quantity::Voltage) > 1
    }

    /// The chosen value of a tag as a number.
    pub fn tag_number(&self, key: &str) -> Option<f64> {
        self.tag(key)?
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite())
    }
}

string_enum! {
    /// What became of a file in the campaign folder.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum FileState {
        /// Holds a run, or a part of one.
        Run = "run",
        /// The same bytes as a run's file.
        Alias = "alias",
        /// Could not be read; its reason is stored.
        Refused = "refused",
        /// Empty, header only or still growing: looked at again when it changes.
        Pending = "pending",
        /// Belongs to a run and holds none: a sidecar of the instrument.
        Sidecar = "sidecar",
        /// Holds readings of climate sensors.
        Log = "log",
    }
}

/// A file in the campaign folder as the last scan saw it.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceFile {
    /// Path relative to the campaign, with `/`; bytes that are no UTF-8 shown as U+FFFD.
    pub path: String,
    /// Size, bytes.
    pub size_bytes: u64,
    /// Modification time, ns since 1970.
    pub modified_ns: i64,
    /// What became of it.
    pub state: FileState,
    /// Why it was refused or waits, and how to mend it.
    pub issue: Option<Issue>,
    /// Whether the file has gone since.
    pub missing: bool,
}

impl SourceFile {
    /// A file that the system could not give; of its state nothing is known.
    pub fn not_read(path: &str, issue: Issue) -> SourceFile {
        SourceFile {
            path: path.to_owned(),
            size_bytes: 0,
            modified_ns: 0,
            state: FileState::Refused,
            issue: Some(issue),
            missing: false,
        }
    }
}
