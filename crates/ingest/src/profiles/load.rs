//! The saved profiles of a campaign.

use std::io;
use std::path::{Path, PathBuf};

use super::{Profile, ProfileError, Profiles, RefusedProfile, check, raw};
use crate::campaign_file::line_and_column;
use ieap_system::fs;

/// Folder of the profiles inside a campaign.
pub const FOLDER: &str = "profiles";

/// The profiles of a campaign, by id; none where there is no such folder. One that cannot be used is among the refused: the
/// files that it may be for wait, for they would be read in another way without a word.
pub fn load(campaign: &Path) -> Profiles {
    let folder = campaign.join(FOLDER);
    let mut profiles = Profiles::default();
    let unreadable = |path: &Path, source: io::Error| {
        let error = ProfileError::Unreadable {
            path: path.to_owned(),
            source,
        };
        RefusedProfile::new(shown(path), error, None)
    };
    let paths: io::Result<Vec<PathBuf>> = match fs::read_dir(&folder) {
        Ok(entries) => entries.map(|entry| Ok(entry?.path())).collect(),
        Err(error) if error.kind() == io::ErrorKind::NotFound => return profiles,
        Err(error) => Err(error),
    };
    let mut paths = paths.unwrap_or_else(|source| {
        profiles.refused.push(unreadable(&folder, source));
        Vec::new()
    });
    paths.sort();
    for path in paths.iter().filter(|path| is_profile(path)) {
        match fs::read_stated(campaign, path) {
            Ok(bytes) => match from_bytes(path, &bytes) {
                Ok(profile) => profiles.saved.push(profile),
                Err(error) => {
                    let text = std::str::from_utf8(&bytes).ok();
                    profiles
                        .refused
                        .push(RefusedProfile::new(shown(path), error, text));
                }
            },
            Err(source) => profiles.refused.push(unreadable(path, source)),
        }
    }
    profiles.saved.sort_by(|a, b| a.id.cmp(&b.id));
    profiles
}

/// As people name it, below the campaign.
fn shown(path: &Path) -> String {
    let name = path.file_name().filter(|name| *name != FOLDER);
    name.map_or_else(
        || FOLDER.to_owned(),
        |name| format!("{FOLDER}/{}", name.to_string_lossy()),
    )
}

fn is_profile(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default();
    !name.to_string_lossy().starts_with('.') && path.extension().is_some_and(|extension| extension == "toml")
}

fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Profile, ProfileError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes).map_err(|_| ProfileError::NotUtf8 { path: path.into() })?;
    from_text(path, text)
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
