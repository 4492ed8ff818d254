//! What the extended model gains, in words.

use crate::domain::HeldOutGain;
use crate::domain::number::fixed;

/// `the error of the current falls from 5.0 to 0.24 % of its range`, or that nothing is clear.
pub fn gained(gain: &HeldOutGain) -> String {
    let percent = |part: f64| fixed(100.0 * part, if part < 0.01 { 2 } else { 1 });
    match gain.best_channel() {
        _ if !gain.is_clear() => "no clear gain".to_owned(),
        None => "the prediction is better, by less than the noise".to_owned(),
        Some((channel, before, after)) => format!(
            "the error of the {channel} falls from {} to {} % of its range",
            percent(before),
            percent(after)
        ),
    }
}
