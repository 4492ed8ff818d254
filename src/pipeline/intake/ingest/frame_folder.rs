//! A folder of frames as a file that holds a run: what is traced from it is the text that is read and archived.
//!
//! The archive keeps the traced table with the hash of every frame, not the frames: they are a thousand times larger,
//! and the run can be made again from the table.

use std::path::Path;

use super::prepare::{Outcome, PreparedFile, not_read_now};
use crate::domain::Issue;
use crate::domain::number::fixed;
use crate::domain::words::counted;
use crate::ingest::Reading;
use crate::ingest::archive;
use crate::ingest::formats::plain_table::PlainTable;
use crate::ingest::formats::{Format, ReadContext};
use crate::ingest::frames::{self, FrameFile};
use crate::ingest::scan::SeenFile;
use crate::pipeline::intake::trace::{RefusedFrame, Source, described, trace_frames};
use crate::pipeline::{PipelineError, Silent};
use crate::strip;

/// The format under which such a run is recorded.
pub const FORMAT: &str = "frames";

/// Traces the folder and reads what was traced.
pub fn prepare(campaign: &Path, file: &SeenFile, folder: &Path) -> PreparedFile {
    let (bytes, outcome) = match traced(campaign, folder) {
        Ok((bytes, outcome)) => (bytes, outcome),
        Err(outcome) => (Vec::new(), outcome),
    };
    let is_read = matches!(outcome, Outcome::Read(_));
    PreparedFile {
        file: file.clone(),
        hash: is_read.then(|| archive::hash(&bytes)),
        bytes,
        archived: None,
        outcome,
        profile: None,
    }
}

/// What was traced from a folder before, as its table says; what tracing remarked on frames is not in the table.
///
/// # Errors
/// The table cannot be read.
pub fn reading_of_table(bytes: &[u8]) -> Result<Reading, Issue> {
    let mut reading = PlainTable
        .read(bytes, &ReadContext::default())
        .map_err(|error| error.issue())?;
    reading.format = FORMAT;
    reading.reader_version = strip::VERSION;
    Ok(reading)
}

fn traced(campaign: &Path, folder: &Path) -> Result<(Vec<u8>, Outcome), Outcome> {
    let refuse = |error: PipelineError| {
        let message = error.to_string().replace(&format!("{}/", campaign.display()), "");
        if error.is_of_system() {
            return Outcome::Unread(not_read_now(&message));
        }
        Outcome::Refused(
            Issue::error("frames-not-traced", message)
                .mend("mend frames.toml or the frames; `ieap trace` on the folder shows what is seen"),
        )
    };
    let given = described(&[folder.to_owned()], &frames::FrameSettings::default()).map_err(refuse)?;
    let times_s = frames::times(&given.files, &given.settings).map_err(|error| refuse(error.into()))?;
    let source = Source {
        files: &given.files,
        times_s: &times_s,
        settings: &given.settings,
        sample_length_mm: given.length_mm,
        overlays: None,
    };
    let traced = trace_frames(&source, &Silent).map_err(refuse)?;
    if sizes(folder) != Some(sizes_of(&given.files)) {
        let issue = Issue::note(
            "still-growing",
            "frames came in while they were traced; they are traced when it rests",
        );
        return Err(Outcome::Pending(issue));
    }
    let bytes = traced.table.into_bytes();
    let mut reading = reading_of_table(&bytes).map_err(Outcome::Refused)?;
    reading.issues.extend(refused(&traced.refused, given.files.len()));
    reading.issues.push(Issue::note(
        "frames-traced",
        format!(
            "curvatures are traced from {}: scale {} px/mm ({}), counted from {}; the frames stay where they are, the table and their hashes are archived",
            counted(traced.rows, "frame"),
            fixed(traced.view.px_per_mm, 3),
            traced.view.scale_from,
            traced.view.initial
        ),
    ));
    Ok((bytes, Outcome::Read(Box::new(reading))))
}

fn refused(frames: &[RefusedFrame], of: usize) -> Option<Issue> {
    let first = frames.first()?;
    let message = format!(
        "{} of {of} frames could not be traced and are left out; the first, {}: {}",
        frames.len(),
        first.frame,
        first.reason
    );
    Some(Issue::warning("frames-refused", message))
}

fn sizes(folder: &Path) -> Option<Vec<(String, u64)>> {
    frames::list(folder).ok().map(|files| sizes_of(&files))
}

fn sizes_of(files: &[FrameFile]) -> Vec<(String, u64)> {
    files
        .iter()
        .map(|file| (file.name.clone(), file.size_bytes))
        .collect()
}
