//! Where man pages, completions and what the program is allowed lie for one person, by the XDG Base Directory Specification.

use std::path::{Path, PathBuf};

use super::exit::CliError;
use super::output::Output;
use super::table::write;

/// A folder for data of the person who runs the program: `$XDG_DATA_HOME`, else `~/.local/share`.
pub fn data() -> Result<PathBuf, CliError> {
    under_home("XDG_DATA_HOME", ".local/share")
}

/// The same for settings: `$XDG_CONFIG_HOME`, else `~/.config`.
pub fn config() -> Result<PathBuf, CliError> {
    under_home("XDG_CONFIG_HOME", ".config")
}

/// The same for what the program keeps between its runs: `$XDG_STATE_HOME`, else `~/.local/state`.
pub fn state() -> Option<PathBuf> {
    found("XDG_STATE_HOME", ".local/state")
}

fn under_home(variable: &str, default: &str) -> Result<PathBuf, CliError> {
    found(variable, default).ok_or_else(|| {
        CliError::usage(&format!(
            "there is no home folder: neither {variable} nor HOME is set; name a folder with --into"
        ))
    })
}

fn found(variable: &str, default: &str) -> Option<PathBuf> {
    // A relative path in such a variable is to be ignored, says the specification.
    let set = std::env::var_os(variable)
        .map(PathBuf::from)
        .filter(|path| path.is_absolute());
    let home = || std::env::home_dir().filter(|home| home.is_absolute());
    set.or_else(|| Some(home()?.join(default)))
}

/// Writes a file into a folder that is made where it is not there.
pub fn put(
    folder: &Path,
    name: &str,
    bytes: &[u8],
    overwrite: bool,
    output: &Output,
) -> Result<(), CliError> {
    crate::system::fs::create_dir_all(folder).map_err(|error| {
        CliError::storage(&format!(
            "{}: {error}; the folder could not be made",
            folder.display()
        ))
    })?;
    write(&folder.join(name), bytes, overwrite, output)
}
