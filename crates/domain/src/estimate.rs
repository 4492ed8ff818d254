//! A number with its uncertainty, or the reason why there is none.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is known of a parameter: value, standard error and 95 % interval.
///
/// Three states: determined (`value` set); bounded on one side (`value` none, `low_95` or `high_95` set,
/// `reason` says why); not determined (all none but `reason`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Estimate {
    /// Best value, in the unit that the parameter's key names.
    pub value: Option<f64>,
    /// Standard error, same unit, noise correlation allowed for.
    pub standard_error: Option<f64>,
    /// Lower end of the 95 % interval.
    pub low_95: Option<f64>,
    /// Upper end of the 95 % interval.
    pub high_95: Option<f64>,
    /// Whether the value lies at a limit of the search.
    pub at_bound: bool,
    /// Why there is no value, or only a bound.
    pub reason: Option<String>,
}

impl Estimate {
    /// A determined value.
    pub fn determined(value: f64, standard_error: f64, low_95: f64, high_95: f64) -> Estimate {
        Estimate {
            value: Some(value),
            standard_error: Some(standard_error),
            low_95: Some(low_95),
            high_95: Some(high_95),
            at_bound: false,
            reason: None,
        }
    }

    /// Nothing can be said, for `reason`.
    pub fn not_determined(reason: impl Into<String>) -> Estimate {
        Estimate {
            value: None,
            standard_error: None,
            low_95: None,
            high_95: None,
            at_bound: false,
            reason: Some(reason.into()),
        }
    }

    /// Only an upper bound (95 %) is known, for `reason`.
    pub fn below(high_95: f64, reason: impl Into<String>) -> Estimate {
        Estimate {
            high_95: Some(high_95),
            ..Estimate::not_determined(reason)
        }
    }

    /// The same of the number with the other sign.
    #[must_use]
    pub fn mirrored(self) -> Estimate {
        let minus = |number: Option<f64>| number.map(|number| -number);
        Estimate {
            value: minus(self.value),
            low_95: minus(self.high_95),
            high_95: minus(self.low_95),
            ..self
        }
    }

    /// Only a lower bound (95 %) is known, for `reason`.
    pub fn above(low_95: f64, reason: impl Into<String>) -> Estimate {
        Estimate {
            low_95: Some(low_95),
            ..Estimate::not_determined(reason)
        }
    }
}
