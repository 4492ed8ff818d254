//! What a reader makes of a file, without storing it.

use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::{FlaggedStretch, Issue, Quantity};
use crate::ingest::campaign_file;
use crate::ingest::formats::{ReadContext, ReadError, unpacking};
use crate::ingest::profiles::{self, Choice, Claim, Profile, Profiles, Reader};
use crate::ingest::run_sheet;
use crate::ingest::{Reading, RunTable, StartedAt};
use crate::pipeline::campaign::standing::{self, SetAside};
use crate::pipeline::documents::lengthwise::LumpedOrDistributedEntry;
use crate::pipeline::{Context, PipelineError, failed};
use crate::strip;
use crate::system::fs;

const SCHEMA: &str = "ieap/inspect/1";

/// A file as a reader sees it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct Inspection {
    /// Always `ieap/inspect/1`.
    pub schema: &'static str,
    /// The file.
    pub file: String,
    /// Format id; none where the file was refused.
    pub format: Option<String>,
    /// Version of the reader.
    pub reader_version: Option<u32>,
    /// Saved profile that the file was read with; null where none was.
    pub profile: Option<InspectedProfile>,
    /// Every format that may have written it, best first.
    pub candidates: Vec<Claim>,
    /// Technique as the file names it.
    pub technique: Option<String>,
    /// How the measurement ended; `refused`, `pending`, `sidecar`, `folder` or `frame` where it was not read.
    pub status: String,
    /// The evidence for it.
    pub status_evidence: String,
    /// Text encoding.
    pub encoding: Option<String>,
    /// Date and time stated in the file.
    pub started_at: Option<StartedAt>,
    /// Tags that the header gives.
    pub header_tags: Vec<(String, String, String)>,
    /// Tables.
    pub runs: Vec<InspectedTable>,
    /// What a reader must know.
    pub issues: Vec<Issue>,
    /// The run that the campaign around the file has stored of it; null where there is none.
    pub stored: Option<StoredRun>,
}

/// What a campaign knows of a file that was taken in.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct StoredRun {
    /// Path of the run relative to the campaign.
    pub run: String,
    /// Why no result is made from it; null where they are.
    pub set_aside: Option<SetAside>,
    /// Model of its current fit; null where it has none.
    pub model: Option<String>,
    /// Whether the run needs the distributed model; null where its fit does not say.
    pub lumped_or_distributed: Option<LumpedOrDistributedEntry>,
}

/// A saved profile.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct InspectedProfile {
    /// Its id.
    pub id: String,
    /// Its version.
    pub version: u32,
    /// BLAKE3 of its text, hexadecimal.
    pub digest: String,
}

/// One table.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct InspectedTable {
    /// Name of the table in the file.
    pub name: String,
    /// Rows read.
    pub rows: usize,
    /// Columns, time first.
    pub columns: Vec<InspectedColumn>,
    /// Column with the printed time, kept beside a time that was rebuilt from the sample interval.
    pub printed_time: Option<String>,
    /// Stretches of readings that the instrument itself marks.
    pub flags: Vec<FlaggedStretch>,
}

/// One column; values in the canonical unit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct InspectedColumn {
    /// Name as the file has it.
    pub name: String,
    /// What it measures; null where it is kept under its own name only.
    pub quantity: Option<&'static str>,
    /// Unit as the file has it.
    pub unit: String,
    /// Canonical column name.
    pub canonical: Option<&'static str>,
    /// Where along the strip, mm from the clamp; null for the strip as a whole.
    pub position_mm: Option<f64>,
    /// Readings; empty cells are not counted.
    pub readings: usize,
    /// Readings left out of fits.
    pub excluded: usize,
    /// First reading.
    pub first: Option<f64>,
    /// Last reading.
    pub last: Option<f64>,
    /// Smallest reading.
    pub smallest: Option<f64>,
    /// Largest reading.
    pub largest: Option<f64>,
}

/// Reads `file` and says what was seen; a refusal is an answer, too. The profiles of the campaign that the file lies
/// in are obeyed.
///
/// # Errors
/// The file cannot be opened.
pub fn inspect(file: &Path) -> Result<Inspection, PipelineError> {
    if file.is_dir() {
        return Ok(folder(file));
    }
    let bytes = fs::read(file).map_err(failed(file, "reading the file"))?;
    let absolute = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    let campaign = absolute.parent().and_then(campaign_file::find);
    let profiles = match &campaign {
        Some(campaign) => profiles::load(campaign),
        None => Profiles::default(),
    };
    // One that cannot be read says so where it is asked; here a file is shown.
    let stated = campaign.as_deref().map(campaign_file::or_kept);
    let context = stated.map_or_else(ReadContext::default, |read| ReadContext::of(&read.campaign));
    let mut inspection = inspect_bytes(file, &bytes, &profiles, &context);
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let waiting_for = profiles.waiting_for(&name, &bytes);
    inspection
        .issues
        .extend(waiting_for.map(|profile| profile.issue_of_file()));
    inspection.stored = campaign.and_then(|campaign| stored(&campaign, &absolute));
    Ok(inspection)
}

/// A folder: what is known of the run that its frames are, where they were taken in.
fn folder(folder: &Path) -> Inspection {
    let absolute = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    let issue = Issue::note("folder", "a folder; frames in it are a run once they are traced").mend(format!(
        "`ieap trace {}` shows what is seen in frames, `ieap inspect` of a file what is read from it",
        folder.display()
    ));
    let mut inspection = not_read(folder.display().to_string(), &[], "folder", issue);
    inspection.stored = campaign_file::find(&absolute).and_then(|campaign| stored(&campaign, &absolute));
    inspection
}

/// The run that a file belongs to. A campaign that cannot be opened stores nothing that could be shown: what is wrong
/// with it is said by the verbs that need it.
fn stored(campaign: &Path, file: &Path) -> Option<StoredRun> {
    let file = fs::canonicalize(file).ok()?;
    let path = file.strip_prefix(campaign).ok()?;
    let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
    let path = parts.join("/");
    let runs = standing::all(&Context::open_read_only(campaign).ok()?).ok()?;
    let run = runs
        .iter()
        .find(|run| run.files.iter().any(|file| file.path == path))?;
    Some(StoredRun {
        run: run.path.clone(),
        set_aside: (!run.standing.speaks()).then(|| SetAside::of(run)),
        model: run.fit.as_ref().map(|fit| fit.model.clone()),
        lumped_or_distributed: LumpedOrDistributedEntry::of(run),
    })
}

/// As [`inspect`], for bytes that were read already.
pub fn inspect_bytes(file: &Path, bytes: &[u8], profiles: &[Profile], context: &ReadContext) -> Inspection {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let shown = file.display().to_string();
    if run_sheet::is_sheet(&name, bytes) {
        return sheet(shown, bytes);
    }
    if let Some(format) = strip::format(bytes) {
        return picture(file, format, bytes);
    }
    let context = &context.within(bytes.len());
    let plain = unpacking::of_gzip(&name, bytes, context.max_unpacked_bytes);
    let chosen = plain.and_then(|(name, bytes)| Ok((profiles::choose(profiles, name, &bytes)?, bytes)));
    let (choice, bytes) = match chosen {
        Ok(chosen) => chosen,
        Err(error) => return refused(shown, &[], &error),
    };
    let read = match choice.reader {
        Reader::Format(format) => format.read(&bytes, context),
        Reader::Profile(profile) => profile.read(&bytes, context),
    };
    match read {
        Ok(reading) => of_reading(shown, &choice, &reading),
        Err(error) => refused(shown, &choice.claims, &error),
    }
}

/// A run sheet: what it plans is tags, not readings.
fn sheet(file: String, bytes: &[u8]) -> Inspection {
    let (status, issue) = match run_sheet::read(bytes) {
        Ok(rows) => ("sidecar", run_sheet::note(bytes, &rows)),
        Err(issue) => ("refused", issue),
    };
    not_read(file, &[], status, issue)
}

/// A picture: a frame of a strip, perhaps. Its folder is what is traced and taken in.
fn picture(file: &Path, format: &str, bytes: &[u8]) -> Inspection {
    let (status, issue) = match strip::decode(bytes) {
        Ok(gray) => (
            "frame",
            Issue::note(
                "frame",
                format!(
                    "a {format} of {} x {} pixels, which may be a frame of the strip seen from its side",
                    gray.width(),
                    gray.height()
                ),
            ),
        ),
        Err(error) => ("refused", Issue::error("frame", error.to_string())),
    };
    let folder = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    let issue = issue.mend(format!(
        "`ieap trace {} --px-per-mm ... --frames-per-second ...` shows what is seen in the frames of its folder; docs/frames.md",
        folder.display()
    ));
    not_read(file.display().to_string(), &[], status, issue)
}

fn refused(file: String, claims: &[Claim], error: &ReadError) -> Inspection {
    let issue = error.issue();
    let status = match error {
        error if error.is_pending() => "pending",
        error if error.is_sidecar() => "sidecar",
        _ => "refused",
    };
    not_read(file, claims, status, issue)
}

fn not_read(file: String, claims: &[Claim], status: &str, issue: Issue) -> Inspection {
    Inspection {
        schema: SCHEMA,
        file,
        candidates: claims.to_vec(),
        status: status.to_owned(),
        status_evidence: issue.message.clone(),
        issues: vec![issue],
        ..Inspection::default()
    }
}

fn of_reading(file: String, choice: &Choice<'_>, reading: &Reading) -> Inspection {
    Inspection {
        schema: SCHEMA,
        file,
        format: Some(reading.format.to_owned()),
        reader_version: Some(reading.reader_version),
        profile: match choice.reader {
            Reader::Profile(profile) => Some(InspectedProfile {
                id: profile.id.clone(),
                version: profile.version,
                digest: profile.digest.clone(),
            }),
            Reader::Format(_) => None,
        },
        candidates: choice.claims.clone(),
        technique: reading.technique.clone(),
        status: reading.status.key().to_owned(),
        status_evidence: reading.status_evidence.clone(),
        encoding: reading.encoding.map(str::to_owned),
        started_at: reading.started_at.clone(),
        header_tags: reading.header_tags.clone(),
        runs: reading.tables.iter().map(inspected_table).collect(),
        issues: reading.issues.clone(),
        stored: None,
    }
}

fn inspected_table(table: &RunTable) -> InspectedTable {
    let time = table.time_column.as_ref().map(|(name, unit)| InspectedColumn {
        name: name.clone(),
        quantity: Some(Quantity::Time.key()),
        unit: unit.clone(),
        canonical: Some(Quantity::Time.column()),
        position_mm: None,
        readings: table.rows,
        excluded: 0,
        first: table.time_first_last_s.map(|t| t.0),
        last: table.time_first_last_s.map(|t| t.1),
        // A reader hands on no time that falls.
        smallest: table.time_first_last_s.map(|t| t.0),
        largest: table.time_first_last_s.map(|t| t.1),
    });
    let channels = table.channels.iter().map(|channel| {
        let summary = channel.summary();
        let known = channel.quantity != Quantity::Other;
        InspectedColumn {
            name: summary.raw_name,
            quantity: known.then(|| channel.quantity.key()),
            unit: summary.raw_unit,
            canonical: known.then(|| channel.quantity.column()),
            position_mm: channel.position_mm,
            readings: summary.readings,
            excluded: summary.excluded,
            first: summary.first,
            last: summary.last,
            smallest: channel.values.iter().copied().reduce(f64::min),
            largest: channel.values.iter().copied().reduce(f64::max),
        }
    });
    InspectedTable {
        name: table.name.clone(),
        rows: table.rows,
        printed_time: table.printed_time.clone(),
        flags: table.flags.clone(),
        columns: time.into_iter().chain(channels).collect(),
    }
}
