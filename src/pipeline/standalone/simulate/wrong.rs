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

    /// Refuses the first of these numbers, each with its place, that is not as it has to be.
    pub fn unless_all<P: AsRef<str>>(
        numbers: impl IntoIterator<Item = (P, f64)>,
        holds: impl Fn(f64) -> bool,
        needed: &str,
    ) -> Result<(), Wrong> {
        match numbers.into_iter().find(|(_, number)| !holds(*number)) {
            Some((place, number)) => Err(Wrong::new(place.as_ref(), number.to_string(), needed)),
            None => Ok(()),
        }
    }

    /// What the truth simulator refuses, in its own words.
    pub fn told(place: &str, error: &TruthError) -> Wrong {
        Wrong::new(place, error.to_string(), "an effect that can act in the run")
    }
}

/// Whether a number is above 0, and one.
pub(super) fn above_zero(number: f64) -> bool {
    number.is_finite() && number > 0.0
}

/// Whether a number is 0 or above, and one.
pub(super) fn from_zero(number: f64) -> bool {
    number.is_finite() && number >= 0.0
}
