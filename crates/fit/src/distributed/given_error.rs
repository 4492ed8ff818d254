//! A resistance that was given, as it is stated.
//!
//! What a probe measured with an error is one more reading of R_e, and is fitted with the others (`squares`).

use ieap_domain::Estimate;
use ieap_domain::quantiles::NORMAL_95;

/// A resistance that was given, with its error where that is known.
pub fn given_resistance(ohm_per_sq: f64, error_ohm_per_sq: Option<f64>) -> Estimate {
    let estimate = match error_ohm_per_sq {
        Some(error) => {
            let width = (NORMAL_95 * error / ohm_per_sq).exp();
            Estimate::determined(ohm_per_sq, error, ohm_per_sq / width, ohm_per_sq * width)
        }
        None => Estimate::exact(ohm_per_sq),
    };
    Estimate {
        reason: Some("given with the sample, not fitted".to_owned()),
        ..estimate
    }
}
