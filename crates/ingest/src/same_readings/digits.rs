//! How finely numbers are printed, and when two of them are the same as far as that goes.

use crate::same_readings::policy::{MOST_DIGITS, NUMBERS_ASKED};
use ieap_domain::number::scientific;

pub(super) fn exponent(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

/// How finely numbers are printed: by a step that all have, by a number of digits, or both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Digits {
    pub(super) step: f64,
    pub(super) most: i32,
}

impl Digits {
    pub(super) fn of(values: &[f64]) -> Digits {
        let every = values.len().div_ceil(NUMBERS_ASKED).max(1);
        let mut digits = Digits {
            step: f64::INFINITY,
            most: 1,
        };
        for value in values
            .iter()
            .step_by(every)
            .filter(|value| **value != 0.0 && value.is_finite())
        {
            let printed = scientific(*value, MOST_DIGITS as usize - 1);
            let (mantissa, decade) = printed.split_once('e').unwrap_or((&printed, "0"));
            let shown = mantissa
                .trim_start_matches('-')
                .trim_end_matches('0')
                .trim_end_matches('.');
            let count = shown.chars().filter(char::is_ascii_digit).count() as i32;
            let decade: i32 = decade.parse().unwrap_or(0);
            digits.most = digits.most.max(count);
            digits.step = digits.step.min(10f64.powi(decade - count + 1));
        }
        digits
    }

    pub(super) fn coarser(self, other: Digits) -> Digits {
        Digits {
            step: self.step.max(other.step),
            most: self.most.min(other.most),
        }
    }

    /// What the last printed digit of a number stands for: exports round or cut off.
    pub(super) fn last(self, value: f64) -> f64 {
        let own = if value == 0.0 {
            0.0
        } else {
            10f64.powi(exponent(value) - self.most + 1)
        };
        let step = if self.step.is_finite() { self.step } else { 0.0 };
        1.001 * step.max(own)
    }

    pub(super) fn are_equal(self, one: f64, other: f64) -> bool {
        (one - other).abs() <= self.last(one).max(self.last(other))
    }
}
