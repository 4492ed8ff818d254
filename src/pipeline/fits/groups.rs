//! Fits groups of runs at once: one sample in one condition, over voltages, drives and repeats.
//!
//! What comes out is printed and not stored: a stored fit belongs to one run and reports compare runs, while a
//! group's fit is a further opinion on them that depends on which runs were there and what they were made to share.

use super::choice::FitChoice;
use super::outcome::fit_fault;
use crate::domain::fault::caught;
use crate::domain::{Channel, Issue};
use crate::fit::{
    Bootstrap, FitError, FitInput, GroupFit, GroupOptions, Intervals, can_join_group, fit_group, shareable,
};
use crate::model::FitModel;
use crate::pipeline::campaign::batch::{Making, TO_THE_END};
use crate::pipeline::campaign::grouping::{Group, groups, singles};
use crate::pipeline::campaign::{readings, standing};
use crate::pipeline::{Context, Observer, PipelineError};

/// Groups whose readings are held at once.
const BATCH: usize = 8;
/// Seed of the bootstrap where none is given.
const SEED: u64 = 1;

/// Which parameters the runs of a group have in common.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Sharing {
    /// All of them.
    #[default]
    All,
    /// Those of these keys.
    Only(Vec<String>),
    /// All but those of these keys.
    AllBut(Vec<String>),
}

impl Sharing {
    /// Keys of the shared parameters.
    fn keys(&self, model: &FitModel) -> Result<Vec<String>, FitError> {
        let known = shareable(model);
        let named = match self {
            Sharing::All => &[][..],
            Sharing::Only(keys) | Sharing::AllBut(keys) => keys,
        };
        if let Some(found) = named.iter().find(|key| !known.contains(&key.as_str())) {
            return Err(FitError::SharedParameter {
                found: found.clone(),
                known: known.join(", "),
            });
        }
        let is_shared = |key: &&str| match self {
            Sharing::All => true,
            Sharing::Only(keys) => keys.iter().any(|own| own == key),
            Sharing::AllBut(keys) => keys.iter().all(|own| own != key),
        };
        Ok(known.into_iter().filter(is_shared).map(str::to_owned).collect())
    }
}

/// What is fitted at once.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum FitTogether {
    /// The runs of each group.
    #[default]
    Groups,
    /// Every run by itself, for the intervals that only this kind of fit gives.
    SingleRuns,
}

/// A group that was fitted, or why it was not.
#[derive(Debug)]
pub struct FittedGroup {
    /// What its runs have in common.
    pub name: String,
    /// The runs fitted, by name, in the order of the fit's runs.
    pub runs: Vec<String>,
    /// Runs that could not be part of it, by name, with the reasons.
    pub left_out: Vec<(String, Issue)>,
    /// What was asked for.
    pub options: GroupOptions,
    /// The fit.
    pub outcome: Result<GroupFit, Issue>,
}

/// The verb `fit --group`.
#[derive(Debug, Clone, Default)]
pub struct FitGroups {
    /// Model and seed; groups are always fitted to both responses at once, by descent.
    pub choice: FitChoice,
    /// What is fitted at once.
    pub of: FitTogether,
    /// What the runs share.
    pub sharing: Sharing,
    /// Whether every interval is found by profile likelihood.
    pub profile: bool,
    /// Refits of a bootstrap; none to do without.
    pub bootstrap: Option<usize>,
}

impl FitGroups {
    /// Fits every group of runs that can be fitted. The outcome does not depend on the number of threads.
    ///
    /// # Errors
    /// The model or a key is not known, or the database fails; a group that cannot be fitted says why in its entry.
    pub fn run(&self, context: &Context, observer: &dyn Observer) -> Result<Vec<FittedGroup>, PipelineError> {
        let model = self.choice.options(&context.campaign)?.model;
        if !model.id.starts_with("lumped") {
            return Err(FitError::GroupModel { found: model.id }.into());
        }
        let options = GroupOptions {
            model,
            shared: self.sharing.keys(model)?,
            intervals: if self.profile {
                Intervals::Profile
            } else {
                Intervals::Automatic
            },
            bootstrap: self.bootstrap.map(|replicates| Bootstrap {
                seed: self.choice.seed.unwrap_or(SEED),
                replicates,
            }),
        };
        let tasks = context.store.fit_tasks()?;
        let found = match self.of {
            FitTogether::Groups => groups(&standing::speaking(context)?, tasks, &context.campaign.group_by),
            FitTogether::SingleRuns => singles(tasks),
        };
        let making = Making {
            doing: "fitting with intervals asked for",
            at_once: BATCH,
            observer,
            may_go_on: TO_THE_END,
        };
        let make = |group: &Group, channels: Vec<Vec<Channel>>| fit_one(group, &channels, &options);
        let mut entries = Vec::with_capacity(found.len());
        let load = |context: &Context, group: &Group| readings::of_tasks(context, &group.tasks);
        making.look(context, &found, load, make, |made| {
            entries.extend(made.into_iter().map(|(_, entry)| entry));
            Ok(())
        })?;
        Ok(entries)
    }
}

/// Fits one group, without the runs that cannot be part of it; a panic in a kernel is that group's failure.
fn fit_one(group: &Group, channels: &[Vec<Channel>], options: &GroupOptions) -> FittedGroup {
    let (mut runs, mut inputs, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    for (task, channels) in group.tasks.iter().zip(channels) {
        let input = FitInput {
            channels,
            drive: &task.drive,
            area_cm2: task.area_cm2,
        };
        match can_join_group(&input, options.model) {
            Ok(()) => {
                runs.push(task.path.clone());
                inputs.push(input);
            }
            Err(error) => left_out.push((
                task.path.clone(),
                Issue::warning("not-in-group", error.to_string()),
            )),
        }
    }
    let fitted = caught(|| fit_group(&inputs, options));
    let outcome = match fitted {
        Ok(Ok(fit)) => Ok(fit),
        Ok(Err(FitError::EmptyGroup)) => Err(Issue::warning(
            "group-not-fitted",
            "none of its runs can be fitted",
        )
        .mend("see the reasons of the runs left out")),
        Ok(Err(error)) => Err(Issue::warning("group-not-fitted", error.to_string())),
        Err(reason) => Err(fit_fault("the fit of the group", &reason)),
    };
    FittedGroup {
        name: group.name.clone(),
        runs,
        left_out,
        options: options.clone(),
        outcome,
    }
}
