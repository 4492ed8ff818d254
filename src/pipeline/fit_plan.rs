//! Which model every run is fitted with: the one asked for, the one adopted for its group, or the campaign's; and
//! which runs are fitted together, since effects are shared by a group.

use std::collections::BTreeMap;

use super::{Context, PipelineError, standing};
use crate::analysis::groups::groups;
use crate::domain::RunRecord;
use crate::fit::FitError;
use crate::model::{FitModel, ModelChoice};
use crate::store::FitTask;

/// Runs of a group that are fitted with one parameter set of an extended model.
pub(super) struct ExtendedGroup {
    pub(super) choice: ModelChoice,
    pub(super) tasks: Vec<FitTask>,
}

/// What is fitted with what.
pub(super) struct FitPlan {
    /// Runs fitted one by one, each with its model.
    pub(super) single: Vec<(FitTask, &'static FitModel)>,
    pub(super) extended: Vec<ExtendedGroup>,
    /// Groups that campaign.toml adopts a model for and that are not there.
    pub(super) unknown_groups: Vec<String>,
}

/// The plan for all runs that can be fitted; `asked` goes before everything that campaign.toml says.
pub(super) fn fit_plan(context: &Context, asked: Option<&str>) -> Result<FitPlan, PipelineError> {
    let campaign = &context.campaign;
    let parse = |text: &str| ModelChoice::parse(text).map_err(FitError::Choice);
    let default = parse(asked.unwrap_or(&campaign.model))?;
    // The last entry of a group holds: adopting again adds one.
    let mut adopted: BTreeMap<&str, ModelChoice> = BTreeMap::new();
    for entry in campaign.adopted.iter().filter(|_| asked.is_none()) {
        adopted.insert(&entry.group, parse(&entry.model)?);
    }
    let tasks = context.store.fit_tasks()?;
    if adopted.is_empty() && !default.is_extended() {
        return Ok(FitPlan {
            single: tasks.into_iter().map(|task| (task, default.base)).collect(),
            extended: Vec::new(),
            unknown_groups: Vec::new(),
        });
    }
    grouped(context, tasks, &default, &adopted)
}

fn grouped(
    context: &Context,
    tasks: Vec<FitTask>,
    default: &ModelChoice,
    adopted: &BTreeMap<&str, ModelChoice>,
) -> Result<FitPlan, PipelineError> {
    // A run that is set aside takes no part in the one parameter set of its group; it is fitted by itself.
    let runs = standing::speaking(context)?;
    let mut by_id: BTreeMap<i64, FitTask> = tasks.into_iter().map(|task| (task.run_id, task)).collect();
    let ready: Vec<i64> = by_id.keys().copied().collect();
    let among = |run: &RunRecord| ready.binary_search(&run.id).is_ok();
    let found = groups(&runs, &context.campaign.group_by, &among);
    let is_there = |name: &&&str| found.iter().any(|group| group.name == **name);
    let unknown_groups = adopted
        .keys()
        .filter(|name| !is_there(name))
        .map(|name| (*name).to_owned())
        .collect();
    let mut plan = FitPlan {
        single: Vec::new(),
        extended: Vec::new(),
        unknown_groups,
    };
    for group in &found {
        let of_group = group
            .runs
            .iter()
            .filter_map(|&index| by_id.remove(&runs[index].id));
        let of_group: Vec<FitTask> = of_group.collect();
        let choice = adopted.get(group.name.as_str()).unwrap_or(default);
        // Runs that are set apart share nothing with others.
        if choice.is_extended() && group.set_apart.is_none() {
            plan.extended.push(ExtendedGroup {
                choice: choice.clone(),
                tasks: of_group,
            });
        } else {
            plan.single
                .extend(of_group.into_iter().map(|task| (task, choice.base)));
        }
    }
    plan.single
        .extend(by_id.into_values().map(|task| (task, default.base)));
    plan.single.sort_by(|a, b| a.0.path.cmp(&b.0.path));
    Ok(plan)
}
