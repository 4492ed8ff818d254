//! Reads campaign.toml: the campaign with its samples, materials and environments.

mod check;
mod climate;
mod compare;
mod error;
mod kept;
mod keys;
mod known;
mod lines;
mod monitoring;
mod nearest;
mod pairs;
mod publication;
mod raw;
mod study;
mod tags;
mod template;

use std::path::{Path, PathBuf};

use crate::scan::composed;
use ieap_domain::{Campaign, Issue};
use ieap_system::fs;

pub use check::DEFAULT_MODEL;
pub use error::CampaignFileError;
pub use kept::{KEPT, NOT_READ, keep, or_kept};
pub use keys::UNKNOWN_KEY;
pub(crate) use lines::line_and_column;
pub(crate) use nearest::nearest;
pub use publication::{Author, Publication, publication};
pub use template::template;

/// Name of the file that makes a folder a campaign.
pub const FILE_NAME: &str = "campaign.toml";

/// What reading campaign.toml gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The campaign as stated.
    pub campaign: Campaign,
    /// What is odd but does not stop: unknown keys, no samples yet.
    pub warnings: Vec<Issue>,
    /// The file's text, for a digest of what the campaign was read from.
    pub text: String,
}

/// Reads `folder`/campaign.toml.
///
/// # Errors
/// Where the file is missing, is no TOML, has values of the wrong type, or states what cannot be: each
/// error names the place, what was found, what is needed and how to mend it.
pub fn read(folder: &Path) -> Result<Loaded, CampaignFileError> {
    let path = folder.join(FILE_NAME);
    let text = read_text(folder, &path)?;
    let loaded = from_text(text, &path)?;
    check::runs_folder_stays_inside(folder, &loaded.campaign.runs_folder, &path)?;
    Ok(loaded)
}

/// The nearest folder with a campaign.toml, or with what it was worked with last: `start` itself or one above it.
pub fn find(start: &Path) -> Option<PathBuf> {
    let start = fs::canonicalize(start).ok()?;
    // Whatever has the name: one that cannot be read is told, not passed by.
    let is_there = |path: PathBuf| fs::symlink_metadata(path).is_ok();
    let holds_campaign = |folder: &&Path| is_there(folder.join(FILE_NAME)) || is_there(folder.join(KEPT));
    start.ancestors().find(holds_campaign).map(Path::to_path_buf)
}

fn read_text(folder: &Path, path: &Path) -> Result<String, CampaignFileError> {
    let bytes = fs::read_stated(folder, path).map_err(|source| match source.kind() {
        std::io::ErrorKind::NotFound => CampaignFileError::Missing { path: path.into() },
        _ => CampaignFileError::Unreadable {
            path: path.into(),
            source,
        },
    })?;
    // Editors on Windows put a byte order mark before UTF-8; it is no part of the text.
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.to_owned()),
        Err(error) => Err(CampaignFileError::NotUtf8 {
            path: path.into(),
            line: bytes[..error.valid_up_to()]
                .iter()
                .filter(|&&b| b == b'\n')
                .count()
                + 1,
        }),
    }
}

fn from_text(written: String, path: &Path) -> Result<Loaded, CampaignFileError> {
    // An id is one however the marks above its letters are written.
    let text = composed(&written);
    let tree = toml::de::DeTable::parse(&text).map_err(|error| {
        let (line, column) = line_and_column(&text, error.span().map_or(0, |span| span.start));
        CampaignFileError::NotToml {
            path: path.into(),
            line,
            column,
            found: error.message().to_owned(),
        }
    })?;
    let lines = lines::Lines::of(&text);
    let mut warnings = keys::unknown_keys(tree.get_ref(), &lines);
    let mut raw: raw::File = toml::from_str(&text).map_err(|error| {
        let (line, column) = line_and_column(&text, error.span().map_or(0, |span| span.start));
        CampaignFileError::WrongType {
            path: path.into(),
            line,
            column,
            found: error.message().to_owned(),
        }
    })?;
    // Folders are there under the names that are written.
    if let Ok(places) = toml::from_str(&written) {
        raw.take_places(places);
    }
    let checked = check::Checker { path, lines: &lines };
    let campaign = checked.campaign(raw, &mut warnings)?;
    Ok(Loaded {
        campaign,
        warnings,
        text: written,
    })
}

#[cfg(test)]
mod tests;
