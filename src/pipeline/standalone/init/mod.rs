//! Makes a folder a campaign: an empty one, or one of files that are there.

mod from;
mod look;
mod plan;
mod text;

use std::path::{Path, PathBuf};

pub use from::{InitFrom, Proposed};
pub use look::{Seen, Taken};
pub use plan::PlannedFile;

use crate::ingest::campaign_file;
use crate::pipeline::infra::whole_file::put_bytes;
use crate::pipeline::{PipelineError, failed};

/// What is being done where the system refuses.
const MAKING: &str = "making the campaign";

/// Writes a commented campaign.toml and makes the folders; gives the paths made. Files that are there stay.
///
/// # Errors
/// The folder is a campaign already, or cannot be written.
pub fn init(folder: &Path) -> Result<Vec<PathBuf>, PipelineError> {
    let file = folder.join(campaign_file::FILE_NAME);
    if file.exists() {
        return Err(PipelineError::FileExists { path: file });
    }
    let mut made = make_folders(folder)?;
    let absolute = std::fs::canonicalize(folder).map_err(failed(folder, MAKING))?;
    let id = absolute
        .file_name()
        .map_or("campaign".into(), |name| name.to_string_lossy().into_owned());
    put_bytes(&file, false, campaign_file::template(&id).as_bytes())?;
    made.push(file);
    Ok(made)
}

/// Makes the folders that a campaign's files go into; gives their paths.
fn make_folders(campaign: &Path) -> Result<Vec<PathBuf>, PipelineError> {
    let make = |name: &str| {
        let path = campaign.join(name);
        std::fs::create_dir_all(&path).map_err(failed(&path, MAKING))?;
        Ok(path)
    };
    ["runs", "dma", "ambient"].into_iter().map(make).collect()
}
