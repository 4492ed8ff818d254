//! What a reader makes of a file.

use serde::Serialize;

use ieap_domain::{Channel, FlaggedStretch, Issue, Quantity, RunStatus};

pub use ieap_domain::{StartedAt, Timestamp};

/// One table of a file that can be a run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunTable {
    /// Name of the table in the file (`CURVE`, a sheet's name); empty where the file has one table only.
    pub name: String,
    /// Rows read.
    pub rows: usize,
    /// Columns in the file's order, those of `Quantity::Other` included; the time column is not among them.
    pub channels: Vec<Channel>,
    /// Name and unit of the time column as the file has them; none where there is none.
    pub time_column: Option<(String, String)>,
    /// Column with the printed time, kept beside a time that was rebuilt; none where the time is as printed.
    pub printed_time: Option<String>,
    /// Stretches of readings that the instrument itself marks.
    pub flags: Vec<FlaggedStretch>,
    /// Numbers of the time column: first and last, s.
    pub time_first_last_s: Option<(f64, f64)>,
    /// Whether time zero of the file is known to be the voltage step (the plain run table's contract), or
    /// the clock starts anywhere (an instrument's clock).
    pub time_zero_is_step: bool,
    /// Where a logger's clock was set back, as at the end of summer time: time of the first reading after it, s,
    /// and by how much, s. Times of readings go on as if it had not been; the clock showed as much less.
    pub clock_set_back: Vec<(f64, f64)>,
}

/// Everything read from one file. Readers return data *and* issues; they fail only where no table can be had.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Format id, `gamry-dta`.
    pub format: &'static str,
    /// Version of the reader; a change makes earlier readings out of date.
    pub reader_version: u32,
    /// Technique as the file names it, such as `CHRONOA`.
    pub technique: Option<String>,
    /// Whether that technique is a response to a piecewise-constant voltage, as far as the reader can say.
    pub is_step_response: bool,
    /// Text encoding found: `utf-8`, `utf-16le`, `utf-16be`, `windows-1252`; none for binary files.
    pub encoding: Option<&'static str>,
    /// How the measurement ended.
    pub status: RunStatus,
    /// The evidence for `status`.
    pub status_evidence: String,
    /// Date and time stated in the file.
    pub started_at: Option<StartedAt>,
    /// Tags that the header gives: tag key, value, and the header's own name of it.
    pub header_tags: Vec<(String, String, String)>,
    /// Tables; more than one where a file holds several curves.
    pub tables: Vec<RunTable>,
    /// The vendor's metadata as text, in the file's order.
    pub original_metadata: Vec<(String, String)>,
    /// What a reader must know.
    pub issues: Vec<Issue>,
}

impl Reading {
    /// What a reader of that id and version has made of a file before it read anything.
    pub fn of(format: &'static str, reader_version: u32) -> Reading {
        Reading {
            format,
            reader_version,
            technique: None,
            is_step_response: false,
            encoding: None,
            status: RunStatus::Complete,
            status_evidence: String::new(),
            started_at: None,
            header_tags: Vec::new(),
            tables: Vec::new(),
            original_metadata: Vec::new(),
            issues: Vec::new(),
        }
    }
}

/// A column of a table without its readings, as `ieap inspect` shows it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnSummary {
    /// The column's name as the file has it.
    pub name: String,
    /// What it measures.
    pub quantity: Quantity,
    /// The unit as the file has it; empty where there is none.
    pub unit: String,
    /// Name of the canonical column, `current_a`; empty for columns that are not interpreted.
    pub canonical: &'static str,
    /// Number of readings, the excluded ones counted.
    pub readings: usize,
    /// How many of them are left out of fits.
    pub excluded: usize,
    /// First reading, canonical unit.
    pub first: Option<f64>,
    /// Last reading, canonical unit.
    pub last: Option<f64>,
}

impl RunTable {
    /// The time column, where there is one, and the channels in the file's order.
    pub fn columns(&self) -> Vec<ColumnSummary> {
        let time = self.time_column.iter().map(|(name, unit)| ColumnSummary {
            name: name.clone(),
            quantity: Quantity::Time,
            unit: unit.clone(),
            canonical: Quantity::Time.column(),
            readings: self.channels.iter().map(Channel::len).max().unwrap_or(0),
            excluded: 0,
            first: self.time_first_last_s.map(|(first, _)| first),
            last: self.time_first_last_s.map(|(_, last)| last),
        });
        let channels = self.channels.iter().map(|channel| ColumnSummary {
            name: channel.raw_name.clone(),
            quantity: channel.quantity,
            unit: channel.raw_unit.clone(),
            canonical: channel.quantity.column(),
            readings: channel.len(),
            excluded: channel.excluded.len(),
            first: channel.values.first().copied(),
            last: channel.values.last().copied(),
        });
        time.chain(channels).collect()
    }
}
