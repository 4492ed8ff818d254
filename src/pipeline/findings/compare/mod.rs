//! The verb `compare`: the same runs by several models, held against each other, and stored to be drawn.

mod hash;
mod scored;

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::groups::groups;
use crate::analysis::models_compared::{ComparedCondition, models_compared};
use crate::domain::{Channel, Issue, RunComparison, RunRecord};
use crate::fit::FitError;
use crate::model::{FitModel, bending_law, fit_models};
use crate::pipeline::campaign::derived::{
    Derived, Keyed, Made, MadeOf, Sorted, bring_up_to_date, in_rounds, look, sorted,
};
use crate::pipeline::campaign::{readings, standing};
use crate::pipeline::fits::outcome::fit_fault;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{FitTask, ResultKind};
use hash::input_hash;
use scored::scored;

/// What is compared where nothing is asked for: the thesis's models and every rival.
const DEFAULT: [&str; 7] = [
    "lumped-1",
    "lumped-2",
    "yagasaki-tamagawa",
    "bao-two-way",
    "kelvin-voigt",
    "maxwell",
    "standard-linear-solid",
];

/// The verb `compare`.
#[derive(Debug, Clone, Default)]
pub struct CompareModels {
    /// Ids of the models; empty for all of a strip as a whole.
    pub models: Vec<String>,
    /// Compare again even where nothing changed.
    pub again: bool,
}

/// What `compare` did.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CompareSummary {
    /// Runs compared now.
    pub compared: usize,
    /// Runs whose comparison was up to date.
    pub up_to_date: usize,
    /// Runs that no model describes, with the reason.
    pub failed: Vec<(String, String)>,
    /// Groups on which a fault of the program stopped the comparison.
    pub faults: Vec<String>,
    /// Every comparison with these models, by the runs' names.
    pub comparisons: Vec<RunComparison>,
    /// The same summed up by material and environment.
    pub conditions: Vec<ComparedCondition>,
    /// Runs that are left for the next call: what their comparisons depend on changed each time that they were made.
    pub changing: Vec<String>,
}

/// Runs of one sample in one environment: each tells what the others predict at its voltage.
struct Group {
    name: String,
    tasks: Vec<FitTask>,
}

/// Comparisons with these models.
struct Comparing {
    models: Vec<&'static FitModel>,
}

impl Derived for Comparing {
    type Subject = Group;
    type Readings = Vec<Vec<Channel>>;
    type Found = RunComparison;
    const KIND: ResultKind = ResultKind::Comparison;
    const DOING: &'static str = "comparing models";
    const AT_ONCE: usize = 4;

    fn subjects(&self, context: &Context) -> Result<Vec<Group>, PipelineError> {
        grouped(context, &standing::speaking(context)?)
    }

    fn runs<'s>(&self, group: &'s Group) -> Vec<MadeOf<'s>> {
        group.tasks.iter().map(MadeOf::from).collect()
    }

    fn key(&self, group: &Group) -> String {
        input_hash(&group.tasks, &self.models)
    }

    fn load(&self, context: &Context, group: &Group) -> Result<Vec<Vec<Channel>>, PipelineError> {
        readings::of_tasks(context, &group.tasks)
    }

    fn make(&self, group: &Group, channels: Vec<Vec<Channel>>) -> Vec<Made<RunComparison>> {
        let found = scored(&group.tasks, &channels, &self.models);
        found.into_iter().map(Ok).collect()
    }

    fn fault(&self, reason: &str) -> Issue {
        fit_fault("the comparison", reason)
    }
}

/// What is asked of a campaign's runs.
struct Asked {
    comparing: Comparing,
    runs: Vec<RunRecord>,
    /// Groups to compare.
    due: Vec<Keyed<Group>>,
    up_to_date: usize,
}

impl CompareModels {
    /// Compares what is missing or out of date, and stores it. The outcome does not depend on the number of threads, the
    /// times that fits took left aside.
    ///
    /// # Errors
    /// A model is not known or none of a strip as a whole, or the database fails.
    pub fn run(
        &self,
        context: &mut Context,
        observer: &dyn Observer,
    ) -> Result<CompareSummary, PipelineError> {
        let mut asked = self.asked(context, self.again)?;
        let mut summary = asked.summary();
        summary.changing = in_rounds(Comparing::DOING, observer, |is_first| {
            if !is_first {
                asked = self.asked(context, false)?;
            }
            let took = |group: &Group, run: &str, made: &Made<RunComparison>| summary.took(group, run, made);
            bring_up_to_date(&asked.comparing, context, &asked.due, observer, took)
        })?;
        summary.comparisons = asked.stored(context)?;
        asked.sum_up(context, &mut summary);
        Ok(summary)
    }

    /// The same without a change of the campaign: what is missing or out of date is compared anew in every call.
    ///
    /// # Errors
    /// As of [`CompareModels::run`].
    pub fn look(&self, context: &Context, observer: &dyn Observer) -> Result<CompareSummary, PipelineError> {
        let asked = self.asked(context, self.again)?;
        let mut summary = asked.summary();
        let due = asked.due.iter().flat_map(|(_, group)| &group.tasks);
        let due: BTreeSet<&str> = due.map(|task| task.path.as_str()).collect();
        summary.comparisons = asked.stored(context)?;
        summary.comparisons.retain(|found| !due.contains(&*found.run));
        look(
            &asked.comparing,
            context,
            &asked.due,
            observer,
            |group, run, made| {
                summary.took(group, run, &made);
                summary.comparisons.extend(made.ok());
            },
        )?;
        summary.comparisons.sort_by(|a, b| a.run.cmp(&b.run));
        asked.sum_up(context, &mut summary);
        Ok(summary)
    }

    fn asked(&self, context: &Context, again: bool) -> Result<Asked, PipelineError> {
        let models = self.models()?;
        let runs = standing::speaking(context)?;
        let groups = grouped(context, &runs)?;
        let comparing = Comparing { models };
        let Sorted { up_to_date, due } = sorted(&comparing, context, groups, again)?;
        Ok(Asked {
            comparing,
            runs,
            due,
            up_to_date: up_to_date.iter().map(|(_, group)| group.tasks.len()).sum(),
        })
    }

    fn models(&self) -> Result<Vec<&'static FitModel>, PipelineError> {
        let asked: Vec<&str> = match self.models.as_slice() {
            [] => DEFAULT.to_vec(),
            named => named.iter().map(String::as_str).collect(),
        };
        let mut models: Vec<&'static FitModel> = Vec::new();
        for id in asked {
            let bad = |needed: String| PipelineError::BadArgument {
                what: "--models",
                found: id.to_owned(),
                needed,
            };
            let known = fit_models()
                .iter()
                .filter(|model| bending_law(model.id).is_some());
            let model = fit_models().iter().find(|model| model.id == id);
            let Some(model) = model else {
                let ids: Vec<&str> = known.map(|model| model.id).collect();
                return Err(bad(format!(
                    "models of a strip as a whole, from {}",
                    ids.join(", ")
                )));
            };
            if bending_law(id).is_none() {
                return Err(FitError::WholeStrip { found: model.id }.into());
            }
            if models.iter().any(|own| own.id == id) {
                return Err(bad("each model once".to_owned()));
            }
            models.push(model);
        }
        Ok(models)
    }
}

impl Asked {
    fn summary(&self) -> CompareSummary {
        CompareSummary {
            up_to_date: self.up_to_date,
            ..CompareSummary::default()
        }
    }

    /// Every stored comparison with these models that still stands, by the runs' names.
    fn stored(&self, context: &Context) -> Result<Vec<RunComparison>, PipelineError> {
        let mut found = current_comparisons(context, &self.runs)?.0;
        found.retain(|found| {
            let ids = found.models.iter().map(|score| &*score.model);
            ids.eq(self.comparing.models.iter().map(|model| model.id))
        });
        Ok(found)
    }

    /// Sums up the comparisons of a summary.
    fn sum_up(&self, context: &Context, summary: &mut CompareSummary) {
        summary.conditions = models_compared(&summary.comparisons, &self.runs, &context.campaign);
        for found in &summary.comparisons {
            if found.curves.is_empty() {
                let why = found.models.first().and_then(|score| score.missing.clone());
                summary.failed.push((found.run.clone(), why.unwrap_or_default()));
            }
        }
    }
}

impl CompareSummary {
    /// Counts what came of a run.
    fn took(&mut self, group: &Group, run: &str, made: &Made<RunComparison>) {
        match made {
            Ok(_) => self.compared += 1,
            // Said once of the group.
            Err(issue) if group.tasks[0].path == run => {
                self.faults.push(format!("{}: {}", group.name, issue.message))
            }
            Err(_) => {}
        }
    }
}

/// Every stored comparison that what it was made from still bears out, by the runs' names, and the number of the others.
///
/// # Errors
/// The database cannot be read.
pub fn current_comparisons(
    context: &Context,
    runs: &[RunRecord],
) -> Result<(Vec<RunComparison>, usize), PipelineError> {
    let stored = context.store.results::<RunComparison>(ResultKind::Comparison)?;
    let mut groups = None;
    // Runs may have been compared with other models at other times: each set of models has its keys.
    let mut keys: BTreeMap<Vec<(String, u32)>, BTreeMap<String, String>> = BTreeMap::new();
    let (mut current, mut outdated) = (Vec::new(), 0);
    for one in stored {
        let Ok(found) = one.found else { continue };
        let groups = match &groups {
            Some(groups) => groups,
            None => groups.insert(grouped(context, runs)?),
        };
        let score = |score: &crate::domain::ModelScore| (score.model.clone(), score.version);
        let set: Vec<(String, u32)> = found.models.iter().map(score).collect();
        let of_set = keys.entry(set).or_insert_with_key(|set| keys_of(groups, set));
        match of_set.get(&one.origin.name) {
            Some(key) if *key == one.origin.key => current.push(found),
            // A run that does not speak any more is no loss.
            None => {}
            Some(_) => outdated += 1,
        }
    }
    Ok((current, outdated))
}

/// What each run's comparison with these models depends on now, by the run's name.
fn keys_of(groups: &[Group], set: &[(String, u32)]) -> BTreeMap<String, String> {
    let known = set
        .iter()
        .filter_map(|(id, _)| fit_models().iter().find(|model| model.id == *id));
    let comparing = Comparing {
        models: known.collect(),
    };
    let of_group = |group: &Group| {
        let key = comparing.key(group);
        let tasks = group.tasks.iter();
        tasks
            .map(|task| (task.path.clone(), key.clone()))
            .collect::<Vec<_>>()
    };
    groups.iter().flat_map(of_group).collect()
}

/// The runs that can be fitted, by sample and surroundings.
fn grouped(context: &Context, runs: &[RunRecord]) -> Result<Vec<Group>, PipelineError> {
    let mut by_id: BTreeMap<i64, FitTask> = context
        .store
        .fit_tasks()?
        .into_iter()
        .map(|task| (task.run_id, task))
        .collect();
    let ready: Vec<i64> = by_id.keys().copied().collect();
    let among = |run: &RunRecord| ready.binary_search(&run.id).is_ok();
    let found = groups(runs, &context.campaign.group_by, &among);
    let group = |group: crate::analysis::groups::RunGroup| {
        let tasks: Vec<FitTask> = group
            .runs
            .iter()
            .filter_map(|&index| by_id.remove(&runs[index].id))
            .collect();
        Group {
            name: group.name,
            tasks,
        }
    };
    Ok(found.into_iter().map(group).collect())
}
