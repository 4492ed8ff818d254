//! A stated relative humidity in (0, 1]: the percent that its key says, or a fraction of one. The number fits both.

use std::collections::BTreeMap;

use ieap_domain::number::to_digits;
use ieap_domain::tag::{keys, said};
use ieap_domain::words::counted;
use ieap_domain::{Contradiction, RunRecord, Tag, TagSource};

use super::words::{command, until_answered, who};

/// The humidity that holds for a run, where it may be a fraction and nobody answered: what was measured is no statement, and
/// `ieap tag` is the answer.
pub(super) fn doubtful(run: &RunRecord) -> Option<&Tag> {
    let holds = (run.tags.iter()).find(|tag| tag.key == keys::RELATIVE_HUMIDITY_PERCENT)?;
    let is_stated = holds.source.is_stated() && holds.source != TagSource::Hand;
    let number = holds.value.parse::<f64>().ok()?;
    (is_stated && number > 0.0 && number <= 1.0).then_some(holds)
}

/// One question for all runs of which one source states one such number.
pub(super) fn questions(runs: &[&RunRecord]) -> Vec<Contradiction> {
    let mut together: BTreeMap<(TagSource, &str), (&Tag, Vec<&str>)> = BTreeMap::new();
    for run in runs {
        if let Some(tag) = doubtful(run) {
            let same = together.entry((tag.source, &tag.value));
            same.or_insert((tag, Vec::new())).1.push(&run.path);
        }
    }
    (together.into_values())
        .map(|(tag, runs)| question(tag, &runs))
        .collect()
}

fn question(tag: &Tag, runs: &[&str]) -> Contradiction {
    let fraction: f64 = tag.value.parse().unwrap_or(f64::NAN);
    let percent = to_digits(100.0 * fraction, 15).to_string();
    let of = match runs {
        [one] => (*one).to_owned(),
        several => counted(several.len(), "run"),
    };
    Contradiction {
        key: tag.key.clone(),
        runs: runs.iter().map(|run| (*run).to_owned()).collect(),
        question: format!(
            "{of}: {} says {}, or {percent}\u{a0}% if that is a fraction",
            who(tag),
            said(&tag.key, &tag.value)
        ),
        until: until_answered(),
        answers: [&percent, &tag.value]
            .map(|value| command(&tag.key, value, runs))
            .to_vec(),
    }
}
