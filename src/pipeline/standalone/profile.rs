//! Proposes a profile for a file, shows what it reads, and saves it.

use std::path::{Path, PathBuf};

use super::inspect::{Inspection, inspect_bytes};
use crate::ingest::formats::{self, ReadContext, ReadError};
use crate::ingest::profiles::{self, FOLDER, StatedColumn};
use crate::ingest::table::Answers;
use crate::pipeline::infra::whole_file::put_bytes;
use crate::pipeline::{PipelineError, failed};
use crate::system::fs;

/// A proposed profile and what it makes of its file.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ProposedProfile {
    /// Always `ieap/profile/1`.
    pub schema: &'static str,
    /// The profile's text.
    pub profile: String,
    /// What the file does not show and has to be filled in; empty where the profile can be used as it is.
    pub open: Vec<String>,
    /// Why it cannot be used yet.
    pub refusal: Option<String>,
    /// What is read with it; null where it cannot be used yet.
    pub read: Option<Inspection>,
    /// Where it was written; null where it was not.
    pub written: Option<PathBuf>,
}

/// Proposes a profile for `file`, under the id `name`, with what is `stated` of its columns, or one of `answers` to what it leaves
/// open.
///
/// # Errors
/// The file cannot be opened, or holds no table.
pub fn propose(
    file: &Path,
    name: &str,
    stated: &[StatedColumn],
    answers: &Answers,
) -> Result<ProposedProfile, PipelineError> {
    let bytes = fs::read(file).map_err(failed(file, "reading the file"))?;
    let file_name = file.file_name().unwrap_or_default().to_string_lossy();
    let proposal = if answers.is_empty() {
        profiles::propose(&file_name, &bytes, stated)
    } else {
        profiles::answered(&file_name, &bytes, answers)
    };
    let mut proposal = proposal.map_err(|error| PipelineError::NoTable {
        path: file.to_owned(),
        found: error.to_string(),
    })?;
    if answers.is_empty()
        && let Err(ReadError::Asked(question)) = formats::read(&file_name, &bytes, &ReadContext::default())
    {
        proposal
            .open
            .push(format!("{question} Answer with --answer {}=...", question.key));
    }
    let parsed = profiles::from_text(Path::new(&format!("{name}.toml")), &proposal.text);
    let (read, refusal) = match parsed {
        Ok(profile) => (
            Some(inspect_bytes(file, &bytes, &[profile], &ReadContext::default())),
            None,
        ),
        Err(error) => (None, Some(error.to_string())),
    };
    Ok(ProposedProfile {
        schema: "ieap/profile/1",
        profile: proposal.text,
        open: proposal.open,
        refusal,
        read,
        written: None,
    })
}

impl ProposedProfile {
    /// Writes it into the campaign; one with places to fill in gets the ending `.draft`, under which nothing reads it.
    ///
    /// # Errors
    /// The name is no id, there is such a profile or one for the same header, or the folder cannot be written.
    pub fn write(&mut self, campaign: &Path, name: &str) -> Result<(), PipelineError> {
        if !profiles::is_id(name) {
            return Err(PipelineError::BadArgument {
                what: "--write",
                found: format!("{name:?}"),
                needed: "lower case letters, digits, - and _, such as laser-de".to_owned(),
            });
        }
        let folder = campaign.join(FOLDER);
        let usable = self.open.is_empty() && self.refusal.is_none();
        let ending = if usable { "toml" } else { "toml.draft" };
        let path = folder.join(format!("{name}.{ending}"));
        let taken = folder.join(format!("{name}.toml"));
        if let Some(path) = [&path, &taken].into_iter().find(|path| path.exists()) {
            return Err(PipelineError::FileExists { path: path.clone() });
        }
        if let Some(path) = self.of_same_header(&folder, ending, [&path, &taken]) {
            return Err(PipelineError::FileExists { path });
        }
        fs::create_dir_all(&folder).map_err(failed(&folder, "making the folder of profiles"))?;
        put_bytes(&path, false, self.profile.as_bytes())?;
        self.written = Some(path);
        Ok(())
    }

    /// The profile of another name that is for files of the same header: of two neither would read them. A draft, which reads nothing,
    /// is in the way of another draft only.
    fn of_same_header(&self, folder: &Path, ending: &str, own: [&PathBuf; 2]) -> Option<PathBuf> {
        let header = self
            .profile
            .lines()
            .find(|line| line.starts_with("contains = "))?;
        let names = fs::entries(folder).ok()?.into_iter();
        let stem = |path: &Path| path.with_extension("").with_extension("");
        names.map(|entry| entry.path()).find(|path| {
            let counts = ending == "toml.draft" || path.extension().is_some_and(|last| last == "toml");
            counts
                && !own.iter().any(|own| stem(own) == stem(path))
                && fs::read_own_text(path).is_ok_and(|text| text.lines().any(|line| line == header))
        })
    }
}
