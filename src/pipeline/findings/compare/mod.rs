//! The verb `compare`: the same runs by several models, held against each other, and stored to be drawn.

mod hash;
mod scored;

use std::collections::BTreeMap;

use crate::analysis::groups::groups;
use crate::analysis::models_compared::{ComparedCondition, models_compared};
use crate::domain::fault::caught;
use crate::domain::{Channel, RunComparison, RunRecord};
use crate::fit::FitError;
use crate::model::{FitModel, bending_law, fit_models};
use crate::pipeline::campaign::batch::{Making, TO_THE_END};
use crate::pipeline::campaign::context::{CODE_VERSION, now};
use crate::pipeline::campaign::{readings, standing};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{FitTask, StoredComparison};
use hash::input_hash;
use scored::scored;

/// Groups compared between two commits: bounds memory, and what an interruption costs.
const BATCH: usize = 4;

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
}

/// Runs of one sample in one environment: each tells what the others predict at its voltage.
struct Group {
    name: String,
    tasks: Vec<FitTask>,
    hash: String,
}

/// What is asked of a campaign's runs.
struct Asked {
    models: Vec<&'static FitModel>,
    runs: Vec<RunRecord>,
    /// Groups to compare.
    due: Vec<Group>,
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
        let asked = self.asked(context)?;
        let mut summary = asked.summary();
        let make = |group: &Group, channels: Vec<Vec<Channel>>| asked.scored(group, &channels);
        making(observer).run(context, &asked.due, load, make, |context, made| {
            save(context, made, &mut summary)
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
        let asked = self.asked(context)?;
        let mut summary = asked.summary();
        let is_due = |run: &str| {
            let mut tasks = asked.due.iter().flat_map(|group| &group.tasks);
            tasks.any(|task| task.path == run)
        };
        summary.comparisons = asked.stored(context)?;
        summary.comparisons.retain(|found| !is_due(&found.run));
        let make = |group: &Group, channels: Vec<Vec<Channel>>| asked.scored(group, &channels);
        making(observer).look(context, &asked.due, load, make, |made| {
            for (group, made) in made {
                match made {
                    Ok(found) => summary.took(found),
                    Err(reason) => summary.faults.push(format!("{}: {reason}", group.name)),
                }
            }
            Ok(())
        })?;
        summary.comparisons.sort_by(|a, b| a.run.cmp(&b.run));
        asked.sum_up(context, &mut summary);
        Ok(summary)
    }

    fn asked(&self, context: &Context) -> Result<Asked, PipelineError> {
        let models = self.models()?;
        let runs = standing::speaking(context)?;
        let all = grouped(context, &runs, &models)?;
        let known: BTreeMap<i64, String> = context
            .store
            .comparisons()?
            .into_iter()
            .map(|stored| (stored.run_id, stored.input_hash))
            .collect();
        let is_done = |group: &Group| {
            let mut tasks = group.tasks.iter();
            !self.again && tasks.all(|task| known.get(&task.run_id) == Some(&group.hash))
        };
        let (done, due): (Vec<Group>, Vec<Group>) = all.into_iter().partition(is_done);
        Ok(Asked {
            models,
            runs,
            due,
            up_to_date: done.iter().map(|group| group.tasks.len()).sum(),
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

    /// The comparisons of a group's runs, or the fault that stopped them.
    fn scored(&self, group: &Group, channels: &[Vec<Channel>]) -> Result<Vec<RunComparison>, String> {
        caught(|| scored(&group.tasks, channels, &self.models))
    }

    /// Every stored comparison with these models that still stands, by the runs' names.
    fn stored(&self, context: &Context) -> Result<Vec<RunComparison>, PipelineError> {
        let mut found = current_comparisons(context, &self.runs)?.0;
        found.retain(|found| {
            let ids = found.models.iter().map(|score| &*score.model);
            ids.eq(self.models.iter().map(|model| model.id))
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
    fn took(&mut self, found: Vec<RunComparison>) {
        self.compared += found.len();
        self.comparisons.extend(found);
    }
}

fn making(observer: &dyn Observer) -> Making<'_> {
    Making {
        doing: "comparing models",
        at_once: BATCH,
        observer,
        may_go_on: TO_THE_END,
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
    let stored = context.store.comparisons()?;
    if stored.is_empty() {
        return Ok((Vec::new(), 0));
    }
    // Runs may have been compared with other models at other times: each set of models has its hashes.
    let mut hashes: BTreeMap<Vec<(String, u32)>, BTreeMap<i64, String>> = BTreeMap::new();
    let (mut current, mut outdated) = (Vec::new(), 0);
    for one in stored {
        let score = |score: &crate::domain::ModelScore| (score.model.clone(), score.version);
        let set: Vec<(String, u32)> = one.found.models.iter().map(score).collect();
        if !hashes.contains_key(&set) {
            let of_set = hashes_of(context, runs, &set)?;
            hashes.insert(set.clone(), of_set);
        }
        match hashes[&set].get(&one.run_id) {
            Some(hash) if *hash == one.input_hash => current.push(one.found),
            // A run that does not speak any more is no loss.
            None => {}
            Some(_) => outdated += 1,
        }
    }
    Ok((current, outdated))
}

/// Hash of each run's comparison with these models as they are now.
fn hashes_of(
    context: &Context,
    runs: &[RunRecord],
    set: &[(String, u32)],
) -> Result<BTreeMap<i64, String>, PipelineError> {
    let models: Option<Vec<&'static FitModel>> = set
        .iter()
        .map(|(id, _)| fit_models().iter().find(|model| model.id == *id))
        .collect();
    let all = grouped(context, runs, &models.unwrap_or_default())?;
    let of_group = |group: &Group| {
        let hash = group.hash.clone();
        let ids: Vec<i64> = group.tasks.iter().map(|task| task.run_id).collect();
        ids.into_iter().map(move |id| (id, hash.clone()))
    };
    Ok(all.iter().flat_map(of_group).collect())
}

/// The runs that can be fitted, by sample and surroundings.
fn grouped(
    context: &Context,
    runs: &[RunRecord],
    models: &[&'static FitModel],
) -> Result<Vec<Group>, PipelineError> {
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
            hash: input_hash(&tasks, models),
            tasks,
        }
    };
    Ok(found.into_iter().map(group).collect())
}

fn load(context: &Context, group: &Group) -> Result<Vec<Vec<Channel>>, PipelineError> {
    readings::of_tasks(context, &group.tasks)
}

/// Comparisons of a group's runs, or the fault that stopped them.
type Made<'g> = (&'g Group, Result<Vec<RunComparison>, String>);

fn save(context: &mut Context, made: Vec<Made>, summary: &mut CompareSummary) -> Result<(), PipelineError> {
    let mut rows = Vec::new();
    for (group, found) in made {
        match found {
            Err(reason) => summary.faults.push(format!("{}: {reason}", group.name)),
            Ok(found) => {
                summary.compared += found.len();
                let row = |(task, found): (&FitTask, RunComparison)| StoredComparison {
                    run_id: task.run_id,
                    input_hash: group.hash.clone(),
                    found,
                };
                rows.extend(group.tasks.iter().zip(found).map(row));
            }
        }
    }
    Ok(context.store.save_comparisons(&now(), CODE_VERSION, &rows)?)
}
