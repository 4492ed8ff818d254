//! Files and arrays as tables of readings.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::domain::fault::caught;
use crate::domain::{Channel, FlaggedStretch, Issue, RunKind, StartedAt};
use crate::ingest::Reading;
use crate::ingest::arrays as in_memory;
pub use crate::ingest::arrays::Column;
use crate::ingest::campaign_file;
use crate::ingest::formats::ReadContext;
use crate::ingest::profiles::{self, Profiles};
use crate::ingest::text::header::Header;
use crate::pipeline::intake::ingest::run_parts;
use crate::pipeline::{PipelineError, failed};
use crate::system::fs;

/// A table of readings with what its reader saw.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReadTable {
    /// `#TABLE` where the file holds several, else empty.
    pub name: String,
    /// Readings in canonical units; documents have no place for them.
    #[serde(skip)]
    pub channels: Vec<Channel>,
    /// Rows of the table.
    pub rows: usize,
    /// Format id, `gamry-dta`; `arrays` where the readings came from no file.
    pub format: String,
    /// Version of the reader.
    pub reader_version: u32,
    /// Technique as the file names it.
    pub technique: Option<String>,
    /// Whether that technique is a response to a piecewise-constant voltage.
    pub is_step_response: bool,
    /// Whether time zero is the voltage step.
    pub time_zero_is_step: bool,
    /// How the measurement ended: `complete`, `truncated`, ...
    pub status: String,
    /// Date and time stated in the file.
    pub started_at: Option<StartedAt>,
    /// Tags that the header gives: key, value, the header's own name.
    pub header_tags: Vec<(String, String, String)>,
    /// Stretches that the instrument marks.
    pub flags: Vec<FlaggedStretch>,
    /// The vendor's metadata as text.
    pub original_metadata: Vec<(String, String)>,
    /// What a reader must know.
    pub issues: Vec<Issue>,
}

/// Reads every table of a file that can be a run, or all where none can; saved profiles and the order of dates of the
/// campaign that the file lies in are obeyed.
///
/// # Errors
/// The system cannot give the file, a profile is wrong, or no reader can read it: then the issue says where and why.
pub fn read(file: &Path) -> Result<Result<Vec<ReadTable>, Issue>, PipelineError> {
    let bytes = fs::read(file).map_err(failed(file, "reading the file"))?;
    let absolute = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    let campaign = absolute.parent().and_then(campaign_file::find);
    let (profiles, context) = match &campaign {
        Some(folder) => {
            let read = campaign_file::read(folder)?;
            let profiles = profiles::load(folder).strict()?;
            (profiles, ReadContext::of(&read.campaign))
        }
        None => (Profiles::default(), ReadContext::default()),
    };
    // A log without a response is a table, too: what is missing for a fit is said when one is asked for.
    let context = ReadContext {
        needs_response: false,
        ..context
    };
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let reading = caught(|| profiles::read(&profiles, &name, &bytes, &context));
    Ok(match reading {
        Ok(Ok((reading, _))) => Ok(tables(&reading)),
        Ok(Err(error)) => Err(error.issue()),
        Err(reason) => {
            let issue = Issue::fault("reader-fault", "the reader", &reason);
            Err(issue.mend("report it with this file"))
        }
    })
}

/// Columns in memory as a table, under the names that a plain run table may have; NaN is an empty cell.
///
/// # Errors
/// What is no table says why.
pub fn arrays(columns: Vec<Column>) -> Result<ReadTable, Issue> {
    let reading = in_memory::read(columns)?;
    let no_table = || Issue::error("no-header", "there is no table");
    tables(&reading).pop().ok_or_else(no_table)
}

/// The unit that a column's name says; empty where it says none.
pub fn unit_of(name: &str) -> String {
    Header::parse(name).raw_unit
}

fn tables(reading: &Reading) -> Vec<ReadTable> {
    let parts = run_parts(reading, RunKind::Actuation).into_iter();
    let table = |part: crate::pipeline::intake::ingest::RunPart| ReadTable {
        name: part.suffix,
        channels: part.channels,
        rows: part.rows,
        format: reading.format.to_owned(),
        reader_version: reading.reader_version,
        technique: reading.technique.clone(),
        is_step_response: reading.is_step_response,
        time_zero_is_step: part.time_zero_is_step,
        status: reading.status.key().to_owned(),
        started_at: reading.started_at.clone(),
        header_tags: reading.header_tags.clone(),
        flags: part.origin.flags,
        original_metadata: reading.original_metadata.clone(),
        issues: reading.issues.clone(),
    };
    parts.map(table).collect()
}
