//! What the readings of a run say to a resistance that was given.

use ieap_domain::Issue;
use ieap_domain::number::{interval, measured, significant};
use ieap_numerics::student::two_sided_chance;

use super::estimates::{electrode_resistance, tells_electrodes};
use super::identified::Identified;
use super::input::DistributedInput;
use crate::policy::CONTRADICTED_BELOW;

/// Key of the resistance.
const RESISTANCE: &str = "re_ohm_per_sq";

/// What is to be said of a resistance that was given, beside what the readings alone tell of it (`alone`), where they do.
/// With a break it is their parameters that are stated.
pub(super) fn issue(input: &DistributedInput, alone: Option<&Identified>) -> Option<Issue> {
    let is_broken = alone.is_some_and(|alone| alone.contact_break.is_some());
    let strip = &input.strip;
    let given = strip.electrode_resistance_ohm_per_sq?;
    let probed = strip.probed();
    let read = match probed {
        Some(probed) => format!("{} Ohm/sq", measured(given, probed.error * given)),
        None => format!("{} Ohm/sq, without an error", significant(given, 4)),
    };
    let told = alone
        .filter(|alone| tells_electrodes(alone))
        .map(electrode_resistance);
    let contradiction = told.as_ref().zip(alone).and_then(|(told, alone)| {
        let off = (told.value? / given).ln();
        let own = told.standard_error? / told.value?;
        let error = own.hypot(probed.map_or(0.0, |probed| probed.error));
        let p = two_sided_chance(off / error, alone.electrical.freedom);
        (p < CONTRADICTED_BELOW).then_some(p)
    });
    let issue = match (contradiction, told, is_broken, probed) {
        (Some(p), Some(told), ..) => {
            let end = |end: Option<f64>| end.unwrap_or(f64::NAN);
            let message = format!(
                "R_e was given as {read}; the readings of this run alone ask for {} ({}): they contradict each other (p = {}), and parameters of this fit hold {}",
                significant(end(told.value), 3),
                interval(end(told.low_95), end(told.high_95)),
                significant(p, 2),
                if is_broken {
                    "for the readings"
                } else {
                    "only where the probe is right"
                }
            );
            Issue::warning("probe-contradicted", message).mend(
                "measure the electrodes again; without electrode_resistance_ohm_per_sq R_e is fitted from the readings alone",
            )
        }
        (_, _, true, _) => {
            let message = format!(
                "R_e was given as {read}, which is not used: a probe may have read either side of the break"
            );
            Issue::note("given-uncertainty", message)
        }
        (_, _, false, Some(_)) => {
            let message = format!(
                "R_e was measured as {read}, which is one more reading of it: the intervals hold its error"
            );
            Issue::note("given-uncertainty", message)
        }
        _ => return None,
    };
    Some(issue.at(RESISTANCE))
}
