//! What was taken in.

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::Issue;
use crate::domain::pairs::{LoneHalf, Pair};
use crate::ingest::name_pattern::ProposedPattern;
use crate::pipeline::infra::mends::Together;
use crate::pipeline::intake::climate::LogSummary;

/// What `ingest` did.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct IngestSummary {
    /// Files in the folders with data.
    pub files: usize,
    /// Runs that came in for the first time.
    pub new: Vec<String>,
    /// Runs whose file has new content: a new revision.
    pub revised: Vec<String>,
    /// Runs under whose name another measurement lay before: what was said of that one does not hold of them.
    pub replaced: Vec<String>,
    /// Runs that took the name of a moved file: old and new.
    pub renamed: Vec<(String, String)>,
    /// Files that hold the same bytes as a run's file, found now.
    pub aliases: Vec<String>,
    /// Files that were joined now, two of a run.
    pub paired: Vec<Pair>,
    /// Files that hold half of a run and whose partner is not there, now.
    pub lone_halves: Vec<LoneHalf>,
    /// Pairs of runs that hold the same readings, found now.
    pub copies: usize,
    /// Files refused, now or before, with the reason.
    pub refused: Vec<(String, Issue)>,
    /// Files that the system could not give, with what it said: nothing is decided about them, and every scan tries again.
    pub unread: Vec<(String, Issue)>,
    /// What cannot be read of tag files, now: the runs that they speak for wait.
    pub unreadable_tags: Vec<UnreadableTags>,
    /// Files that state tags and with which no file is read, now, with the reason.
    pub unread_statements: Vec<(String, Issue)>,
    /// Files that wait: empty, header only, or still growing.
    pub waiting: Vec<String>,
    /// Raw files that the archive had lost, or held with other bytes, and that are whole again.
    pub mended: Vec<String>,
    /// Files that are no longer there, found now.
    pub gone: Vec<String>,
    /// Runs whose tags changed.
    pub retagged: Vec<String>,
    /// Runs that lack tags, now.
    pub untagged: Vec<String>,
    /// What runs wait for before they can be fitted, now: each mend with all runs that need it.
    pub waiting_for: Vec<Together>,
    /// The name pattern that would tag the most of the runs that lack tags; none where none would tag two.
    pub proposed_pattern: Option<ProposedPattern>,
    /// Runs whose voltage does not go in steps, such as sweeps, now: kept, not fitted, waiting for nothing.
    pub no_steps: Vec<String>,
    /// Tag keys that are neither known nor declared, now.
    pub undeclared_tags: Vec<Together>,
    /// Columns that are probably a response and are not used, now: each mend with all runs that need it.
    pub unused_columns: Vec<Together>,
    /// Climate logs.
    pub logs: LogSummary,
}

/// A tag file, or a statement in it, that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct UnreadableTags {
    /// Where, why, and how to mend it.
    pub issue: Issue,
    /// Runs that it speaks for: those that had tags keep them, the others wait.
    pub runs: usize,
}

impl IngestSummary {
    /// Whether some inputs are not used: refused, waiting, not to be had from the system, tags that cannot be read, or that are
    /// of no run. A file that waits counts as they do, for nothing says whether it waits for an instrument or for a person.
    pub fn left_out_inputs(&self) -> bool {
        let lists = [&self.refused, &self.unread, &self.unread_statements];
        let has_waiting = !self.waiting.is_empty() || !self.unreadable_tags.is_empty();
        lists.iter().any(|list| !list.is_empty()) || has_waiting
    }

    /// Whether the database changed.
    pub fn changed(&self) -> bool {
        let lists = [
            &self.new,
            &self.revised,
            &self.aliases,
            &self.gone,
            &self.retagged,
        ];
        lists.iter().any(|list| !list.is_empty()) || !self.renamed.is_empty() || self.logs.changed()
    }
}
