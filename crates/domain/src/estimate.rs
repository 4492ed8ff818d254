//! A number with its uncertainty, or the reason why there is none.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is known of a parameter: value, standard error and 95 % interval.
///
/// Three states: determined (`value` set); bounded (`value` none, `low_95` or `high_95` or both set,
/// `reason` says why); not determined (all none but `reason`).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
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

/// What an [`Estimate`] says, for whoever says it on: no state can be forgotten.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EstimateState {
    /// A value.
    Determined(f64),
    /// No value, but an interval.
    Between(f64, f64),
    /// A lower bound only.
    Above(f64),
    /// An upper bound only.
    Below(f64),
    /// Nothing.
    Open,
}

impl Estimate {
    /// What it says; of a value the errors stand beside.
    pub fn state(&self) -> EstimateState {
        match (self.value, self.low_95, self.high_95) {
            (Some(value), ..) => EstimateState::Determined(value),
            (None, Some(low), Some(high)) => EstimateState::Between(low, high),
            (None, Some(low), None) => EstimateState::Above(low),
            (None, None, Some(high)) => EstimateState::Below(high),
            (None, None, None) => EstimateState::Open,
        }
    }

    /// A determined value.
    pub fn determined(value: f64, standard_error: f64, low_95: f64, high_95: f64) -> Estimate {
        Estimate {
            standard_error: Some(standard_error),
            low_95: Some(low_95),
            high_95: Some(high_95),
            ..Estimate::exact(value)
        }
    }

    /// A value of which no error is known.
    pub fn exact(value: f64) -> Estimate {
        Estimate {
            value: Some(value),
            ..Estimate::default()
        }
    }

    /// Nothing can be said, for `reason`.
    pub fn not_determined(reason: impl Into<String>) -> Estimate {
        Estimate {
            reason: Some(reason.into()),
            ..Estimate::default()
        }
    }

    /// Only an upper bound (95 %) is known, for `reason`.
    pub fn below(high_95: f64, reason: impl Into<String>) -> Estimate {
        Estimate {
            high_95: Some(high_95),
            ..Estimate::not_determined(reason)
        }
    }

    /// The same of the number times `factor`, as in another unit; a negative one exchanges the ends.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Estimate {
        let times = |number: Option<f64>| number.map(|number| number * factor);
        let (low, high) = if factor < 0.0 {
            (self.high_95, self.low_95)
        } else {
            (self.low_95, self.high_95)
        };
        Estimate {
            value: times(self.value),
            standard_error: self.standard_error.map(|error| error * factor.abs()),
            low_95: times(low),
            high_95: times(high),
            ..self.clone()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_state_is_told_apart() {
        let between = Estimate {
            low_95: Some(1.0),
            ..Estimate::below(3.0, "flat")
        };
        let stated = [
            Estimate::determined(2.0, 0.1, 1.8, 2.2),
            between,
            Estimate::above(1.0, "flat"),
            Estimate::below(3.0, "flat"),
            Estimate::not_determined("flat"),
        ];
        let states = [
            EstimateState::Determined(2.0),
            EstimateState::Between(1.0, 3.0),
            EstimateState::Above(1.0),
            EstimateState::Below(3.0),
            EstimateState::Open,
        ];
        assert_eq!(stated.map(|estimate| estimate.state()), states);
    }

    #[test]
    fn a_negative_factor_exchanges_the_ends_and_keeps_the_error_positive() {
        let scaled = Estimate::determined(2.0, 0.5, 1.0, 4.0).scaled(-2.0);
        assert_eq!(scaled, Estimate::determined(-4.0, 1.0, -8.0, -2.0));
        assert_eq!(
            Estimate::below(3.0, "flat").scaled(-1.0),
            Estimate::above(-3.0, "flat")
        );
    }
}
