//! Everything a report is made of, except the curves.

use crate::domain::{Campaign, ModulusLog, RunRecord, SourceFile};

/// What a report shows. No clock is read anywhere: the same input gives the same bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// The campaign.
    pub campaign: Campaign,
    /// Current revision of every run, in the order in which lists show them.
    pub runs: Vec<RunRecord>,
    /// Earlier revisions of the same paths, for the history on the run pages.
    pub superseded: Vec<RunRecord>,
    /// Current modulus logs with what was found in them.
    pub modulus_logs: Vec<ModulusLog>,
    /// Every file that the last scan saw.
    pub files: Vec<SourceFile>,
    /// What the report was generated from.
    pub origin: Origin,
    /// What came in last, newest first; the index shows the first few.
    pub news: Vec<News>,
}

/// What a report was generated from, printed at the foot of every page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// Program with its version, `ieap 0.1.0`.
    pub program: String,
    /// State of the database in words, `change 412 of 2026-11-20T06:00:00Z`.
    pub database: String,
}

/// A run that came in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct News {
    /// Path of the run.
    pub run_path: String,
    /// When, RFC 3339 UTC.
    pub at: String,
}
