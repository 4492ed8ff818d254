//! What became of a file of the campaign folder, and why.

use schemars::JsonSchema;
use serde::Serialize;

use super::Issue;

/// What a file became that holds half of a run and whose partner is not there.
pub const HALF_WITHOUT_PARTNER: &str = "half without partner";

/// A word of a file's name with what it was taken for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct WordOfName {
    /// The word as the name has it.
    pub word: String,
    /// `sample`, `voltage_v = -2`, `ignored`, or where the pattern stops.
    pub taken_for: String,
}

/// A tag that is used, with its source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct TagOfFile {
    /// Key.
    pub key: String,
    /// Value.
    pub value: String,
    /// Where it came from: `file name`, `run sheet: runs/plan.xlsx, a`.
    pub from: String,
}

/// A file with what became of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct FileStory {
    /// Path relative to the campaign, with `/`.
    pub path: String,
    /// In words: `run`, `half of a run`, `climate log`, `run sheet`, `refused`, ...
    pub became: String,
    /// The run that it holds or is part of.
    pub run: Option<String>,
    /// The other file of that run, and by what the two were paired; or which one it waits for.
    pub partner: Option<String>,
    /// What read it: id of a format, with the profile where one did.
    pub read_by: Option<String>,
    /// The words of its name; empty where no pattern reads names.
    pub words: Vec<WordOfName>,
    /// The tags of its run.
    pub tags: Vec<TagOfFile>,
    /// Why nothing, or not everything, is made of it: causes before what follows from them, each with its mend.
    pub why: Vec<Issue>,
}
