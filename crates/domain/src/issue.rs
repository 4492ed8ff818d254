//! Something a reader must know of a file, a run or a fit.

use crate::string_enum;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

string_enum! {
    /// How much an issue matters.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum Severity {
        /// Good to know.
        Note = "note",
        /// The numbers may not mean what they seem to.
        Warning = "warning",
        /// The input was refused, or a result could not be had.
        Error = "error",
    }
}

/// One finding, in words a user can act on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Issue {
    /// How much it matters.
    pub severity: Severity,
    /// Stable slug, `overload-excluded`, for scripts to count by.
    pub code: String,
    /// Where: `line 17, column 3`, `column current_a`, a tag key; empty where the whole input is meant.
    pub place: String,
    /// What was seen and what was expected.
    pub message: String,
    /// How to mend it; empty where there is nothing to mend.
    pub mend: String,
}

impl Issue {
    /// A note without a place or a mend.
    pub fn note(code: &str, message: impl Into<String>) -> Issue {
        Issue::new(Severity::Note, code, message)
    }

    /// A warning without a place or a mend.
    pub fn warning(code: &str, message: impl Into<String>) -> Issue {
        Issue::new(Severity::Warning, code, message)
    }

    /// An error without a place or a mend.
    pub fn error(code: &str, message: impl Into<String>) -> Issue {
        Issue::new(Severity::Error, code, message)
    }

    /// That a fault of the program stopped `what`, and what it said.
    pub fn fault(code: &str, what: &str, reason: &str) -> Issue {
        let message = format!("{what} stopped on an internal fault: {reason}");
        Issue::new(Severity::Error, code, message)
    }

    fn new(severity: Severity, code: &str, message: impl Into<String>) -> Issue {
        Issue {
            severity,
            code: code.to_owned(),
            place: String::new(),
            message: message.into(),
            mend: String::new(),
        }
    }

    /// The same issue at `place`.
    pub fn at(mut self, place: impl Into<String>) -> Issue {
        self.place = place.into();
        self
    }

    /// The same issue with the way to mend it.
    pub fn mend(mut self, mend: impl Into<String>) -> Issue {
        self.mend = mend.into();
        self
    }
}
