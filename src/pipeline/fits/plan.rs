//! How every run is fitted: as asked for now, as campaign.toml states, or as it was asked for before; with the model
//! adopted for its group where none is asked for; and which runs are fitted together, since effects are shared by a group.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::choice::{Chosen, choose};
use super::input_hash::{input_hash, input_hash_beside, is_weighed_by_kinds};
use super::instruments::{Instruments, NoiseOfOthers, Telling};
use crate::analysis::groups::groups;
use crate::domain::{AskedFit, KnownParameter, RunRecord};
use crate::fit::{FitError, FitOptions};
use crate::model::ModelChoice;
use crate::model::effects::TagAt;
use crate::pipeline::campaign::derived::Keyed;
use crate::pipeline::campaign::group_tags::group_tags;
use crate::pipeline::campaign::standing;
use crate::pipeline::{Context, PipelineError};
use crate::store::FitTask;

/// A run to be fitted, and how.
#[derive(Debug, Clone)]
pub(crate) struct Planned {
    pub(crate) task: FitTask,
    pub(crate) chosen: Chosen,
    /// The runs that tell of the noise of its instrument; it may be one of them.
    tellers: Arc<[Telling]>,
}

impl Planned {
    /// What is known of the run's parameters.
    pub(crate) fn known(&self) -> Vec<KnownParameter> {
        let sample = self.task.sample.as_deref();
        let all = self.chosen.said.known.iter();
        all.filter(|known| known.holds_for(sample)).cloned().collect()
    }

    /// Hash of everything that its fit depends on.
    pub(crate) fn input_hash(&self) -> String {
        let own = input_hash(&self.task, &self.chosen.options, &self.known());
        input_hash_beside(own, self.others().map(|other| other.hash.as_str()))
    }

    /// The other runs that tell of the noise of its instrument; none where its fit is not weighed by that.
    pub(crate) fn others(&self) -> impl Iterator<Item = &Telling> {
        let is_weighed = is_weighed_by_kinds(&self.task, &self.chosen.options, &self.known());
        let others = self.tellers.iter().filter(|own| !own.is(&self.task));
        others.filter(move |_| is_weighed)
    }

    /// How it is fitted, with what the others tell.
    pub(crate) fn options<'a>(&self, of_others: &'a NoiseOfOthers) -> FitOptions<'a> {
        self.chosen.options.told_by(&of_others.noise)
    }
}

/// Runs of a group that are fitted with one parameter set of an extended model.
pub(crate) struct ExtendedGroup {
    pub(crate) choice: ModelChoice,
    pub(crate) runs: Vec<Planned>,
    /// Where each run lies among the values of tags that differ in the group.
    pub(crate) tags: Vec<Vec<TagAt>>,
}

/// What is fitted with what.
pub(crate) struct FitPlan {
    /// Runs fitted one by one.
    pub(crate) single: Vec<Planned>,
    pub(crate) extended: Vec<ExtendedGroup>,
    /// Groups that campaign.toml adopts a model for and that are not there.
    pub(crate) unknown_groups: Vec<String>,
}

impl FitPlan {
    /// The runs that are fitted one by one, by name, each with the hash of what its fit depends on.
    pub(crate) fn keyed(self) -> BTreeMap<String, Keyed<Planned>> {
        let keyed = self.single.into_iter().map(|run| {
            let name = run.task.path.clone();
            (name, (run.input_hash(), run))
        });
        keyed.collect()
    }
}

/// The plan for all runs that can be fitted; `asked` goes before everything that campaign.toml says.
pub(crate) fn fit_plan(context: &Context, asked: &AskedFit) -> Result<FitPlan, PipelineError> {
    let campaign = &context.campaign;
    // A choice that is wrong is refused though there is no run yet that it holds for.
    choose(asked, campaign, &AskedFit::default())?;
    // The last entry of a group holds: adopting again adds one.
    let mut adopted: BTreeMap<&str, ModelChoice> = BTreeMap::new();
    for entry in campaign.adopted.iter().filter(|_| asked.model.is_none()) {
        adopted.insert(
            &entry.group,
            ModelChoice::parse(&entry.model).map_err(FitError::Choice)?,
        );
    }
    let tasks = context.store.fit_tasks()?;
    let instruments = Instruments::of(campaign, &tasks)?;
    let planned = |task: FitTask| -> Result<Planned, PipelineError> {
        Ok(Planned {
            chosen: choose(asked, campaign, &task.last_asked)?,
            tellers: instruments.tellers(&task),
            task,
        })
    };
    let planned = tasks
        .into_iter()
        .map(planned)
        .collect::<Result<Vec<Planned>, _>>()?;
    if adopted.is_empty() && !planned.iter().any(|run| run.chosen.model.is_extended()) {
        return Ok(FitPlan {
            single: planned,
            extended: Vec::new(),
            unknown_groups: Vec::new(),
        });
    }
    grouped(context, planned, &adopted)
}

fn grouped(
    context: &Context,
    planned: Vec<Planned>,
    adopted: &BTreeMap<&str, ModelChoice>,
) -> Result<FitPlan, PipelineError> {
    // A run that is set aside takes no part in the one parameter set of its group; it is fitted by itself.
    let runs = standing::speaking(context)?;
    let mut by_id: BTreeMap<i64, Planned> = planned.into_iter().map(|run| (run.task.run_id, run)).collect();
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
        let of_group = group.runs.iter().map(|&index| &runs[index]);
        let (records, of_group): (Vec<&RunRecord>, Vec<Planned>) = of_group
            .filter_map(|run| Some((run, by_id.remove(&run.id)?)))
            .unzip();
        let own = adopted.get(group.name.as_str());
        let choice = own.cloned().or_else(|| common(&of_group));
        // Runs that are set apart share nothing with others.
        match choice.filter(|choice| choice.is_extended() && group.set_apart.is_none()) {
            Some(choice) => plan.extended.push(ExtendedGroup {
                choice,
                runs: of_group,
                tags: group_tags(&records, &context.campaign.extra_tags),
            }),
            None => plan
                .single
                .extend(of_group.into_iter().map(|run| with_base(run, own))),
        }
    }
    plan.single.extend(by_id.into_values());
    plan.single.sort_by(|a, b| a.task.path.cmp(&b.task.path));
    Ok(plan)
}

/// The model that all runs of a group are to be fitted with; none where they differ.
fn common(runs: &[Planned]) -> Option<ModelChoice> {
    let first = &runs.first()?.chosen.model;
    runs.iter()
        .all(|run| run.chosen.model.to_string() == first.to_string())
        .then(|| first.clone())
}

/// A run fitted by itself with the base of the model adopted for its group, if any.
fn with_base(run: Planned, adopted: Option<&ModelChoice>) -> Planned {
    let Some(adopted) = adopted else { return run };
    let options = FitOptions {
        model: adopted.base,
        ..run.chosen.options
    };
    Planned {
        chosen: Chosen {
            options,
            ..run.chosen
        },
        ..run
    }
}
