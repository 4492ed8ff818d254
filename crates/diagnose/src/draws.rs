//! How many times chance is drawn: a number that every door of the program takes between the same ends.

use std::str::FromStr;

/// Fewest draws: a p-value is never below 1 in draws + 1, and 0.01 has to be seen.
const FEWEST: usize = 99;
/// Most draws; more take hours and tell no more.
const MOST: usize = 100_000;

/// Draws of what chance does, from 99 to 100,000.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Draws(usize);

impl Draws {
    /// As many draws.
    ///
    /// # Errors
    /// What is needed, in words, where it is another number.
    pub fn new(draws: usize) -> Result<Draws, String> {
        if (FEWEST..=MOST).contains(&draws) {
            return Ok(Draws(draws));
        }
        Err(format!("{draws}: a whole number from {FEWEST} to {MOST}"))
    }

    /// The number.
    pub fn count(self) -> usize {
        self.0
    }
}

impl FromStr for Draws {
    type Err = String;

    fn from_str(text: &str) -> Result<Draws, String> {
        let draws = text.parse::<usize>();
        draws
            .map_err(|_| format!("{text}: a whole number from {FEWEST} to {MOST}"))
            .and_then(Draws::new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_outside_of_the_ends_are_refused_in_words() {
        assert_eq!("99".parse::<Draws>().unwrap().count(), 99);
        assert_eq!(Draws::new(100_000).unwrap().count(), 100_000);
        for text in ["10", "98", "100001", "-1", "many", ""] {
            let said = text.parse::<Draws>().unwrap_err();
            assert!(said.contains("from 99 to 100000"), "{said}");
        }
    }
}
