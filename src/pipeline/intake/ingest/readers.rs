//! Which readers there are, and which files they would read anew: formats by their version, profiles by their text.

use std::collections::{BTreeMap, BTreeSet};

use super::frame_folder;
use crate::domain::{Campaign, FileState};
use crate::ingest::Reading;
use crate::ingest::formats;
use crate::ingest::formats::error::AMBIGUOUS_DATES;
use crate::ingest::profiles::Profile;
use crate::store::FileRow;
use crate::strip;

/// The readers of a campaign: the program's formats and the campaign's profiles.
#[derive(Debug)]
pub struct Readers {
    /// Stamp of each reader.
    stamps: BTreeSet<String>,
    /// Marks the set of profiles and what campaign.toml says of files; empty where nothing is said.
    profiles: String,
    /// What read each file last, by its path.
    last: BTreeMap<String, String>,
}

/// Stands between the reader of a file and the set of profiles.
const BESIDE: &str = " beside profiles ";

impl Readers {
    /// The formats with these profiles and what the campaign says of files; `stored` are the files as they were read last.
    pub fn of(profiles: &[Profile], campaign: &Campaign, stored: &[FileRow]) -> Readers {
        let formats = formats::ALL.iter().map(|f| stamp(f.id(), f.about().version));
        let saved = profiles
            .iter()
            .map(|p| stamp(&p.format(), Profile::READER_VERSION));
        let mut hasher = blake3::Hasher::new();
        profiles.iter().for_each(|profile| {
            hasher.update(profile.digest.as_bytes());
        });
        if let Some(order) = campaign.date_order {
            hasher.update(order.key().as_bytes());
        }
        for (key, answer) in &campaign.answers {
            hasher.update(format!("{key}={answer}\n").as_bytes());
        }
        Readers {
            stamps: formats
                .chain(saved)
                .chain([stamp(frame_folder::FORMAT, strip::VERSION)])
                .collect(),
            profiles: if profiles.is_empty() && campaign.date_order.is_none() && campaign.answers.is_empty() {
                String::new()
            } else {
                format!("{BESIDE}{}", &hasher.finalize().to_hex()[..12])
            },
            last: stored
                .iter()
                .map(|file| (file.path.clone(), file.reader.clone()))
                .collect(),
        }
    }

    /// How the database records the reader of a file that holds a run.
    ///
    /// The set of profiles is part of it, for a new profile may be the one that a file was waiting for.
    pub fn of_file(&self, reading: &Reading, profile: Option<&Profile>) -> String {
        reader_of(reading, profile) + &self.profiles
    }

    /// The reader that read a file last.
    pub fn last_of(&self, path: &str) -> Option<&str> {
        self.last.get(path)?.split(BESIDE).next()
    }

    /// The same for files that every reader turned down.
    pub fn all(&self) -> String {
        let stamps: Vec<&str> = self.stamps.iter().map(String::as_str).collect();
        stamps.join(" ") + &self.profiles
    }

    /// Files that these readers would read anew: of runs, where their reader changed or the set of profiles did; of
    /// refused and waiting files and of sidecars, where any reader changed.
    pub fn outdated<'f>(&self, stored: &'f [FileRow]) -> BTreeSet<&'f str> {
        let all = self.all();
        let is_current = |reader: &str| {
            reader
                .strip_suffix(self.profiles.as_str())
                .is_some_and(|stamp| self.stamps.contains(stamp))
        };
        let is_outdated = |file: &&FileRow| match file.state {
            FileState::Run | FileState::Log => !is_current(&file.reader),
            // A file that came beside it may show the order of its dates.
            FileState::Refused if is_open_date(file) => true,
            FileState::Refused | FileState::Pending | FileState::Sidecar => file.reader != all,
            FileState::Alias => false,
        };
        stored
            .iter()
            .filter(is_outdated)
            .map(|file| file.path.as_str())
            .collect()
    }
}

/// Whether a file was refused because its dates leave their order open.
fn is_open_date(file: &FileRow) -> bool {
    let issue = file.issue.as_ref();
    issue.is_some_and(|issue| issue.code == AMBIGUOUS_DATES)
}

/// Format and version of the reader of a run, as `id/version`; a profile's id holds its digest.
pub fn reader_of(reading: &Reading, profile: Option<&Profile>) -> String {
    stamp(&format_of(reading, profile), reading.reader_version)
}

/// Format of a run: the reader's id, or the profile with its digest.
pub fn format_of(reading: &Reading, profile: Option<&Profile>) -> String {
    profile.map_or_else(|| reading.format.to_owned(), Profile::format)
}

fn stamp(id: &str, version: u32) -> String {
    format!("{id}/{version}")
}
