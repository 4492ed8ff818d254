//! Numbers of the climate as they are said.

use crate::domain::ClimateQuantity;
use crate::domain::number::fixed;

/// A number of messages: hundredths of the air; pressures and traces, which span decades, to their digits.
pub(super) fn shown(quantity: ClimateQuantity, value: f64) -> String {
    if quantity.is_of_air() {
        fixed(value, 2)
    } else {
        five_digits(value).to_string()
    }
}

/// A number to five digits: more than a gauge or a probe has.
pub(super) fn five_digits(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let scale = 10f64.powi(4 - value.abs().log10().floor() as i32);
    (value * scale).round() / scale
}
