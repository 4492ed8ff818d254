//! A tag set by hand.

use serde::{Deserialize, Serialize};

/// A tag that a person set with `ieap tag`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct HandTag {
    /// The run's name.
    pub run_path: String,
    /// Tag key.
    pub key: String,
    /// Value; none takes an earlier hand tag back.
    pub value: Option<String>,
    /// Who set it.
    pub set_by: String,
    /// When, RFC 3339 UTC.
    pub set_at: String,
}
