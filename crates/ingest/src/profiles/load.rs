//! The saved profiles of a campaign.

use std::io;
use std::path::Path;

use super::{Profile, ProfileError, check, raw};
use crate::campaign_file::line_and_column;
use ieap_system::fs;

/// Folder of the profiles inside a campaign.
pub const FOLDER: &str = "profiles";

/// The profiles of a campaign, by id; none where there is no such folder.
///
/// # Errors
/// A profile that cannot be used: where, what was found, what is needed. Nothing is read beside a wrong profile, for
/// the files that it stands for would be read in another way without a word.
pub fn load(campaign: &Path) -> Result<Vec<Profile>, ProfileError> {
    let folder = campaign.join(FOLDER);
    let unreadable = |path: &Path| {
        let path = path.to_owned();
        move |source| ProfileError::Unreadable { path, source }
    };
    let entries = match fs::read_dir(&folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(unreadable(&folder)(error)),
    };
    let mut profiles = Vec::new();
    for entry in entries {
        let path = entry.map_err(unreadable(&folder))?.path();
        let is_hidden = path
            .file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if is_hidden || path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let bytes = fs::read_stated(campaign, &path).map_err(unreadable(&path))?;
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
        let text = std::str::from_utf8(bytes).map_err(|_| ProfileError::NotUtf8 { path: path.clone() })?;
        profiles.push(from_text(&path, text)?);
    }
    profiles.sort_by(|a, b| a.id.cmp(&b.id));
    Ok(profiles)
}

/// The profile of a file's text; `path` gives the id and stands in messages.
///
/// # Errors
/// See [`ProfileError`].
pub fn from_text(path: &Path, text: &str) -> Result<Profile, ProfileError> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    if !is_id(&stem) {
        return Err(ProfileError::BadName { path: path.into() });
    }
    let file: raw::File = toml::from_str(text).map_err(|error| {
        let (line, column) = line_and_column(text, error.span().map_or(0, |span| span.start));
        ProfileError::NotToml {
            path: path.into(),
            line,
            column,
            found: error.message().replace('\n', " "),
        }
    })?;
    let checker = check::Checker {
        path,
        id: &stem,
        text,
    };
    checker.profile(file)
}

/// Whether a word can be the id of a profile.
pub fn is_id(word: &str) -> bool {
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '-' | '_');
    (1..=64).contains(&word.len()) && word.chars().all(fits)
}
