//! What a file leaves open, as one question that a person answers once for all files of its source.

use crate::formats::error::quoted;

/// Something that can be read in several ways, with the answers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Question {
    /// What is asked, by the key that an answer has: `clock`.
    pub key: &'static str,
    /// Name of the column that it is asked of; empty where it is asked of all.
    pub column: String,
    /// Line of the row that shows it.
    pub line: usize,
    /// What stands there.
    pub found: String,
    /// Each answer as it is written, with what it would mean.
    pub answers: Vec<(String, String)>,
}

impl std::fmt::Display for Question {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ways: Vec<String> = (self.answers.iter())
            .map(|(answer, meaning)| format!("{meaning} ({} = \"{answer}\")", self.key))
            .collect();
        let of = if self.column.is_empty() {
            String::new()
        } else {
            format!("column {} ", quoted(&self.column))
        };
        write!(f, "{of}{}: {}?", self.found, ways.join(", or "))
    }
}

impl Question {
    /// How one answer settles all files of the source.
    pub fn mend(&self) -> String {
        let answer = self.answers.first().map_or("", |(answer, _)| answer.as_str());
        let key = self.key;
        let of = if self.column.is_empty() {
            String::new()
        } else {
            format!(", as to column {}", quoted(&self.column))
        };
        format!(
            "answer once for all files of this source{of}: ieap profile FILE --answer {key}={answer} --write NAME; or for the whole \
             campaign: {key} = \"{answer}\" under [answers] in campaign.toml (with the answer that is right)"
        )
    }
}
