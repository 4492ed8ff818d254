//! Why a profile cannot be used.

use std::path::PathBuf;

/// Why a profile cannot be used: where, what was found, what is needed, how to mend it.
#[derive(Debug, thiserror::Error)]
pub enum ProfileError {
    /// The file, or the folder of profiles, cannot be read.
    #[error("{}: cannot be read ({source}); give your user the right to read it", path.display())]
    Unreadable {
        /// The file or folder.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The bytes are no UTF-8.
    #[error("{}: is not UTF-8; save it with the encoding UTF-8", path.display())]
    NotUtf8 {
        /// The file.
        path: PathBuf,
    },
    /// The file's name is no id.
    #[error("{}: the name of a profile is its id; use lower case letters, digits, - and _ only, such as laser-de.toml", path.display())]
    BadName {
        /// The file.
        path: PathBuf,
    },
    /// The text is no TOML, or a value has another type or another key than a profile has.
    #[error("{}, line {line}, column {column}: {found}; correct that line (docs/profiles.md lists the keys)", path.display())]
    NotToml {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the TOML reader says.
        found: String,
    },
    /// A statement is missing, or cannot be.
    #[error("{}, {place}: {found}; needed: {needed}", path.display())]
    Statement {
        /// The file.
        path: PathBuf,
        /// Line and key: `line 8, [time] unit`.
        place: String,
        /// What stands there, or that it is missing.
        found: String,
        /// What may stand there.
        needed: String,
    },
}
