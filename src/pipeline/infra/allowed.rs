//! Commands of campaigns that the person who runs the program allowed on this machine. A campaign may come from anybody, and
//! what it names to be run is run only by the word of who runs it.

use std::io;
use std::path::{Path, PathBuf};

use super::whole_file::put_own;
use crate::pipeline::{PipelineError, failed};
use crate::system::fs;

/// What was allowed: a file for each campaign folder and command, in a folder of that person outside of all campaigns. A file
/// that is deleted allows nothing any more.
#[derive(Debug, Clone, Default)]
pub struct AllowedCommands {
    folder: Option<PathBuf>,
}

impl AllowedCommands {
    /// Those that are kept in that folder, which need not be there; none is allowed where there is no such folder.
    pub fn kept_in(folder: Option<PathBuf>) -> AllowedCommands {
        AllowedCommands { folder }
    }

    /// Whether that very command of the campaign in that folder was allowed.
    ///
    /// # Errors
    /// The system cannot tell.
    pub fn has(&self, campaign: &Path, command: &[String]) -> io::Result<bool> {
        match &self.folder {
            None => Ok(false),
            Some(folder) => fs::exists(folder.join(name(&fs::canonicalize(campaign)?, command))),
        }
    }

    /// Allows it from now on; gives the file that says so.
    ///
    /// # Errors
    /// There is no folder for it, or that file cannot be written.
    pub fn allow(&self, campaign: &Path, command: &[String]) -> Result<PathBuf, PipelineError> {
        let folder = self.folder.as_ref().ok_or(PipelineError::BadArgument {
            what: "--allow-command",
            found: "no home folder".to_owned(),
            needed: "HOME or XDG_STATE_HOME, to keep there what you allow".to_owned(),
        })?;
        let campaign = fs::canonicalize(campaign).map_err(failed(campaign, "looking at it"))?;
        fs::create_dir_all(folder).map_err(failed(folder, "making the folder for what you allow"))?;
        let path = folder.join(name(&campaign, command));
        let text = format!("{}\n{}\n", campaign.display(), as_stated(command));
        put_own(&path, text.as_bytes())?;
        Ok(path)
    }
}

/// A name that no other campaign folder and command have.
fn name(campaign: &Path, command: &[String]) -> String {
    let mut hasher = blake3::Hasher::new();
    let parts = command.iter().map(String::as_bytes);
    for part in std::iter::once(campaign.as_os_str().as_encoded_bytes()).chain(parts) {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize().to_hex().to_string()
}

/// A command as campaign.toml has it.
pub fn as_stated(command: &[String]) -> String {
    let words: Vec<String> = command.iter().map(|word| format!("{word:?}")).collect();
    format!("[{}]", words.join(", "))
}

/// Said of a command that was not allowed, and how to allow it.
pub fn not_allowed(command: &[String]) -> String {
    format!(
        "{} is not allowed on this machine; if you want this program run, start `ieap run` or `ieap watch` once with \
         --allow-command",
        as_stated(command)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(words: &[&str]) -> Vec<String> {
        words.iter().map(|word| (*word).to_owned()).collect()
    }

    #[test]
    fn one_command_of_one_folder_is_allowed_and_no_other() {
        let (state, one, other) = (
            tempfile::tempdir().unwrap(),
            tempfile::tempdir().unwrap(),
            tempfile::tempdir().unwrap(),
        );
        let allowed = AllowedCommands::kept_in(Some(state.path().join("ieap/allowed")));
        let told = command(&["sh", "tell me"]);
        assert!(!allowed.has(one.path(), &told).unwrap());
        let file = allowed.allow(one.path(), &told).unwrap();
        assert!(allowed.has(one.path(), &told).unwrap());
        assert!(allowed.has(&one.path().join("."), &told).unwrap());
        assert!(!allowed.has(other.path(), &told).unwrap());
        for changed in [
            command(&["sh", "tell", "me"]),
            command(&["sh", "tell me "]),
            command(&["sh"]),
        ] {
            assert!(!allowed.has(one.path(), &changed).unwrap(), "{changed:?}");
        }
        let said = std::fs::read_to_string(&file).unwrap();
        assert!(said.ends_with("[\"sh\", \"tell me\"]\n"), "{said}");
        std::fs::remove_file(file).unwrap();
        assert!(!allowed.has(one.path(), &told).unwrap());
    }

    #[test]
    fn nothing_is_allowed_where_there_is_no_place_to_keep_it() {
        let campaign = tempfile::tempdir().unwrap();
        let allowed = AllowedCommands::default();
        assert!(!allowed.has(campaign.path(), &command(&["sh"])).unwrap());
        assert!(allowed.allow(campaign.path(), &command(&["sh"])).is_err());
    }
}
