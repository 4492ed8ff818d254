//! A value of a spec that makes no sense.

use crate::truth::TruthError;

/// A value of the spec that makes no sense.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wrong {
    pub place: String,
    pub found: String,
    pub needed: String,
}

impl Wrong {
    pub fn new(place: &str, found: String, needed: &str) -> Wrong {
        Wrong {
            place: place.to_owned(),
            found,
            needed: needed.to_owned(),
        }
    }

    /// What the truth simulator refuses, in its own words.
    pub fn told(place: &str, error: &TruthError) -> Wrong {
        Wrong::new(place, error.to_string(), "an effect that can act in the run")
    }
}
