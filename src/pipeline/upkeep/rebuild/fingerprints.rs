//! Files of the folder that still are what they were: known by their bytes, so that the scan that follows passes them by.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::analysis::climate::sensors::FOLDERS as LOGS;
use crate::ingest::archive;
use crate::ingest::scan::{self, SeenFile};
use crate::pipeline::campaign::context::now;
use crate::pipeline::{Context, PipelineError};
use crate::store::FileRow;

/// Largest file that is looked at, bytes; a larger one is read by the scan.
const LARGEST_BYTES: u64 = 1 << 30;

/// Notes the fingerprint of every known file whose bytes are those that it had.
///
/// # Errors
/// The database refuses. A folder that cannot be looked through is left to the scan.
pub fn note(context: &mut Context) -> Result<(), PipelineError> {
    let known: BTreeMap<String, FileRow> = (context.store.files()?.into_iter())
        .map(|file| (file.path.clone(), file))
        .collect();
    let (folder, read_file) = (&context.folder, context.read_file);
    let same = |seen: &SeenFile| -> Option<FileRow> {
        let row = known.get(&seen.display)?;
        let location = seen.location(folder);
        let bytes = location
            .is_file()
            .then(|| read_file(&location, LARGEST_BYTES).ok())??;
        (Some(archive::hash(&bytes)) == row.hash).then(|| FileRow {
            size_bytes: seen.size_bytes,
            modified_ns: seen.modified_ns,
            inode: seen.inode,
            changed_ns: seen.changed_ns,
            missing_since: None,
            ..row.clone()
        })
    };
    let mut rows: Vec<FileRow> = Vec::new();
    let runs_folders = std::iter::once(context.campaign.runs_folder.as_str()).chain(LOGS);
    for runs_folder in runs_folders {
        let optional = if LOGS.contains(&runs_folder) {
            Vec::new()
        } else {
            context.campaign.optional_folders().to_vec()
        };
        let Ok(seen) = scan::scan(folder, runs_folder, &optional, scan::ScanLimits::default()) else {
            continue;
        };
        rows.par_extend(seen.files.par_iter().filter_map(|file| same(file)));
    }
    Ok(context.store.record_files(&now(), &rows)?)
}
