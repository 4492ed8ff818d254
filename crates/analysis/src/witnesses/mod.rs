//! The court of witnesses: what run sheet, file name, folder, sidecar, head of the file and readings say of a run's sample,
//! environment, voltage and humidity. Where they contradict each other it is one question for all runs that it is asked of,
//! with what their readings are like; until a person answers, these runs speak in no result. A humidity that was logged is no
//! guess that waits: the run speaks with it, and the label is asked. A source whose
//! humidities may be percent or fractions is asked once, and its runs wait too.
//!
//! Whether two sources contradict each other is decided where tags are chosen, and stands with the run as a warning
//! ([`DISAGREEMENT`](ieap_domain::tag::DISAGREEMENT), [`NAMES_CONTRADICT`](ieap_domain::tag::NAMES_CONTRADICT)); here only which of these a result could hang on.

mod doubt;
mod fraction;
mod likeness;
mod words;

use std::collections::{BTreeMap, HashSet};

use ieap_domain::tag::keys;
use ieap_domain::{Campaign, Contradiction, RunRecord, Standing};

use doubt::{Doubt, KEYS, doubt, measured};
use fraction::Fractions;
use likeness::Witnesses;

/// What is to be asked of the runs among `runs` that speak or wait for an answer, one question for all runs that it is the same
/// for.
pub fn questions<'a>(
    runs: impl IntoIterator<Item = &'a RunRecord>,
    campaign: &Campaign,
) -> Vec<Contradiction> {
    let all: Vec<&RunRecord> = runs.into_iter().collect();
    let mut together: BTreeMap<Vec<String>, Vec<Doubt>> = BTreeMap::new();
    for doubt in doubts(&all, campaign) {
        together.entry(asked_as(&doubt)).or_default().push(doubt);
    }
    let of_two = together.values().map(|doubts| words::question(doubts));
    of_two
        .chain(Fractions::of(&all).questions(&asked(&all)))
        .collect()
}

/// Runs that wait for an answer: place among `runs`, who says what, and how to answer.
pub(crate) fn contradicted(runs: &[&RunRecord], campaign: &Campaign) -> BTreeMap<usize, (String, String)> {
    let places: BTreeMap<&str, usize> = runs
        .iter()
        .enumerate()
        .map(|(at, run)| (&run.path[..], at))
        .collect();
    let mut found: BTreeMap<usize, Vec<Contradiction>> = BTreeMap::new();
    for doubt in doubts(runs, campaign).into_iter().filter(Doubt::silences) {
        let at = places[&doubt.run.path[..]];
        found.entry(at).or_default().push(words::question(&[doubt]));
    }
    let fractions = Fractions::of(runs);
    for run in asked(runs) {
        for question in fractions.questions(&[run]) {
            found.entry(places[&run.path[..]]).or_default().push(question);
        }
    }
    let together = |questions: Vec<Contradiction>| {
        let joined = |of: &dyn Fn(&Contradiction) -> String| {
            let all: Vec<String> = questions.iter().map(of).collect();
            all.join("; ")
        };
        let reason = joined(&|own| own.question.clone());
        (reason, joined(&|own| own.answers.join(" or ")))
    };
    let found = found.into_iter();
    found.map(|(at, questions)| (at, together(questions))).collect()
}

/// What is the same in one question: the key, whom the readings are like, who says it, and what, whichever says which;
/// humidities, of which no two are the same, by who says them.
fn asked_as(doubt: &Doubt) -> Vec<String> {
    let mut sources = [doubt.said, doubt.other].map(|tag| tag.source.key().to_owned());
    sources.sort();
    let mut values = [doubt.said, doubt.other].map(|tag| tag.value.clone());
    values.sort();
    let values = values
        .into_iter()
        .filter(|_| doubt.said.key != keys::RELATIVE_HUMIDITY_PERCENT);
    let like = doubt.like.map_or("", |tag| tag.source.key());
    [doubt.said.key.clone(), like.to_owned()]
        .into_iter()
        .chain(sources)
        .chain(values)
        .collect()
}

/// Runs that speak or wait for an answer.
fn asked<'a>(runs: &[&'a RunRecord]) -> Vec<&'a RunRecord> {
    let is_asked =
        |run: &&RunRecord| matches!(run.standing, Standing::Speaks | Standing::Contradicted { .. });
    runs.iter().copied().filter(is_asked).collect()
}

/// Every contradiction of every run, with what its readings are like.
fn doubts<'a>(runs: &[&'a RunRecord], campaign: &Campaign) -> Vec<Doubt<'a>> {
    let of_run = |run: &'a RunRecord| KEYS.iter().filter_map(move |key| doubt(run, key));
    let mut found: Vec<Doubt> = asked(runs).into_iter().flat_map(of_run).collect();
    if found.is_empty() {
        return found;
    }
    let silenced = found.iter().filter(|doubt| doubt.silences());
    let in_doubt: HashSet<&str> = silenced.map(|doubt| &doubt.run.path[..]).collect();
    let fractions = Fractions::of(runs);
    let is_witness = |run: &&&RunRecord| {
        let waits = matches!(run.standing, Standing::Contradicted { .. });
        (run.standing.speaks() || waits)
            && !in_doubt.contains(&run.path[..])
            && fractions.doubtful(run).is_none()
    };
    let witnesses = Witnesses::of(runs.iter().filter(is_witness).copied().collect(), campaign);
    for doubt in &mut found {
        doubt.like = measured(doubt).or_else(|| witnesses.like(doubt));
    }
    found
}

#[cfg(test)]
mod tests;
