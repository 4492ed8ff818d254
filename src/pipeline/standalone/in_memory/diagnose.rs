//! Diagnoses of runs that no campaign holds.

use std::collections::{BTreeMap, BTreeSet};

use super::RunAtHand;
use crate::analysis::false_discovery::judge_together;
use crate::diagnose::DiagnoseOptions;
use crate::domain::tag::keys;
use crate::domain::{Channel, Issue};
use crate::model::effects::{TagAt, summary, tag_places};
use crate::pipeline::PipelineError;
use crate::pipeline::documents::diagnosis::{GroupEntry, group_entry};
use crate::pipeline::findings::diagnose::{DiagnoseChoice, Subject, diagnose_one};
use crate::store::{FitTask, ResultKind};

/// Diagnoses runs of one sample in one condition as one group, as `ieap diagnose --json` states it of a campaign of that
/// group alone.
///
/// # Errors
/// There is no run, two runs have one name or the same readings, or the model is not known.
pub fn diagnose(
    name: &str,
    runs: &[&RunAtHand],
    choice: &DiagnoseChoice,
) -> Result<Result<GroupEntry, Issue>, PipelineError> {
    let options = choice.options_for(DiagnoseOptions::default().model.id)?;
    if let Some(issue) = unfit(runs) {
        return Ok(Err(issue));
    }
    let tasks: Vec<FitTask> = runs.iter().map(|run| run.task.clone()).collect();
    let channels: Vec<Vec<Channel>> = runs.iter().map(|run| run.channels.clone()).collect();
    let subject = Subject {
        kind: ResultKind::Group,
        name: name.to_owned(),
        members: (0..runs.len()).collect(),
        set_apart: None,
        right: Vec::new(),
        tags: tags_that_differ(runs),
    };
    let mut found = [diagnose_one(
        &subject,
        &subject.members,
        &tasks,
        &channels,
        &options,
    )];
    judge_together(&mut found, &summary);
    let [found] = found;
    Ok(Ok(group_entry(found, &[])))
}

/// Why runs are no group.
fn unfit(runs: &[&RunAtHand]) -> Option<Issue> {
    let mut names: BTreeMap<&str, usize> = BTreeMap::new();
    let mut readings: BTreeMap<&str, &str> = BTreeMap::new();
    if runs.is_empty() {
        return Some(Issue::error("no-runs", "there is no run to diagnose").mend("give one or more runs"));
    }
    for (index, run) in runs.iter().enumerate() {
        if names.insert(run.name(), index).is_some() {
            let issue = Issue::error("name-twice", "two runs have this name").at(run.name());
            return Some(issue.mend("give each run a name of its own"));
        }
        if let Some(other) = readings.insert(run.data_hash(), run.name()) {
            let message =
                format!("its readings are those of {other}: the same readings twice would count as two runs");
            return Some(
                Issue::error("same-readings", message)
                    .at(run.name())
                    .mend("leave one of them out"),
            );
        }
    }
    None
}

/// Where each run lies among the values of the tags that differ: who measured, and tags of the caller's own.
fn tags_that_differ(runs: &[&RunAtHand]) -> Vec<Vec<TagAt>> {
    let known = |key: &&str| {
        keys::CONDITIONS.contains(key) || keys::RECORD.contains(key) || keys::OTHERS.contains(key)
    };
    let own = runs.iter().flat_map(|run| run.tags.keys().map(String::as_str));
    let asked: BTreeSet<&str> = own.filter(|key| !known(key)).chain([keys::OPERATOR]).collect();
    let mut places = vec![Vec::new(); runs.len()];
    for key in asked {
        let values: Vec<Option<&str>> = runs
            .iter()
            .map(|run| run.tags.get(key).map(String::as_str))
            .collect();
        for (places, own) in places.iter_mut().zip(tag_places(key, &values)) {
            places.extend(own);
        }
    }
    places
}
