//! What the right name would be worth: the ceiling beside which a benchmark sets the gain of a search.

use ieap_model::ModelChoice;

use crate::cause::proof::held_out;
use crate::extended::fits::extend;
use crate::fitting::without_outliers::with_base;
use crate::readings::group::{RunGroup, RunInput};

/// Fall of the deviance of held-out readings where the effects of `choice` are known to be the cause and only their
/// shapes and strengths are fitted; none where they cannot act in these runs.
pub fn known_cause_gain(runs: &[RunInput], choice: &ModelChoice) -> Option<f64> {
    let raw = RunGroup::new(runs);
    with_base(&raw, choice.base, |group, base| {
        let extended = extend(group, base.clone(), choice)?;
        let before = held_out::parts(&base, group);
        let after = held_out::parts(&extended, group);
        let falls = before.iter().zip(&after).map(|(b, a)| b.deviance - a.deviance);
        Some(falls.sum())
    })?
}
