//! What is said of many files alike is told once, with the files that it is of.

use std::collections::HashMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::domain::Issue;
use crate::ingest::formats::error::ASKED;

/// Stands for the file's name where issues of several files differ by nothing else.
const NAME: &str = "RUN";

/// A file or run with the reasons for its state.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Reasoned {
    /// Path relative to the campaign.
    pub path: String,
    /// Why.
    pub issues: Vec<Issue>,
}

/// Issues with everything that they are said of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Together {
    /// Files or runs, in the order given.
    pub paths: Vec<String>,
    /// What is said of each of them; of several files `RUN` stands for the name.
    pub issues: Vec<Issue>,
}

/// Brings files together of which the same is said, but for their names and the places in them.
pub fn together<'a>(entries: impl IntoIterator<Item = (&'a str, Vec<Issue>)>) -> Vec<Together> {
    let mut told: Vec<(Vec<Issue>, Together)> = Vec::new();
    // Looked up and not searched for: each of thousands of runs may have a mend of its own.
    let mut places: HashMap<Vec<Said>, usize> = HashMap::new();
    for (path, issues) in entries {
        let plain: Vec<Issue> = issues.iter().map(|issue| nameless(issue, path)).collect();
        let place = *places
            .entry(plain.iter().map(said).collect())
            .or_insert(told.len());
        match told.get_mut(place) {
            Some((known, together)) => {
                for (known, own) in known.iter_mut().zip(&plain) {
                    if known.place != own.place {
                        known.place = String::new();
                    }
                }
                together.paths.push(path.to_owned());
                together.issues = known.clone();
            }
            None => {
                let paths = vec![path.to_owned()];
                told.push((plain, Together { paths, issues }));
            }
        }
    }
    told.into_iter().map(|(_, together)| together).collect()
}

fn nameless(issue: &Issue, path: &str) -> Issue {
    Issue {
        message: issue.message.replace(path, NAME),
        mend: issue.mend.replace(path, NAME),
        ..issue.clone()
    }
}

/// What an issue says, wherever it is.
type Said = (String, String, String);

fn said(issue: &Issue) -> Said {
    // A question is one for all files of its source, whatever numbers stand in them.
    let message = if issue.code == ASKED {
        String::new()
    } else {
        issue.message.clone()
    };
    (issue.code.clone(), message, issue.mend.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_by_the_name_and_the_place_alone_is_told_once() {
        let missing = |run: &str, line: u8| {
            Issue::error("tag-missing", "`sample` is missing")
                .mend(format!("ieap tag {run} sample=S1"))
                .at(format!("line {line}"))
        };
        let other = Issue::error("no-area", "no dimensions");
        let found = together([
            ("runs/a.csv", vec![missing("runs/a.csv", 1)]),
            ("runs/c.csv", vec![other.clone()]),
            ("runs/b.csv", vec![missing("runs/b.csv", 2)]),
            ("runs/d.csv", vec![other.clone(), other]),
        ]);
        let paths: Vec<&[String]> = found.iter().map(|told| told.paths.as_slice()).collect();
        assert_eq!(paths.len(), 3, "{found:?}");
        assert_eq!(paths[0], ["runs/a.csv", "runs/b.csv"]);
        let issue = &found[0].issues[0];
        assert_eq!(
            (issue.mend.as_str(), issue.place.as_str()),
            ("ieap tag RUN sample=S1", "")
        );
        let alone = together([("runs/a.csv", vec![missing("runs/a.csv", 1)])]);
        assert_eq!(alone[0].issues, [missing("runs/a.csv", 1)]);
    }
}
