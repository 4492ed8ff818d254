//! What does not hold yet. Each of these is tried in every form of the test and must fail: one that holds again goes from
//! the list.

use super::verbs::Verb;

/// Places of a disturbance of a verb at which the program keeps silent.
#[derive(Debug)]
pub struct Known {
    /// Name of the row.
    pub row: &'static str,
    pub verb: Verb,
    /// Each place where it does has one of these in its name. What fits the first is tried in every form.
    pub places: &'static [&'static str],
    /// Why.
    #[expect(
        dead_code,
        reason = "it is printed where the place holds again, and read here"
    )]
    pub reason: &'static str,
}

impl Known {
    /// Whether it is of that row and verb.
    pub fn is_of(&self, row: &str, verb: Verb) -> bool {
        self.row == row && self.verb == verb
    }

    /// Whether it is of that place, too.
    pub fn has(&self, row: &str, verb: Verb, place: &str) -> bool {
        self.is_of(row, verb) && self.places.iter().any(|part| place.contains(part))
    }
}

#[expect(dead_code, reason = "the list is empty")]
const fn known(
    row: &'static str,
    verb: Verb,
    places: &'static [&'static str],
    reason: &'static str,
) -> Known {
    Known {
        row,
        verb,
        places,
        reason,
    }
}

pub static KNOWN: &[Known] = &[];
