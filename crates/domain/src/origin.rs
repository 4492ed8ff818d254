//! What the readings of a run rest on beside their files: profiles, clocks with their offsets, flags of instruments.

use crate::string_enum;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

string_enum! {
    /// Which moment a time stamp of a file means.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Timestamp {
        /// Start of the measurement.
        Start = "start",
        /// End of the measurement.
        End = "end",
        /// Moment of the export.
        Export = "export",
    }
}

/// A date and time as a file states it, with the reading of it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct StartedAt {
    /// The text of the file, unchanged.
    pub raw: String,
    /// Which moment it means.
    pub kind: Timestamp,
    /// Local date and time, `2024-07-17T10:52:53`, or a day, `2024-07-17`; none where the order of day and month is not certain.
    pub local: Option<String>,
    /// Offset where the file states one, `+03:00`.
    pub offset: Option<String>,
    /// How the order of day and month was decided, in words.
    pub basis: String,
}

impl StartedAt {
    /// The local date and time; none where no more than the day is stated.
    pub fn moment(&self) -> Option<&str> {
        self.local.as_deref().filter(|local| local.contains('T'))
    }
}

/// The clock of one file of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunClock {
    /// Path of the file, relative to the campaign.
    pub file: String,
    /// Whether the other clocks are held against it.
    pub is_reference: bool,
    /// Ordinal of the first channel that it times.
    pub first_channel: usize,
    /// How many channels it times.
    pub channels: usize,
    /// Name of the time column as the file has it, or how the time was rebuilt; none where rows are numbered.
    pub time_column: Option<String>,
    /// Unit of that column as the file has it.
    pub time_unit: String,
    /// Column with the printed time, kept beside a rebuilt one; none where the time is as printed.
    pub printed_column: Option<String>,
    /// The date and time that the file states.
    pub stamp: Option<StartedAt>,
}

string_enum! {
    /// Where the offset of a clock comes from.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum OffsetSource {
        /// The tag `clock_offset_s`.
        Stated = "stated" => "stated by tag",
        /// The start moments of both files.
        Header = "header" => "start moments of the files",
        /// The onset of bending held against the edge of the voltage.
        Estimated = "estimated" => "onset of bending",
    }
}

/// What has to be added to the times of one clock to have those of the run's reference clock.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClockOffset {
    /// Which of the run's clocks.
    pub clock: usize,
    /// Where it comes from.
    pub source: OffsetSource,
    /// The offset, s; none where the source cannot give it, and `detail` says why.
    pub offset_s: Option<f64>,
    /// Its standard error, s; none where it is not known.
    pub standard_error_s: Option<f64>,
    /// Whether the times of that clock's channels are used with it.
    pub applied: bool,
    /// What it rests on, or why there is none.
    pub detail: String,
}

/// A stretch of readings that the instrument itself marks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FlaggedStretch {
    /// Name of the column of flags.
    pub column: String,
    /// The flag as the file has it.
    pub flag: String,
    /// Time of the first reading, s.
    pub from_s: f64,
    /// Time of the last reading, s.
    pub to_s: f64,
    /// Number of readings.
    pub readings: usize,
    /// Whether the current of these readings is left out of fits.
    pub excludes: bool,
}

/// The profile that a file was read with.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ProfileUse {
    /// Ordinal of the file among those of the run.
    pub file: usize,
    /// Id of the profile.
    pub id: String,
    /// Its version.
    pub version: u32,
    /// BLAKE3 of its text, hexadecimal.
    pub digest: String,
    /// Its text.
    #[serde(skip)]
    pub text: String,
}

/// What the readings of a run rest on beside their files.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunOrigin {
    /// Clocks in the order of the run's files.
    pub clocks: Vec<RunClock>,
    /// Offsets of clocks against the reference clock.
    pub offsets: Vec<ClockOffset>,
    /// Stretches that the instruments marked, in order of time.
    pub flags: Vec<FlaggedStretch>,
    /// Profiles that files were read with.
    pub profiles: Vec<ProfileUse>,
}
