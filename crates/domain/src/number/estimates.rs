//! An estimate as a line of text, with no more digits than its uncertainty carries.

use super::{interval, lower_bound, measured, significant, upper_bound};
use crate::{Estimate, EstimateState};

/// `24.62 ± 0.31`, `> 1.2: reason`, `0.4 to 3.1: reason`, `not determined: reason`.
pub fn in_words(estimate: &Estimate) -> String {
    let bound = match estimate.state() {
        EstimateState::Determined(value) => {
            return match estimate.standard_error {
                Some(error) => measured(value, error),
                None => significant(value, 3),
            };
        }
        EstimateState::Between(low, high) => interval(low, high),
        EstimateState::Above(low) => lower_bound(low),
        EstimateState::Below(high) => upper_bound(high),
        EstimateState::Open => "not determined".to_owned(),
    };
    match estimate.reason.as_deref() {
        Some(reason) if !reason.is_empty() => format!("{bound}: {reason}"),
        _ => bound,
    }
}

/// `24.0 to 25.3`: the ends of a 95 % interval.
pub fn ends(low: f64, high: f64) -> String {
    interval(low, high)
}

/// A standard deviation by itself: two digits.
pub fn spread(standard_deviation: f64) -> String {
    significant(standard_deviation, 2)
}

/// `  (95 %: 24.0 to 25.3)` for a value with an interval, else nothing.
pub fn interval_in_words(estimate: &Estimate) -> String {
    match (estimate.value, estimate.low_95, estimate.high_95) {
        (Some(_), Some(low), Some(high)) => format!("  (95 %: {})", interval(low, high)),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(value: Option<f64>, error: Option<f64>, low: Option<f64>, high: Option<f64>) -> Estimate {
        Estimate {
            value,
            standard_error: error,
            low_95: low,
            high_95: high,
            at_bound: false,
            reason: value.is_none().then(|| "flat".to_owned()),
        }
    }

    #[test]
    fn digits_follow_the_uncertainty() {
        let known = entry(Some(24.618_3), Some(0.312), Some(24.01), Some(25.23));
        assert_eq!(in_words(&known), "24.62 ± 0.31");
        assert_eq!(interval_in_words(&known), "  (95 %: 24.01 to 25.23)");
        assert_eq!(in_words(&entry(None, None, None, Some(1.7557))), "< 1.8: flat");
        assert_eq!(
            in_words(&entry(None, None, Some(2.2814e-10), None)),
            "> 2.2·10⁻¹⁰: flat"
        );
        assert!(in_words(&entry(None, None, Some(1e-9), Some(3e-6))).ends_with(": flat"));
        assert_eq!(in_words(&entry(None, None, None, None)), "not determined: flat");
    }
}
