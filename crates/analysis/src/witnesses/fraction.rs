//! A stated relative humidity in (0, 1]: the percent that its key says, or a fraction of one. The number fits both; in what holds
//! no water it is the percent.

use std::collections::BTreeMap;

use ieap_domain::number::to_digits;
use ieap_domain::surroundings::is_waterless;
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
    let is_waterless = run.tag(keys::ENVIRONMENT).is_some_and(is_waterless);
    (is_stated && !is_waterless && number > 0.0 && number <= 1.0).then_some(holds)
}

/// Runs by what is stated of them, with the tag that does.
type Stated<'a> = BTreeMap<&'a str, (&'a Tag, Vec<&'a str>)>;

/// One question for all runs of which one source states such numbers: who writes fractions writes them throughout.
pub(super) fn questions(runs: &[&RunRecord]) -> Vec<Contradiction> {
    let mut of_sources: BTreeMap<TagSource, Stated> = BTreeMap::new();
    for run in runs {
        if let Some(tag) = doubtful(run) {
            let of_source = of_sources.entry(tag.source).or_default();
            let same = of_source.entry(&tag.value);
            same.or_insert((tag, Vec::new())).1.push(&run.path);
        }
    }
    of_sources.values().filter_map(question).collect()
}

fn question(stated: &Stated) -> Option<Contradiction> {
    let ((_, (tag, _)), (_, (last, _))) = (stated.first_key_value()?, stated.last_key_value()?);
    let runs: Vec<&str> = stated
        .values()
        .flat_map(|(_, runs)| runs.iter().copied())
        .collect();
    let of = match runs[..] {
        [one] => one.to_owned(),
        _ => counted(runs.len(), "run"),
    };
    let (says, means) = if stated.len() == 1 {
        (said(&tag.key, &tag.value), percent(tag))
    } else {
        let to = said(&last.key, &last.value);
        let from = said(&tag.key, &tag.value);
        let from = from.trim_end_matches(['\u{a0}', '%']);
        let number = to.rsplit_once(' ').map_or(&to[..], |(_, number)| number);
        (
            format!("{from} to {number}"),
            format!("{} to {}", percent(tag), percent(last)),
        )
    };
    let answer = |value: &dyn Fn(&Tag) -> String| -> String {
        let each = stated
            .values()
            .map(|(tag, runs)| command(&tag.key, &value(tag), runs));
        each.collect::<Vec<_>>().join(" && ")
    };
    Some(Contradiction {
        key: tag.key.clone(),
        question: format!(
            "{of}: {} says {says}, or {means}\u{a0}% if that is a fraction",
            who(tag)
        ),
        until: until_answered(),
        answers: vec![answer(&percent), answer(&|tag: &Tag| tag.value.clone())],
        runs: runs.into_iter().map(str::to_owned).collect(),
    })
}

/// The percent where the number is a fraction.
fn percent(tag: &Tag) -> String {
    let fraction: f64 = tag.value.parse().unwrap_or(f64::NAN);
    to_digits(100.0 * fraction, 15).to_string()
}
