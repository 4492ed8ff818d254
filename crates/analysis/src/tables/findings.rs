//! What diagnoses found: one row a group of runs.

use super::TableInput;
use ieap_domain::GroupDiagnosis;
use ieap_show::quantities::{Quantity, RUNS};
use ieap_show::{Sheet, Source, SourceOrigin, Table, Value};

/// Digits of a probability, and of a gain.
const DIGITS: i32 = 2;

const GROUP: Quantity = Quantity::plain("group", "Group", "group of runs");
const VERDICT: Quantity = Quantity::plain("verdict", "Verdict", "what is said");
const EFFECTS: Quantity = Quantity::plain("effects", "Accepted effects", "accepted effects");
const SET: Quantity = Quantity::plain("set", "Possible causes", "effects that may be the cause");
const P: Quantity = Quantity::plain(
    "p_misfit",
    "p",
    "probability of such residuals where the base model is right",
);
const Q: Quantity = Quantity::plain("q_misfit", "q", "the same over all groups");
const BEFORE: Quantity = Quantity::plain(
    "residual_before",
    "Residual before",
    "residual of the base model in units of the noise",
);
const AFTER: Quantity = Quantity::plain(
    "residual_after",
    "Residual after",
    "residual of the extended model in units of the noise",
);

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let words = |words: String| (!words.is_empty()).then_some(words);
    let rough = |number: Option<f64>| {
        let number = number.filter(|number| number.is_finite());
        number.map(|number| Value::Rough(number, DIGITS))
    };
    Sheet::<&GroupDiagnosis>::new("findings", "What the base model gets wrong", 1)
        .remarks(
            "Residuals are the root mean square of the whitened residuals, 1 where only noise is left.",
            "No group is diagnosed yet: `ieap diagnose` does it.",
        )
        .called(|found| found.group.clone())
        .made_from(|found| vec![Source::of(SourceOrigin::Diagnosis, &found.group)])
        .column(GROUP, move |found| words(crate::groups::title(&found.group)))
        .column(RUNS, |found| found.runs.len())
        .column(VERDICT, |found| found.verdict.key())
        .column(EFFECTS, move |found| {
            let effects: Vec<&str> = found.effects.iter().map(|own| own.effect.as_str()).collect();
            words(effects.join(", "))
        })
        .column(SET, move |found| words(found.set.join(", ")))
        .column(P, move |found| rough(found.p_misfit))
        .column(Q, move |found| rough(found.q_misfit))
        .column(BEFORE, move |found| {
            rough(found.gain.as_ref().map(|gain| gain.residual_rms_sigma_before))
        })
        .column(AFTER, move |found| {
            rough(found.gain.as_ref().map(|gain| gain.residual_rms_sigma_after))
        })
        .over(input.groups)
}
