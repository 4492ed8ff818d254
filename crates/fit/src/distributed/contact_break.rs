//! A foil that is cracked at a place: electrodes that resist more, or less, from there on (`contact-break`).

use ieap_domain::number::fixed;
use ieap_domain::number::probabilities::equation;
use ieap_domain::{Estimate, Issue, Parameter};
use ieap_numerics::student::quantile_95;

use super::described::Break;
use super::policy::{BREAK_PLACES, CRACK_FACTOR, WIDEST_PLACE};
use super::squares::Fitted;

/// A break that was found.
#[derive(Debug, Clone)]
pub(super) struct ContactBreak {
    /// Chance of an answer as large, over all places, without a break.
    pub(super) p: f64,
    /// Fall of the sum of squares, in units of the noise.
    pub(super) gain: f64,
    /// The minimum in (..., logarithm of the factor, place as a share of the length).
    pub(super) fitted: Fitted,
    pub(super) length_cm: f64,
}

impl ContactBreak {
    fn factor(&self) -> (f64, f64) {
        let k = self.fitted.at.len() - 2;
        (self.fitted.at[k], self.half(k))
    }

    fn share(&self) -> (f64, f64) {
        let k = self.fitted.at.len() - 1;
        (self.fitted.at[k], self.half(k))
    }

    /// Whether the resistance changes by more than foils are uneven, its interval allowed for.
    pub(super) fn is_crack(&self) -> bool {
        let (log, half) = self.factor();
        log.abs() - half > CRACK_FACTOR.ln()
    }

    fn half(&self, k: usize) -> f64 {
        quantile_95(self.fitted.freedom) * self.fitted.covariance.error(k)
    }

    /// As the model takes it.
    pub fn of_model(&self) -> Break {
        Break {
            place_cm: self.share().0 * self.length_cm,
            factor: self.factor().0.exp(),
        }
    }

    /// Place and factor as parameters of the fit.
    pub fn parameters(&self) -> [Parameter; 2] {
        let ((share, half), (log, log_half)) = (self.share(), self.factor());
        let mm = 10.0 * self.length_cm;
        let quantile = quantile_95(self.fitted.freedom);
        let place = if half < WIDEST_PLACE {
            Estimate::determined(
                share * mm,
                half / quantile * mm,
                (share - half).max(0.0) * mm,
                (share + half).min(1.0) * mm,
            )
        } else {
            Estimate::not_determined("the readings show a break and not where it is")
        };
        let factor = Estimate::determined(
            log.exp(),
            log.exp() * log_half / quantile,
            (log - log_half).exp(),
            (log + log_half).exp(),
        );
        let named = |key: &str, estimate| Parameter {
            key: format!("contact-break.{key}"),
            estimate,
        };
        [named("place_mm", place), named("resistance_factor", factor)]
    }

    /// The finding in a sentence.
    pub fn issue(&self) -> Issue {
        let [place, factor] = self.parameters().map(|parameter| parameter.estimate);
        let span = |estimate: &Estimate| {
            format!(
                "{} ({} to {})",
                fixed(estimate.value.unwrap_or(f64::NAN), 3),
                fixed(estimate.low_95.unwrap_or(f64::NAN), 3),
                fixed(estimate.high_95.unwrap_or(f64::NAN), 3)
            )
        };
        let place = match place.value {
            Some(_) => format!("from {} mm on", span(&place)),
            None => "from a place on that the readings do not tell".to_owned(),
        };
        let message = format!(
            "contact-break: the electrodes resist {} times as much along the strip {place}, as a cracked foil does; {} over {BREAK_PLACES} places, the sum of squares falls by {} variances of the noise",
            span(&factor),
            equation("p", self.p),
            fixed(self.gain, 0)
        );
        Issue::warning("contact-break", message)
            .mend("look at the foil there; parameters of this fit hold for the electrodes before the break")
    }
}
