//! Why a simulation is not made.

use std::path::PathBuf;

use thiserror::Error;

/// Why a spec cannot be simulated.
#[derive(Debug, Error)]
pub enum SpecError {
    /// The file cannot be read.
    #[error("{path}: the simulation spec cannot be read: {source}")]
    Unreadable {
        /// The spec.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is not a spec.
    #[error("{path}: {detail}")]
    Malformed {
        /// The spec.
        path: PathBuf,
        /// Where and what.
        detail: String,
    },
    /// A value makes no sense.
    #[error("{path}: {place}: found {found}, needed {needed}")]
    BadValue {
        /// The spec.
        path: PathBuf,
        /// Which value.
        place: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        needed: String,
    },
}
