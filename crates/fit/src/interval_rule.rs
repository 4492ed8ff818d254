//! One rule for all models: which interval gives a value, which a bound, which only a reason; and reasons that several
//! models give, in words.

use crate::policy::{NEXT_TO_NOTHING_FACTOR, WIDEST_FACTOR};
use ieap_domain::Estimate;

/// Why a positive parameter has no value.
pub(crate) const TOO_WIDE: &str = "its 95 % interval would span more than a factor of five to either side";
/// Why there are no parameters of the bending.
pub(crate) const FLAT: &str = "the curvature does not differ from its noise";
/// The same where the curvature shows more than noise.
pub(crate) const NOT_DESCRIBED: &str = "the curvature changes by far more than its noise, but not in the course that the charge gives it: \
                                        this model does not describe the bending";
/// Why a relaxation rate has an upper bound only.
pub(crate) const TOO_SLOW: &str = "relaxation is too slow for this record: the rate cannot be told from zero";
/// Why a steady-state resistance has a lower bound only.
pub(crate) const NO_STEADY_CURRENT: &str = "the steady current cannot be told from zero";
/// Why it has none.
pub(crate) const NO_HELD_VOLTAGE: &str =
    "no voltage other than zero was held, so no steady current could flow";

/// Whether a logarithm that may be off by `half` to a side (95 %) gives a value.
pub(crate) fn is_narrow_enough(half: f64) -> bool {
    half <= WIDEST_FACTOR.ln()
}

/// A positive parameter from the half-width of its logarithm's interval, downward and upward in parts of it; none where
/// it is too wide.
pub(crate) fn positive(value: f64, relative_error: f64, half: f64, parts: [f64; 2]) -> Option<Estimate> {
    let [down, up] = parts;
    (value.is_finite() && value > 0.0 && is_narrow_enough(half)).then(|| {
        Estimate::determined(
            value,
            value * relative_error,
            value * (-down * half).exp(),
            value * (up * half).exp(),
        )
    })
}

/// A parameter of either sign from the half-width of its interval; none where that contains zero.
pub(crate) fn signed(value: f64, error: f64, half: f64) -> Option<Estimate> {
    (half < value.abs()).then(|| Estimate::determined(value, error, value - half, value + half))
}

/// A parameter that is zero or more, from the ends of its interval: an upper bound where it cannot be told from zero.
pub(crate) fn from_zero(
    value: f64,
    error: f64,
    low: f64,
    high: f64,
    too_small: impl Into<String>,
) -> Estimate {
    if low > 0.0 {
        return Estimate::determined(value, error, low, high);
    }
    let mut estimate = Estimate::below(high, too_small);
    estimate.at_bound = value <= 0.0;
    estimate
}

/// A resistance from the conductance that carries the current of an area, and the ends of its interval: a lower bound
/// where the conductance cannot be told from zero.
pub(crate) fn resistance(
    area_cm2: f64,
    conductance: f64,
    error: f64,
    low: f64,
    high: f64,
    too_small: impl Into<String>,
) -> Estimate {
    if low <= conductance / NEXT_TO_NOTHING_FACTOR {
        let mut estimate = Estimate::above(area_cm2 / high, too_small);
        estimate.at_bound = conductance <= 0.0;
        return estimate;
    }
    let value = area_cm2 / conductance;
    Estimate::determined(
        value,
        value * error / conductance,
        (area_cm2 / high).min(value),
        (area_cm2 / low).max(value),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_interval_gives_a_bound_or_nothing_and_a_narrow_one_a_value() {
        let found = positive(2.0, 0.1, 0.2, [1.0, 1.5]).unwrap();
        assert_eq!(found.value, Some(2.0));
        assert!((found.high_95.unwrap() / 2.0 - 0.3_f64.exp()).abs() < 1e-12);
        assert_eq!(positive(2.0, 1.0, 1.7, [1.0, 1.0]), None);
        assert_eq!(positive(2.0, f64::NAN, f64::NAN, [1.0, 1.0]), None);
        assert_eq!(signed(-1.0, 0.6, 1.2), None);
        assert_eq!(signed(-1.0, 0.4, 0.8).unwrap().high_95, Some(-1.0 + 0.8));
        let slow = from_zero(0.0, 0.1, -0.2, 0.2, TOO_SLOW);
        assert_eq!((slow.value, slow.high_95, slow.at_bound), (None, Some(0.2), true));
        let open = resistance(2.0, 1.0, 0.5, 0.05, 2.0, NO_STEADY_CURRENT);
        assert_eq!((open.value, open.low_95, open.at_bound), (None, Some(1.0), false));
        let known = resistance(2.0, 1.0, 0.1, 0.8, 1.25, NO_STEADY_CURRENT);
        assert_eq!(
            (known.low_95, known.value, known.high_95),
            (Some(1.6), Some(2.0), Some(2.5))
        );
    }
}
