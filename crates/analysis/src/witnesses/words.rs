//! A contradiction in words: who says what, what the readings are like, and the commands that answer.

use std::collections::BTreeMap;

use ieap_domain::tag::{keys, said, spoken};
use ieap_domain::words::counted;
use ieap_domain::{Contradiction, Tag, TagSource};

use super::doubt::{Doubt, measured};

/// One question about runs of which the same is said.
pub(super) fn question(doubts: &[Doubt]) -> Contradiction {
    let first = &doubts[0];
    let key = &first.said.key;
    let is_of_two = first.said.source != first.other.source;
    let is_other_way = |own: &Doubt| by(own, first.said.source) != first.said.value;
    let is_swapped = is_of_two && key == keys::SAMPLE && doubts.iter().any(is_other_way);
    let (one, other) = (
        who(first.said),
        if is_of_two {
            who(first.other)
        } else {
            "another one"
        },
    );
    let said_of = |tag: &Tag| said(key, &tag.value);
    let (mine, theirs) = (said_of(first.said), bare(first.other));
    let what = if is_swapped {
        let runs = counted(doubts.len(), "run");
        format!(
            "{runs} may be swapped: {one} says {mine} where {other} says {theirs}, and the other way round"
        )
    } else if key == keys::RELATIVE_HUMIDITY_PERCENT && doubts.len() > 1 {
        let (runs, path) = (counted(doubts.len(), "run"), &first.run.path);
        format!(
            "{runs}: {one} says another relative humidity than {other} ({mine} and {theirs} in {path}, ...)"
        )
    } else {
        let runs = if doubts.len() > 1 {
            counted(doubts.len(), "run")
        } else {
            first.run.path.clone()
        };
        format!("{runs}: {one} says {mine}, {other} {theirs}")
    };
    Contradiction {
        key: key.clone(),
        runs: doubts.iter().map(|own| own.run.path.clone()).collect(),
        question: what + &likeness(doubts, is_swapped),
        until: if first.silences() {
            until_answered()
        } else {
            "Until you say that the label is right, what was measured counts".to_owned()
        },
        answers: answers(doubts),
    }
}

/// What holds of runs that wait.
pub(super) fn until_answered() -> String {
    "No result is made from what waits; say which is right".to_owned()
}

/// What a source says of a run.
fn by<'a>(doubt: &Doubt<'a>, source: TagSource) -> &'a str {
    let tag = if doubt.said.source == source {
        doubt.said
    } else {
        doubt.other
    };
    &tag.value
}

/// Who says it.
pub(super) fn who(tag: &Tag) -> &'static str {
    match tag.source {
        TagSource::Hand => "the tag set by hand",
        TagSource::Sidecar => "the sidecar",
        TagSource::Folder => "tags.toml",
        TagSource::RunSheet => "the run sheet",
        TagSource::FileName => "the file name",
        TagSource::Header => "the file's header",
        TagSource::Channel => "the voltage channel",
        TagSource::Column => "its own column",
        TagSource::Ambient => "the ambient log",
        TagSource::Probe => "the probe",
        TagSource::Derived => "the name that `ieap init` read",
        TagSource::EnvironmentDefault => "the environment",
    }
}

/// A value with its unit.
fn bare(tag: &Tag) -> String {
    match spoken(&tag.key).1 {
        "" => tag.value.clone(),
        unit => format!("{}\u{a0}{unit}", tag.value),
    }
}

/// What the readings are like; nothing where one of the two was measured, for that is said already.
fn likeness(doubts: &[Doubt], is_swapped: bool) -> String {
    let first = &doubts[0];
    if measured(first).is_some() {
        return String::new();
    }
    let readings = if doubts.len() > 1 {
        "their readings"
    } else {
        "its readings"
    };
    match first.like {
        None => format!("; {readings} do not tell which is right"),
        Some(tag) if is_swapped => format!("; {readings} are like what {} says", who(tag)),
        Some(tag) => format!("; {readings} are like those of {}", bare(tag)),
    }
}

/// A command for each value that the readings are like; where they do not tell, one for each of the two. What was measured counts
/// without one, so that the command is for the label.
fn answers(doubts: &[Doubt]) -> Vec<String> {
    let mut runs: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for doubt in doubts {
        let values = match doubt.like.filter(|_| doubt.silences()) {
            None if !doubt.silences() => vec![doubt.other],
            Some(tag) => vec![tag],
            None => vec![doubt.said, doubt.other],
        };
        for tag in values {
            runs.entry(&tag.value).or_default().push(&doubt.run.path);
        }
    }
    let runs = runs.into_iter();
    runs.map(|(value, runs)| command(&doubts[0].said.key, value, &runs))
        .collect()
}

/// The command that says that value of the key of runs.
pub(super) fn command(key: &str, value: &str, runs: &[&str]) -> String {
    let runs: Vec<String> = runs.iter().map(|run| format!("\"{run}\"")).collect();
    let plain = value.chars().all(|c| c.is_alphanumeric() || "-_.".contains(c));
    let value = if plain {
        value.to_owned()
    } else {
        format!("\"{value}\"")
    };
    format!("ieap tag {} {key}={value}", runs.join(" "))
}
