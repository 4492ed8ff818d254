//! What people answered to what files leave open: single words, and what a profile states of a table.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::stated::Stated;
use ieap_domain::Campaign;

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
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answers {
    words: BTreeMap<String, String>,
    table: Option<Arc<Stated>>,
}

impl Answers {
    /// Those of campaign.toml, which were checked when it was read.
    pub fn of_campaign(campaign: &Campaign) -> Answers {
        Answers {
            words: campaign.answers.clone(),
            table: None,
        }
    }

    /// Whether nothing was answered.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty() && self.table.is_none()
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
        self.words.insert(key.to_owned(), answer.to_owned());
        Ok(())
    }

    /// The answer to the question of that key.
    pub fn of(&self, key: &str) -> Option<&str> {
        self.words.get(key).map(String::as_str)
    }

    /// What a profile states of the table as a whole.
    pub fn table(&self) -> Option<&Stated> {
        self.table.as_deref()
    }

    /// Takes what a profile states of the table as a whole.
    pub fn state(&mut self, table: Stated) {
        self.table = Some(Arc::new(table));
    }

    /// These, with `own` before them.
    #[must_use]
    pub fn with(&self, own: &Answers) -> Answers {
        let mut all = self.clone();
        all.words.extend(own.words.clone());
        all.table = own.table.clone().or(all.table);
        all
    }

    /// Keys and answers in the order of keys.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.words
            .iter()
            .map(|(key, answer)| (key.as_str(), answer.as_str()))
    }
}
