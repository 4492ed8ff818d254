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
use crate::pipeline::PipelineError;
use crate::pipeline::infra::whole_file::put_bytes;

/// Writes a commented campaign.toml and makes the folders; gives the paths made. Files that are there stay.
///
/// # Errors
/// The folder is a campaign already, or cannot be written.
pub fn init(folder: &Path) -> Result<Vec<PathBuf>, PipelineError> {
    let file = folder.join(campaign_file::FILE_NAME);
    if file.exists() {
        return Err(PipelineError::FileExists { path: file });
    }
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| PipelineError::File {
            path,
            doing: "making the campaign",
            source,
        }
    };
    let mut made = Vec::new();
    for name in ["runs", "dma", "ambient"] {
        let path = folder.join(name);
        std::fs::create_dir_all(&path).map_err(failed(&path))?;
        made.push(path);
    }
    let absolute = std::fs::canonicalize(folder).map_err(failed(folder))?;
    let id = absolute
        .file_name()
        .map_or("campaign".into(), |name| name.to_string_lossy().into_owned());
    put_bytes(&file, false, campaign_file::template(&id).as_bytes())?;
    made.push(file);
    Ok(made)
}
