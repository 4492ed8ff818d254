//! What is said of runs that are read along the strip.

pub mod charts;
pub mod view;

use crate::readable::readable;
use ieap_domain::number::significant;
use ieap_domain::words::{capital, counted};
use ieap_domain::{Fit, Issue, Quantity, RunRecord};

/// What the fit says of lumped and distributed, as a sentence; empty where it says nothing.
pub fn decision(run: &RunRecord) -> String {
    decision_issue(run).map_or_else(String::new, |issue| capital(&readable(&issue.message)) + ".")
}

/// Residual over noise of a quantity of a fit.
pub fn residual_ratio(fit: &Fit, quantity: Quantity) -> Option<f64> {
    let noise = fit.noise.iter().find(|noise| noise.quantity == quantity)?;
    let ratio = noise.residual_rms / noise.standard_deviation;
    ratio.is_finite().then_some(ratio)
}

/// The issue of the fit that says it.
pub fn decision_issue(run: &RunRecord) -> Option<&Issue> {
    run.fit.as_ref().and_then(Fit::lumped_or_distributed)
}

/// `curvature at 19 places, voltage at 4 places`
pub fn places(run: &RunRecord) -> String {
    let of = |quantity: Quantity| {
        let count = run.places(quantity);
        let name = quantity.label().to_lowercase();
        (count > 0).then(|| format!("{name} at {}", counted(count, "place")))
    };
    let both = [of(Quantity::Curvature), of(Quantity::Voltage)];
    both.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// A time for a key: three digits, no zeros at the end: `0.02 s`, `860 s`.
pub fn seconds(time_s: f64) -> String {
    let text = significant(time_s, 3);
    let short = if text.contains('.') && !text.contains('·') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    format!("{short} s")
}

/// A place for a key: `5.6 mm`.
pub fn millimetres(position_mm: f64) -> String {
    let rounded = (10.0 * position_mm).round() / 10.0;
    format!("{rounded} mm")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_places_are_short() {
        assert_eq!([0.02, 2.0, 859.99].map(seconds), ["0.02 s", "2 s", "860 s"]);
        assert_eq!([5.600_000_1, 14.0].map(millimetres), ["5.6 mm", "14 mm"]);
    }
}
