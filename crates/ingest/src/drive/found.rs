//! What is found of a run's drive.

use ieap_domain::{Drive, Issue};

/// Code of the issue of a voltage that does not go in steps.
pub const NO_STEPS: &str = "not-piecewise-constant";

/// Code of the note on a voltage that moves all the time.
pub const MOVES: &str = "voltage-moves";

/// What is known of a run's drive.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundDrive {
    /// The drive; none where it cannot be had, and an issue says why.
    pub drive: Option<Drive>,
    /// What a reader must know of it.
    pub issues: Vec<Issue>,
}
