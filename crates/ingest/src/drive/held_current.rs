//! Records of a constant current: the voltage answers, and is told as that and not as a sweep.

use super::{FoundDrive, NO_STEPS};
use crate::drive::policy::{HELD_CURRENT_SHARE, HELD_WITHIN};
use ieap_domain::number::significant;
use ieap_domain::{Channel, Drive, Issue, Quantity};
use ieap_numerics::robust::upper_median;

/// The same, with one sentence about a voltage that goes in no steps because the current is held.
pub(super) fn told(mut found: FoundDrive, channels: &[Channel]) -> FoundDrive {
    // The source of a moving voltage drives a current; where none flows the circuit is open.
    if found.drive.as_ref().is_some_and(Drive::moves) && held_a(channels).is_some() {
        found.drive = None;
        found.issues = vec![Issue::note(NO_STEPS, "").at("column voltage_v")];
    }
    let no_steps = found.issues.iter_mut().find(|issue| issue.code == NO_STEPS);
    if let (Some(issue), Some(current_a)) = (no_steps, held_a(channels)) {
        let message = format!(
            "the current is held at {} A and the voltage follows from it: a record of a constant current, no steps of the voltage",
            significant(current_a, 4)
        );
        *issue = Issue::note(NO_STEPS, message)
            .at(issue.place.clone())
            .mend("nothing is to be done; it is kept and not fitted");
    }
    found
}

/// The current that is held throughout, A; none where there is none.
fn held_a(channels: &[Channel]) -> Option<f64> {
    let current = channels
        .iter()
        .find(|channel| channel.is_whole(Quantity::Current))?;
    let (_, values) = current.included();
    let count = values.len();
    let median = upper_median(&mut values.to_vec())?;
    let near = values
        .iter()
        .filter(|value| (*value - median).abs() <= HELD_WITHIN * median.abs());
    let is_none = values.iter().all(|value| *value == 0.0);
    ((median != 0.0 || is_none) && near.count() as f64 >= HELD_CURRENT_SHARE * count as f64).then_some(median)
}
