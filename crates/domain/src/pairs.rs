//! Runs that two instruments recorded, each into a file of its own: how the files find each other.

use crate::string_enum;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

string_enum! {
    /// By what two files are taken for one run.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum PairedBy {
        /// A `[[pair]]` of campaign.toml, or a row of a run sheet that names both.
        Rule = "rule" => "a [[pair]] of campaign.toml, or a row of a run sheet",
        /// The words of their names.
        Names = "names" => "the words of their names",
        /// They overlap in time, and no other file does.
        Times = "times" => "their times",
    }
}

string_enum! {
    /// What a file holds of a run that two instruments recorded.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum HalfKind {
        /// The current, and mostly the voltage.
        Electrical = "electrical" => "a current and no bending",
        /// The bending alone.
        Bending = "bending" => "a bending and no current",
    }
}

impl HalfKind {
    /// What its partner holds.
    pub fn partner(self) -> &'static str {
        match self {
            HalfKind::Electrical => "the bending",
            HalfKind::Bending => "the current",
        }
    }
}

/// Names of files that belong together, `[[pair]]`: what stands in braces is the same in both. Without braces they are two files.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PairNames {
    /// Of the file with the current, relative to the folder of the runs.
    pub current: String,
    /// Of the file with the bending.
    pub bending: String,
}

/// What campaign.toml says of pairs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PairRules {
    /// By what files are paired that no rule speaks of.
    pub by: Vec<PairedBy>,
    /// Rules in the file's order.
    pub named: Vec<PairNames>,
}

impl Default for PairRules {
    fn default() -> PairRules {
        PairRules {
            by: vec![PairedBy::Names, PairedBy::Times],
            named: Vec::new(),
        }
    }
}

/// Two files that are one run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Pair {
    /// Path of the file with the current; the run has its name.
    pub electrical: String,
    /// Path of the file with the bending.
    pub bending: String,
    /// By what they were paired.
    pub by: PairedBy,
}

/// A file that holds half of what a run needs, and whose partner is not there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct LoneHalf {
    /// Its path.
    pub path: String,
    /// What it holds.
    pub holds: HalfKind,
    /// Which partner it waits for, in words.
    pub waits_for: String,
}
