//! What readings of a voltage do not tell of its edges: levels that one reading each saw, and pauses of the record.

use ieap_domain::number::fixed;
use ieap_domain::{Drive, Issue, range_of};

use super::found::NO_STEPS;
use crate::drive::policy::{BESIDE_PAUSE, HIDING_PAUSE, LEAST_OFF_V, OFF_OF_VOLTAGE};

/// Code of the issue of a pause in which edges would not be seen.
pub const PAUSES: &str = "edges-in-a-pause";

/// Says that most levels of the voltage were seen by a single reading: how long each was held, and how often the voltage
/// changed in between, is then not known.
pub(super) fn alternating(time_s: &[f64], volts: &[f64]) -> Option<Issue> {
    let (low, high) = range_of(volts.iter().copied());
    let off_v = (OFF_OF_VOLTAGE * low.abs().max(high.abs())).max(LEAST_OFF_V);
    let is_off = |a: f64, b: f64| (a - b).abs() > off_v;
    let changes = volts.windows(2).filter(|pair| is_off(pair[0], pair[1])).count();
    let is_alone = |three: &[f64]| {
        let same_side = (three[1] - three[0]) * (three[1] - three[2]) > 0.0;
        same_side && is_off(three[1], three[0]) && is_off(three[1], three[2])
    };
    let alone: Vec<usize> = (1..volts.len().saturating_sub(1))
        .filter(|&k| is_alone(&volts[k - 1..=k + 1]))
        .collect();
    // One level more than there are changes.
    let first = *alone.first().filter(|_| 2 * alone.len() > changes + 1)?;
    let message = format!(
        "the voltage changes at nearly every reading: {} of {} levels were seen by one reading each, first at {} s, between \
         {} and {} V. How long each was held, and what lay between the readings, cannot be told",
        alone.len(),
        changes + 1,
        time_s[first],
        fixed(low, 3),
        fixed(high, 3)
    );
    Some(Issue::warning(NO_STEPS, message).at("column voltage_v").mend(
        "check that this column is the voltage; record it at least three times in every level; it is kept and not fitted",
    ))
}

/// Says where the voltage was not read for so long that edges may be hidden there; `is_open` tells the readings at open circuit.
pub(super) fn pauses(
    (time_s, volts): (&[f64], &[f64]),
    is_open: impl Fn(f64) -> bool,
    drive: &Drive,
) -> Option<Issue> {
    let apart: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let is_pause = |k: usize| {
        let before = &apart[k.saturating_sub(BESIDE_PAUSE)..k];
        let after = &apart[k + 1..(k + 1 + BESIDE_PAUSE).min(apart.len())];
        let mut beside: Vec<f64> = before.iter().chain(after).copied().collect();
        beside.sort_unstable_by(f64::total_cmp);
        let usual_s = beside.get(beside.len() / 2);
        usual_s.is_some_and(|usual_s| apart[k] > HIDING_PAUSE * usual_s)
    };
    // Where it is stated when the voltage changed the pause hides nothing of that edge.
    let is_stated = |k: usize| {
        let within = |at_s: f64| time_s[k] < at_s && at_s <= time_s[k + 1];
        let mut segments = drive.segments.iter();
        segments.any(|segment| segment.edge.is_stated() && within(segment.start_s()))
    };
    let hidden: Vec<usize> = (0..apart.len())
        .filter(|&k| is_pause(k) && !is_stated(k) && !is_open(time_s[k]) && !is_open(time_s[k + 1]))
        .collect();
    let longest = *hidden.iter().max_by(|a, b| apart[**a].total_cmp(&apart[**b]))?;
    let (from_s, to_s) = (time_s[longest], time_s[longest + 1]);
    let changed = |k: &usize| {
        let within = |at_s: f64| time_s[*k] < at_s && at_s <= time_s[k + 1];
        drive.segments.iter().any(|segment| within(segment.start_s()))
    };
    let course = if changed(&longest) {
        format!(
            "it went from {} V to {} V, at a time that is not known",
            fixed(volts[longest], 4),
            fixed(volts[longest + 1], 4)
        )
    } else {
        format!(
            "it is {} V on both sides, and a pulse there would not be seen",
            fixed(volts[longest + 1], 4)
        )
    };
    let others = match hidden.len() - 1 {
        0 => String::new(),
        others => format!(" (the longest pause of {})", others + 1),
    };
    let message =
        format!("between {from_s} s and {to_s} s there are no readings of the voltage{others}: {course}");
    let told = if hidden.iter().any(changed) {
        Issue::warning(PAUSES, message)
    } else {
        Issue::note(PAUSES, message)
    };
    let mend = if changed(&longest) {
        "record the voltage without pauses; a fit looks for the edge between these readings and widens its intervals"
    } else {
        "nothing is to be done if the source kept its level; a fit takes it as kept"
    };
    Some(told.at("column voltage_v").mend(mend))
}
