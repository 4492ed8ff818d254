//! What the journal of a campaign holds: one entry for each thing that no file says.

use serde::{Deserialize, Serialize};

use crate::HandTag;
use ieap_domain::{AskedFit, RunKind, RunWord, Tag};

/// Something that was said or decided, and that the files of a campaign do not hold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "kebab-case")]
pub enum Entry {
    /// Runs were read from files, under these names.
    Read {
        /// What is measured.
        kind: RunKind,
        /// Format id of the reader.
        reader: String,
        /// The files, in order.
        files: Vec<NamedBytes>,
        /// The runs, in the order of the tables in the files.
        runs: Vec<NamedRun>,
    },
    /// A climate log was read from a file.
    Log {
        /// The file.
        file: NamedBytes,
        /// Revision of the log.
        revision: i64,
    },
    /// A file was found to hold the bytes of another.
    Alias {
        /// The file.
        file: NamedBytes,
    },
    /// Files were found under other names, and what they hold is named after them: all that one look found, at once, for names
    /// may have been exchanged.
    Moved {
        /// The files.
        files: Vec<MovedFile>,
        /// Names of runs before and now.
        runs: Vec<(String, String)>,
    },
    /// As an earlier version of the program said it of one file.
    Renamed {
        /// Its name before.
        old: String,
        /// Its file now.
        file: NamedBytes,
    },
    /// A file was no longer there.
    Gone {
        /// Its path.
        path: String,
        /// What files beside it and run sheets stated of its runs: they may be gone with it.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        tags: Vec<Tag>,
    },
    /// A tag was set by hand, or taken back.
    Tag(HandTag),
    /// A run was taken out of all results, or put back.
    Word(RunWord),
    /// How a run is fitted was asked for by hand; open: as campaign.toml says from now on.
    Asked {
        /// The run's name.
        run: String,
        /// What was asked for.
        asked: AskedFit,
    },
    /// An alarm was told.
    Told(ToldAlarm),
    /// The command of an alarm ended.
    Command {
        /// Id of the alarm.
        id: String,
        /// How it ended.
        status: String,
    },
    /// Words may be lost: a rebuilding did not find lines of the journal.
    Missed {
        /// Which, in words.
        lost: String,
    },
    /// A person looked after the words that may be lost.
    Answered {
        /// What came of it.
        why: String,
        /// Who looked.
        by: String,
    },
}

/// Bytes of the archive under the name that they came in with.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamedBytes {
    /// Path of the file, relative to the campaign, with `/`.
    pub path: String,
    /// BLAKE3 of the bytes, hexadecimal.
    pub hash: String,
}

/// A file whose bytes lie under another name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MovedFile {
    /// Its path before.
    pub old: String,
    /// What it is now.
    pub now: NamedBytes,
}

/// A run by its name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamedRun {
    /// The run's name.
    pub name: String,
    /// Which revision of it was read.
    pub revision: i64,
    /// Whether it is the measurement that had this name before, with other bytes; else another one lay under the name.
    #[serde(default = "said_by_name")]
    pub continues: bool,
}

/// An earlier version of the program held what has the same name for the same measurement.
fn said_by_name() -> bool {
    true
}

/// An alarm as it was told.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ToldAlarm {
    /// Id.
    pub id: String,
    /// Sample.
    pub sample: String,
    /// Stored key of the parameter.
    pub parameter: String,
    /// Chart that showed it.
    pub chart: String,
    /// Run with which it began.
    pub run: String,
    /// What was said.
    pub message: String,
}

/// An entry as it stands in the journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Its number: each line has the next one.
    pub n: u64,
    /// When it was written, RFC 3339 UTC.
    pub at: String,
    /// What it says.
    pub entry: Entry,
    /// The measurement that a word is about. None in other lines, and in those that an earlier version of the program wrote:
    /// there it is the run that had the name then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Checksum of the line before it. None in the first line, and in those that an earlier version of the program wrote.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after: Option<String>,
    /// The line as it stands, with its checksum and without its line feed.
    #[serde(skip)]
    pub text: String,
}

impl Entry {
    /// What it says, in the word under which it is stored.
    pub fn what(&self) -> &'static str {
        match self {
            Entry::Read { .. } => "read",
            Entry::Log { .. } => "log",
            Entry::Alias { .. } => "alias",
            Entry::Moved { .. } => "moved",
            Entry::Renamed { .. } => "renamed",
            Entry::Gone { .. } => "gone",
            Entry::Tag(_) => "tag",
            Entry::Word(_) => "word",
            Entry::Asked { .. } => "asked",
            Entry::Told(_) => "told",
            Entry::Command { .. } => "command",
            Entry::Missed { .. } => "missed",
            Entry::Answered { .. } => "answered",
        }
    }

    /// The run that a word is about, by the name that it had then, or the alarm.
    pub fn name(&self) -> Option<&str> {
        match self {
            Entry::Tag(tag) => Some(&tag.run_path),
            Entry::Word(word) => Some(&word.run_path),
            Entry::Asked { run, .. } => Some(run),
            Entry::Told(alarm) => Some(&alarm.id),
            Entry::Command { id, .. } => Some(id),
            _ => None,
        }
    }

    /// Whether it is about a run.
    pub fn is_of_run(&self) -> bool {
        matches!(self, Entry::Tag(_) | Entry::Word(_) | Entry::Asked { .. })
    }

    /// What it says, for a person who has to tell two entries from each other.
    pub fn in_words(&self) -> String {
        match self {
            Entry::Read { runs, .. } => {
                let names: Vec<&str> = runs.iter().map(|run| run.name.as_str()).collect();
                format!("{} read", names.join(", "))
            }
            Entry::Log { file, .. } => format!("{} read", file.path),
            Entry::Alias { file } => format!("{} known as a copy", file.path),
            Entry::Moved { files, .. } => {
                let moved = files
                    .iter()
                    .map(|file| format!("{} renamed to {}", file.old, file.now.path));
                moved.collect::<Vec<_>>().join(", ")
            }
            Entry::Renamed { old, file } => format!("{old} renamed to {}", file.path),
            Entry::Gone { path, .. } => format!("{path} deleted"),
            Entry::Tag(tag) => {
                let value = tag.value.as_deref().unwrap_or("");
                format!("{} tagged {}={value} by {}", tag.run_path, tag.key, tag.set_by)
            }
            Entry::Word(word) => {
                let said = if word.drops { "dropped" } else { "put back" };
                let why = word
                    .why
                    .as_deref()
                    .map_or(String::new(), |why| format!(" ({why})"));
                format!("{} {said} by {}{why}", word.run_path, word.said_by)
            }
            Entry::Asked { run, .. } => format!("how {run} is fitted"),
            Entry::Told(alarm) => format!("alarm {} told", alarm.id),
            Entry::Command { id, .. } => format!("command of alarm {id} ended"),
            Entry::Missed { lost } => format!("words may be lost: {lost}"),
            Entry::Answered { why, by } => format!("lost words answered by {by} ({why})"),
        }
    }
}

/// Where a course ends.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct End {
    /// Number of its last line; 0 where there is none.
    pub n: u64,
    /// Its checksum; none where there is no line.
    pub sum: Option<String>,
}

impl End {
    /// That which a line makes.
    pub fn after(line: &Line) -> End {
        End {
            n: line.n,
            sum: Some(line.sum().to_owned()),
        }
    }
}
