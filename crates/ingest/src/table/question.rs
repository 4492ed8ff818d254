//! What a file leaves open, as one question that a person answers once for all files of its source.

use std::collections::BTreeMap;

use crate::formats::error::quoted;
use ieap_domain::Campaign;

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

/// The keys of questions with the answers that each takes; none where any word may be one.
pub const KEYS: [(&str, &[&str]); 7] = [
    ("clock", &["mm:ss", "hh:mm"]),
    ("decimal", &["point", "comma"]),
    ("thousands", &["none", "comma", "point", "apostrophe", "blank"]),
    ("elapsed", &["s", "ms", "us", "min", "h", "d"]),
    ("humidity", &["percent", "fraction"]),
    ("temperature", &["°C", "°F", "K"]),
    ("start", &["start", "end", "none"]),
];

/// What people answered.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Answers(BTreeMap<String, String>);

impl Answers {
    /// Those of campaign.toml, which were checked when it was read.
    pub fn of_campaign(campaign: &Campaign) -> Answers {
        Answers(campaign.answers.clone())
    }

    /// Whether nothing was answered.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Takes one answer.
    ///
    /// # Errors
    /// No question has that key, or it has no such answer: says which there are.
    pub fn add(&mut self, key: &str, answer: &str) -> Result<(), String> {
        let Some((_, words)) = KEYS.iter().find(|(known, _)| *known == key) else {
            let keys: Vec<&str> = KEYS.iter().map(|(key, _)| *key).collect();
            return Err(format!(
                "no question is called {key:?}; there are {}",
                keys.join(", ")
            ));
        };
        if !words.contains(&answer) {
            return Err(format!(
                "{answer:?} is no answer to {key}; it is one of {}",
                words.join(", ")
            ));
        }
        self.0.insert(key.to_owned(), answer.to_owned());
        Ok(())
    }

    /// The answer to the question of that key.
    pub fn of(&self, key: &str) -> Option<&str> {
        self.0.get(key).map(String::as_str)
    }

    /// These, with `own` before them.
    #[must_use]
    pub fn with(&self, own: &Answers) -> Answers {
        let mut all = self.clone();
        all.0.extend(own.0.clone());
        all
    }

    /// Keys and answers in the order of keys.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(key, answer)| (key.as_str(), answer.as_str()))
    }
}
