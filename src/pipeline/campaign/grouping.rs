//! Which runs are fitted together: those that are diagnosed together.

use std::collections::BTreeMap;

use crate::analysis::groups;
use crate::domain::RunRecord;
use crate::store::FitTask;

/// Runs that are fitted together.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// What they have in common, `sample=CNaf-01,environment=air`.
    pub name: String,
    /// The runs, by name.
    pub tasks: Vec<FitTask>,
}

/// Sorts the runs that can be fitted into the groups of [`groups::groups`].
pub fn groups(runs: &[RunRecord], tasks: Vec<FitTask>, group_by: &[String]) -> Vec<Group> {
    let mut by_id: BTreeMap<i64, FitTask> = tasks.into_iter().map(|task| (task.run_id, task)).collect();
    let ready: Vec<i64> = by_id.keys().copied().collect();
    let among = |run: &RunRecord| ready.binary_search(&run.id).is_ok();
    let found = groups::groups(runs, group_by, &among);
    let tasked = found.into_iter().map(|group| Group {
        name: group.name,
        tasks: group
            .runs
            .iter()
            .filter_map(|&index| by_id.remove(&runs[index].id))
            .collect(),
    });
    tasked.collect()
}

/// Every run that can be fitted as a group of its own, named by it.
pub fn singles(tasks: Vec<FitTask>) -> Vec<Group> {
    let single = |task: FitTask| Group {
        name: format!("run={}", task.path),
        tasks: vec![task],
    };
    tasks.into_iter().map(single).collect()
}
