//! What is diagnosed: every group of runs, and every run alone.

use std::collections::BTreeMap;

use crate::analysis::groups::groups;
use crate::domain::{Issue, RunRecord};
use crate::model::effects::TagAt;
use crate::pipeline::Context;
use crate::pipeline::campaign::group_tags::group_tags;
use crate::store::{FitTask, ResultKind};

/// A group of runs, or one run alone.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Subject {
    pub(crate) kind: ResultKind,
    /// Name of the group or the run.
    pub(crate) name: String,
    /// Indices of its tasks; never empty.
    pub(crate) members: Vec<usize>,
    /// Why it is set apart, where it is.
    pub(crate) set_apart: Option<Issue>,
    /// Those of its tasks of which a person said that the readings are right.
    pub(crate) right: Vec<usize>,
    /// Where each task lies among the values of tags that differ, in the order of the tasks.
    pub(crate) tags: Vec<Vec<TagAt>>,
}

/// All groups of the runs that are diagnosed, then all of these runs; and the keys of `group_by` that no run carries.
pub(super) fn subjects(
    context: &Context,
    tasks: &[FitTask],
    runs: &[RunRecord],
) -> (Vec<Subject>, Vec<String>) {
    let places: BTreeMap<i64, usize> = tasks
        .iter()
        .enumerate()
        .map(|(place, task)| (task.run_id, place))
        .collect();
    let group_by = &context.campaign.group_by;
    let ready = |run: &RunRecord| places.contains_key(&run.id);
    let tasks_of = |members: &[usize], wanted: &dyn Fn(&RunRecord) -> bool| -> Vec<usize> {
        let members = members
            .iter()
            .map(|&index| &runs[index])
            .filter(|run| wanted(run));
        members.filter_map(|run| places.get(&run.id).copied()).collect()
    };
    let tags_of = |members: &[usize]| -> Vec<Vec<TagAt>> {
        let members = members.iter().map(|&index| &runs[index]).filter(|run| ready(run));
        group_tags(&members.collect::<Vec<_>>(), &context.campaign.extra_tags)
    };
    let mut found: Vec<Subject> = groups(runs, group_by, &ready)
        .into_iter()
        .map(|group| Subject {
            kind: ResultKind::Group,
            name: group.name,
            members: tasks_of(&group.runs, &|_| true),
            right: tasks_of(&group.runs, &|run| run.standing.is_vouched()),
            tags: tags_of(&group.runs),
            set_apart: group.set_apart,
        })
        .collect();
    let alone: Vec<Subject> = found
        .iter()
        .flat_map(|group| {
            group.members.iter().map(|&member| Subject {
                kind: ResultKind::Run,
                name: tasks[member].path.clone(),
                members: vec![member],
                // A run alone is held against no others.
                right: Vec::new(),
                tags: vec![Vec::new()],
                set_apart: group.set_apart.clone(),
            })
        })
        .collect();
    found.extend(alone);
    let unknown = |key: &&String| !runs.is_empty() && runs.iter().all(|run| run.tag(key).is_none());
    (found, group_by.iter().filter(unknown).cloned().collect())
}
