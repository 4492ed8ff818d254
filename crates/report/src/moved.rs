//! Numbers that moved: what a report says of each run is kept beside it, so that the next one can say what it said before.

use std::collections::BTreeMap;

use ieap_analysis::zone::seconds;
use serde::{Deserialize, Serialize};

use crate::error::ReportError;
use crate::pages::policy::MOVED_SHOWN_S;

/// File of the report with its numbers, JSON.
pub const FILE: &str = ".numbers";

/// What a report says: by run and parameter.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Numbers(BTreeMap<String, BTreeMap<String, Number>>);

/// A number as a report says it.
#[derive(Debug, Clone, PartialEq)]
pub struct Said {
    /// As it is printed.
    pub text: String,
    /// Value and standard error, in the unit that the parameter's key names; none of what is no value, or has no error.
    pub measured: Option<(f64, f64)>,
}

/// A number as it is printed, and what it was before it moved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Number {
    text: String,
    /// Value and standard error that it is held against: those that stood when it moved last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    stood: Option<(f64, f64)>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    was: Option<Was>,
}

/// What a number was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Was {
    /// As it was printed.
    pub text: String,
    /// When a report said otherwise for the first time, RFC 3339.
    pub until: String,
}

/// The report that stands while the next one is made.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Before {
    /// What it says.
    pub numbers: Numbers,
    /// When the next one is made, RFC 3339.
    pub now: String,
}

impl Numbers {
    /// What a file says.
    ///
    /// # Errors
    /// It is none of ours.
    pub fn read(text: &str) -> Result<Numbers, serde_json::Error> {
        serde_json::from_str(text)
    }

    /// The file.
    ///
    /// # Errors
    /// A fault of the program.
    pub fn text(&self) -> Result<String, ReportError> {
        serde_json::to_string(self).map_err(|source| ReportError::Context {
            page: FILE.to_owned(),
            source,
        })
    }

    /// What a report says, by run and parameter, after the one before.
    pub fn after(before: &Before, said: impl Iterator<Item = (String, Vec<(String, Said)>)>) -> Numbers {
        let Before { numbers, now } = before;
        let of_run = |(run, said): (String, Vec<(String, Said)>)| {
            let own = said.into_iter().map(|(key, said)| {
                let number = numbers.moved_to(&run, &key, said, now);
                (key, number)
            });
            let own = own.collect();
            (run, own)
        };
        Numbers(said.map(of_run).collect())
    }

    /// A number that is said now: with what it was, where it is another by more than its error, or was so not long ago.
    fn moved_to(&self, run: &str, key: &str, said: Said, now: &str) -> Number {
        let Said { text, measured } = said;
        let before = self.0.get(run).and_then(|own| own.get(key));
        let has_moved = |before: &&Number| before.text != text && !before.is_within_error(measured);
        let (was, stood) = match (before, before.filter(has_moved)) {
            (_, Some(before)) => {
                let was = Was {
                    text: before.text.clone(),
                    until: now.to_owned(),
                };
                (Some(was), measured)
            }
            (Some(before), None) => {
                let was = before.was.clone().filter(|was| was.text != text);
                (was, before.stood.or(measured))
            }
            (None, None) => (None, measured),
        };
        let is_recent = |was: &Was| match (seconds(now), seconds(&was.until)) {
            (Some(now), Some(until)) => now - until <= MOVED_SHOWN_S,
            _ => false,
        };
        Number {
            was: was.filter(is_recent),
            stood,
            text,
        }
    }

    /// What a number was before it moved.
    pub fn was(&self, run: &str, key: &str) -> Option<&Was> {
        self.0.get(run)?.get(key)?.was.as_ref()
    }

    /// Every number that moved: run, parameter, what it was and what it is.
    pub fn moved(&self) -> impl Iterator<Item = (&str, &str, &Was, &str)> {
        self.0.iter().flat_map(|(run, own)| {
            own.iter().filter_map(move |(key, number)| {
                Some((
                    run.as_str(),
                    key.as_str(),
                    number.was.as_ref()?,
                    number.text.as_str(),
                ))
            })
        })
    }
}

impl Number {
    /// Whether a value lies within the standard error of the one that stood.
    fn is_within_error(&self, measured: Option<(f64, f64)>) -> bool {
        let both = self.stood.zip(measured);
        both.is_some_and(|((stood, error), (value, _))| (value - stood).abs() <= error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(numbers: &Numbers, text: &str, now: &str) -> Numbers {
        measured(numbers, (text, None), now)
    }

    fn measured(numbers: &Numbers, (text, measured): (&str, Option<(f64, f64)>), now: &str) -> Numbers {
        let said = Said {
            text: text.to_owned(),
            measured,
        };
        let number = numbers.moved_to("a.csv", "lambda_per_s", said, now);
        Numbers([("a.csv".to_owned(), [("lambda_per_s".to_owned(), number)].into())].into())
    }

    #[test]
    fn what_stays_within_its_error_did_not_move_and_many_small_ways_are_one() {
        let day = |day: u32| format!("2026-11-{day}T06:00:00Z");
        let first = measured(
            &Numbers::default(),
            ("3.053 ± 0.018", Some((3.053, 0.018))),
            &day(20),
        );
        let second = measured(&first, ("3.053 ± 0.019", Some((3.053, 0.019))), &day(21));
        assert_eq!(second.moved().count(), 0);
        let third = measured(&second, ("3.067 ± 0.019", Some((3.067, 0.019))), &day(22));
        assert_eq!(third.moved().count(), 0);
        let fourth = measured(&third, ("3.081 ± 0.019", Some((3.081, 0.019))), &day(23));
        assert_eq!(fourth.was("a.csv", "lambda_per_s").unwrap().text, "3.067 ± 0.019");
        // What becomes no value moved.
        let fifth = measured(&third, ("above 1", None), &day(23));
        assert_eq!(fifth.moved().count(), 1);
    }

    #[test]
    fn a_number_that_moved_says_what_it_was_for_a_week() {
        let first = number(&Numbers::default(), "1.0", "2026-11-20T06:00:00Z");
        assert_eq!(first.was("a.csv", "lambda_per_s"), None);
        let second = number(&first, "1.2", "2026-11-21T06:00:00Z");
        let was = Was {
            text: "1.0".to_owned(),
            until: "2026-11-21T06:00:00Z".to_owned(),
        };
        assert_eq!(second.was("a.csv", "lambda_per_s"), Some(&was));
        // A report that says the same goes on saying it, until a week is over.
        let third = number(
            &Numbers::read(&second.text().unwrap()).unwrap(),
            "1.2",
            "2026-11-25T06:00:00Z",
        );
        assert_eq!(third.moved().count(), 1);
        let fourth = number(&third, "1.2", "2026-11-29T06:00:00Z");
        assert_eq!(fourth.moved().count(), 0);
        // What goes back moved as well.
        let back = number(&third, "1.0", "2026-11-26T06:00:00Z");
        assert_eq!(back.was("a.csv", "lambda_per_s").unwrap().text, "1.2");
    }

    #[test]
    fn what_is_no_such_file_is_an_error() {
        assert!(Numbers::read("torn {").is_err());
    }
}
