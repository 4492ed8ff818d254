//! What a profile says, checked.

use encoding_rs::Encoding;
use jiff::tz::TimeZone;

use super::glob::Glob;
use crate::Timestamp;
use crate::formats::stamp::DateOrder;
use crate::table::Answers;
use crate::text::grid::Dialect;
use ieap_domain::Quantity;
use ieap_domain::unit::Conversion;

/// How the files of one source are read.
#[derive(Debug, Clone)]
pub struct Profile {
    /// Its id: the name of its file without `.toml`.
    pub id: String,
    /// Its version, for people; the digest decides.
    pub version: u32,
    /// What it reads, in words.
    pub title: String,
    /// BLAKE3 of its text, hexadecimal.
    pub digest: String,
    /// Its text.
    pub text: String,
    /// Technique of the files, as the profile names it.
    pub technique: Option<String>,
    /// Whether the files hold responses to a piecewise-constant voltage.
    pub step_response: bool,
    /// Name that the files have.
    pub(super) name: Option<Glob>,
    /// Texts that all stand in the first part of the file.
    pub(super) contains: Vec<String>,
    /// Whether it goes before a vendor's format that recognises the file for certain.
    pub over_vendor: bool,
    pub(super) container: Container,
    pub(super) header: HeaderPlace,
    /// Lines between the names and the first row of readings.
    pub(super) lines_after_header: usize,
    pub(super) time: TimeBase,
    /// Whether time zero is the voltage step.
    pub(super) time_zero_is_step: bool,
    pub(super) start: Option<StartLine>,
    pub(super) columns: Vec<Column>,
}

/// What holds the table.
#[derive(Debug, Clone)]
pub(super) enum Container {
    /// A delimited text.
    Text {
        /// Encoding; none where it is found.
        encoding: Option<&'static Encoding>,
        dialect: Dialect,
        /// What comment lines begin with; empty where there are none.
        comment: String,
    },
    /// Whatever the reader of tables takes, which asks what it leaves open: these are the answers.
    Answers(Answers),
    /// A sheet of a workbook.
    Sheet {
        /// Its name; none takes the first that fits.
        name: Option<String>,
    },
}

/// Where the names of the columns stand.
#[derive(Debug, Clone)]
pub(super) enum HeaderPlace {
    /// On that line (or row of a sheet), from 1.
    Line(usize),
    /// On the first line that holds the text.
    Contains(String),
    /// Nowhere: columns go by number.
    None,
}

/// A column by its name or its number.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ColumnRef {
    /// The text of the header's cell.
    Name(String),
    /// From 0.
    Index(usize),
}

/// What times the rows.
#[derive(Debug, Clone)]
pub(super) enum TimeBase {
    /// Numbers since any moment.
    Elapsed {
        column: ColumnRef,
        unit: String,
        conversion: Conversion,
    },
    /// Numbers since 1970 in UTC.
    Epoch {
        column: ColumnRef,
        unit: String,
        conversion: Conversion,
    },
    /// Dates with times of day, in one column or two.
    Clock {
        column: ColumnRef,
        date_column: Option<ColumnRef>,
        order: DateOrder,
        zone: Option<TimeZone>,
    },
    /// Times of day without a date; midnight may pass.
    TimeOfDay { column: ColumnRef },
    /// Nothing: rows follow each other after this many seconds.
    Interval { interval_s: f64 },
}

/// The line before the table that states a date.
#[derive(Debug, Clone)]
pub(super) struct StartLine {
    pub begins: String,
    pub order: DateOrder,
    pub kind: Timestamp,
}

/// A column with a meaning.
#[derive(Debug, Clone)]
pub(super) struct Column {
    pub column: ColumnRef,
    pub quantity: Quantity,
    pub unit: String,
    pub conversion: Conversion,
    /// What readings are multiplied by before their unit converts, such as the sensitivity of a sensor.
    pub factor: Option<f64>,
    pub position_mm: Option<f64>,
}

impl ColumnRef {
    /// As messages show it.
    pub fn shown(&self) -> String {
        match self {
            ColumnRef::Name(name) => format!("column {}", crate::formats::error::quoted(name)),
            ColumnRef::Index(index) => format!("column {}", index + 1),
        }
    }
}

impl TimeBase {
    /// The columns that time is read from.
    pub fn columns(&self) -> Vec<&ColumnRef> {
        match self {
            TimeBase::Elapsed { column, .. }
            | TimeBase::Epoch { column, .. }
            | TimeBase::TimeOfDay { column } => vec![column],
            TimeBase::Clock {
                column, date_column, ..
            } => std::iter::once(column).chain(date_column).collect(),
            TimeBase::Interval { .. } => Vec::new(),
        }
    }

    /// Whether its cells are texts.
    pub fn is_text(&self) -> bool {
        matches!(self, TimeBase::Clock { .. } | TimeBase::TimeOfDay { .. })
    }
}

impl Profile {
    /// Version of the reader that obeys profiles: raised when the same bytes would read differently.
    pub const READER_VERSION: u32 = 2;

    /// How runs and files name it as their format: `profile:laser@1a2b3c4d5e6f`, the last part from the digest.
    pub fn format(&self) -> String {
        format!("profile:{}@{}", self.id, &self.digest[..12])
    }

    /// Every column that it names, the time's first.
    pub(super) fn named_columns(&self) -> impl Iterator<Item = &ColumnRef> {
        let columns = self.columns.iter().map(|column| &column.column);
        self.time.columns().into_iter().chain(columns)
    }
}
