//! What is said of a run that is read along the strip, on its page and on those of strips.

use super::wording::readable;
use ieap_domain::words::counted;
use ieap_domain::{Fit, Issue, Quantity, RunRecord};

/// What the fit says of lumped and distributed, as a sentence; empty where it says nothing.
pub fn decision(run: &RunRecord) -> String {
    let Some(issue) = decision_issue(run) else {
        return String::new();
    };
    let mut said = readable(&issue.message);
    if let Some(first) = said.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    said + "."
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
