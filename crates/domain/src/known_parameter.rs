//! What is known of a parameter before a run is fitted: from a spectrum, a probe, a datasheet.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A parameter of which something is known, and from where.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct KnownParameter {
    /// Key of the parameter, such as `r1_ohm_cm2`; values are in the unit that it names.
    pub parameter: String,
    /// What is known of it.
    pub knowledge: Knowledge,
    /// From where, in words.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub source: Option<String>,
    /// Sample whose runs it holds for; none: all.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub sample: Option<String>,
}

/// What is known of a number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Knowledge {
    /// It is this.
    Exact {
        /// Value.
        value: f64,
    },
    /// It is about this, with that standard error.
    About {
        /// Value.
        value: f64,
        /// Standard error, positive.
        standard_error: f64,
    },
    /// It lies between these.
    Within {
        /// Smallest value.
        low: f64,
        /// Largest value.
        high: f64,
    },
}

/// The key that a name stands for: itself, or the only one that it begins (`r1` of `r1_ohm_cm2`), as `fit["r1"]` in Python takes
/// it; none where it begins none, or several.
pub fn key_named<'k>(name: &str, keys: impl Iterator<Item = &'k str> + Clone) -> Option<&'k str> {
    let is_begun = |key: &&str| key.strip_prefix(name).is_some_and(|rest| rest.starts_with('_'));
    let exact = keys.clone().find(|key| *key == name);
    let mut begun = keys.filter(is_begun);
    exact.or(begun.next().filter(|_| begun.next().is_none()))
}

/// Text that says nothing of a parameter.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "found {found:?}; needed a parameter and what is known of it in the unit that its name ends with: r1_ohm_cm2=120, r1_ohm_cm2=120±6, or lambda_per_s=0.001..0.01"
)]
pub struct NotKnown {
    found: String,
}

impl KnownParameter {
    /// Reads `r1_ohm_cm2=120`, `r1_ohm_cm2=120±6` or `r1_ohm_cm2=50..500`.
    ///
    /// # Errors
    /// It is none of these, or the numbers cannot be: an error that is not positive, limits that are not in order.
    pub fn parse(text: &str) -> Result<KnownParameter, NotKnown> {
        let refused = || NotKnown {
            found: text.to_owned(),
        };
        let (parameter, told) = text.split_once('=').ok_or_else(refused)?;
        let number = |text: &str| {
            text.trim()
                .parse::<f64>()
                .ok()
                .filter(|number| number.is_finite())
        };
        let pair = |separators: &[&str]| {
            let parts = separators.iter().find_map(|separator| told.split_once(separator));
            parts.map(|(first, second)| number(first).zip(number(second)).ok_or_else(refused))
        };
        let knowledge = match (pair(&["±", "+/-", "+-"]), pair(&[".."])) {
            (Some(found), _) => {
                let (value, standard_error) = found?;
                Knowledge::About {
                    value,
                    standard_error,
                }
            }
            (None, Some(found)) => {
                let (low, high) = found?;
                Knowledge::Within { low, high }
            }
            (None, None) => Knowledge::Exact {
                value: number(told).ok_or_else(refused)?,
            },
        };
        let known = KnownParameter {
            parameter: parameter.trim().to_owned(),
            knowledge,
            source: None,
            sample: None,
        };
        let is_one = !known.parameter.is_empty() && known.knowledge.can_be();
        is_one.then_some(known).ok_or_else(refused)
    }

    /// Whether it holds for the runs of that sample.
    pub fn holds_for(&self, sample: Option<&str>) -> bool {
        self.sample.as_deref().is_none_or(|own| Some(own) == sample)
    }
}

impl Knowledge {
    /// Whether such numbers can be.
    pub fn can_be(self) -> bool {
        match self {
            Knowledge::Exact { value } => value.is_finite(),
            Knowledge::About {
                value,
                standard_error,
            } => value.is_finite() && standard_error.is_finite() && standard_error > 0.0,
            Knowledge::Within { low, high } => low.is_finite() && high.is_finite() && low < high,
        }
    }

    /// The smallest number that it names.
    pub fn least(self) -> f64 {
        match self {
            Knowledge::Exact { value } | Knowledge::About { value, .. } => value,
            Knowledge::Within { low, .. } => low,
        }
    }
}

impl fmt::Display for Knowledge {
    /// `120`, `120 ± 6` or `50 to 500`.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Knowledge::Exact { value } => write!(formatter, "{value}"),
            Knowledge::About {
                value,
                standard_error,
            } => write!(formatter, "{value} ± {standard_error}"),
            Knowledge::Within { low, high } => write!(formatter, "{low} to {high}"),
        }
    }
}

impl fmt::Display for KnownParameter {
    /// `r1_ohm_cm2 = 120 ± 6 (spectrum of 3 March)`.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} = {}", self.parameter, self.knowledge)?;
        match &self.source {
            Some(source) => write!(formatter, " ({source})"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stands_for_its_key_or_the_only_one_that_it_begins() {
        let keys = [
            "r1_ohm_cm2",
            "r_parallel_ohm_cm2",
            "r_parallel_ohm_cm2_mean",
            "tau1_s",
        ];
        for (name, key) in [
            ("r1", Some("r1_ohm_cm2")),
            ("r1_ohm", Some("r1_ohm_cm2")),
            ("tau1_s", Some("tau1_s")),
            ("r_parallel_ohm_cm2", Some("r_parallel_ohm_cm2")),
            ("r_parallel", None),
            ("r", None),
            ("tau", None),
            ("", None),
        ] {
            assert_eq!(key_named(name, keys.into_iter()), key, "{name}");
        }
    }

    #[test]
    fn what_is_known_is_read_and_said() {
        for (text, said) in [
            ("r1_ohm_cm2=120", "r1_ohm_cm2 = 120"),
            (" r1_ohm_cm2 = 120 ± 6", "r1_ohm_cm2 = 120 ± 6"),
            ("r1_ohm_cm2=120+-6", "r1_ohm_cm2 = 120 ± 6"),
            ("lambda_per_s=1e-3..0.01", "lambda_per_s = 0.001 to 0.01"),
            ("alpha_per_c_cm=-3..5", "alpha_per_c_cm = -3 to 5"),
        ] {
            assert_eq!(KnownParameter::parse(text).unwrap().to_string(), said);
        }
        for text in [
            "r1", "r1=", "=3", "r1=3±0", "r1=3±-1", "r1=5..2", "r1=nan", "r1=1..x",
        ] {
            let refused = KnownParameter::parse(text).unwrap_err().to_string();
            assert!(refused.contains("r1_ohm_cm2=120±6"), "{text}");
        }
    }
}
