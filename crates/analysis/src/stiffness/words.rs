//! Is a change of alpha one of stiffness or of coupling? In sentences.

use std::collections::BTreeMap;

use ieap_domain::Estimate;
use ieap_domain::number::fixed;
use ieap_domain::words::counted;

use super::{Cause, Change, SampleRow};
use crate::conditions::Conditions;
use crate::conditions::volts;

/// The answer for all changes in one sentence.
pub fn answer(rows: &[SampleRow]) -> String {
    let changes: Vec<&Change> = rows.iter().filter_map(|row| row.change.as_ref()).collect();
    let count = |cause: Cause| changes.iter().filter(|change| change.cause == cause).count();
    let parts = [
        (count(Cause::Stiffness), "stiffness alone"),
        (count(Cause::Coupling), "coupling alone"),
        (count(Cause::Both), "both"),
    ];
    let told: Vec<String> = (parts.iter().filter(|(count, _)| *count > 0))
        .map(|(count, what)| format!("{what} in {count}"))
        .collect();
    let (same, open) = (count(Cause::None), count(Cause::Open));
    let mut sentence = match (changes.is_empty(), told.is_empty()) {
        (true, _) => {
            return "No sample was measured in two conditions of known humidity at one voltage.".to_owned();
        }
        (_, true) => "Of no change of α is it told whether stiffness or coupling makes it".to_owned(),
        (_, false) => format!("A change of α is one of {}", told.join(", of ")),
    };
    if same > 0 {
        sentence += &format!("; α does not change beyond its uncertainty in {same}");
    }
    if open > 0 && !told.is_empty() {
        sentence += &format!("; it is not told in {open}");
    }
    sentence
        + &format!(
            " (of {} compared with the driest).",
            counted(changes.len(), "condition")
        )
}

/// One sentence for each change, those that are told first, and one for each sample and reason why others are not.
pub fn sentences(table: &Conditions, rows: &[SampleRow]) -> Vec<String> {
    let changes = rows.iter().filter_map(|row| Some((row, row.change.as_ref()?)));
    let mut changes: Vec<(&SampleRow, &Change)> = changes.collect();
    changes.sort_by_key(|(_, change)| matches!(change.cause, Cause::None | Cause::Open));
    let mut said = Vec::new();
    let mut unknown: BTreeMap<(&str, String), usize> = BTreeMap::new();
    for (row, change) in changes {
        match missing(row, change).filter(|_| change.cause == Cause::Open) {
            Some(reason) => *unknown.entry((&row.sample, reason)).or_default() += 1,
            None => said.push(sentence(table, rows, row, change)),
        }
    }
    let unknown = unknown.into_iter().map(|((sample, reason), count)| {
        format!(
            "{sample}: why α changes is not told in {}: {reason}.",
            counted(count, "condition")
        )
    });
    said.into_iter().chain(unknown).collect()
}

fn sentence(table: &Conditions, rows: &[SampleRow], row: &SampleRow, change: &Change) -> String {
    let reference = &rows[change.reference];
    let place = |row: &SampleRow| &table.measured[row.condition];
    let surroundings = |row: &SampleRow| {
        let own = &table.surroundings[place(row).surroundings];
        own.text()
    };
    let name = if row.sample.is_empty() {
        &table.materials[place(row).material]
    } else {
        &row.sample
    };
    let of = if reference.sample == row.sample {
        String::new()
    } else {
        format!(" of {}", reference.sample)
    };
    let whole = format!(
        "{name} in {} at {}: α is {} of that{of} in {}",
        surroundings(row),
        volts(table.voltages_v[place(row).voltage]),
        times(&change.alpha),
        surroundings(reference),
    );
    format!("{whole}; {}.", why(change))
}

/// What the change follows, with the two ratios.
fn why(change: &Change) -> String {
    let (stiffness, coupling) = (&change.ratios.stiffness, &change.ratios.coupling);
    let numbers = format!("E I × {}, μ × {}", times(stiffness), times(coupling));
    let from = &change.ratios.from;
    match change.cause {
        Cause::Stiffness => format!("it is stiffness ({numbers}, by the {from})"),
        Cause::Coupling => format!("it is coupling ({numbers}, by the {from})"),
        Cause::Both => format!("it is both ({numbers}, by the {from})"),
        Cause::None => "it does not change beyond its uncertainty".to_owned(),
        Cause::Open if !change.ratios.agree => {
            format!("why is not told, for modulus and blocking force contradict each other ({numbers})")
        }
        Cause::Open => format!("why is not told: the intervals are too wide ({numbers})"),
    }
}

/// What is not known at all.
fn missing(row: &SampleRow, change: &Change) -> Option<String> {
    if change.alpha.value.is_none() {
        return change.alpha.reason.clone();
    }
    let unknown = change.ratios.stiffness.value.is_none() && change.ratios.coupling.value.is_none();
    let reason = |own: &Estimate| {
        own.reason
            .clone()
            .unwrap_or_else(|| "not known in the driest".to_owned())
    };
    unknown.then(|| {
        format!(
            "{}; {}",
            reason(&row.stiffness_n_m2),
            reason(&row.blocked_n_m_per_c)
        )
    })
}

/// `0.50 (0.46 to 0.54)`
fn times(ratio: &Estimate) -> String {
    match (ratio.value, ratio.low_95, ratio.high_95) {
        (Some(value), Some(low), Some(high)) => {
            let digits = if high - low < 0.02 { 3 } else { 2 };
            format!(
                "{} ({} to {})",
                fixed(value, digits),
                fixed(low, digits),
                fixed(high, digits)
            )
        }
        _ => "an unknown part".to_owned(),
    }
}
