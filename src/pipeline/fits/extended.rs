//! Fits groups of runs with an extended model; every run is stored with the parameters of its group.

use super::input_hash::{library_hash, take_task};
use super::outcome::{Outcome, fit_fault, known_not_used, store};
use super::plan::{ExtendedGroup, Planned, fit_plan};
use crate::diagnose::{RunInput, fit_extended, model_version};
use crate::domain::diagnosis::follows_a_tag;
use crate::domain::{AskedFit, Channel, Fit, InputHash, Issue};
use crate::fit::{FitInput, MOVING_VERSION};
use crate::ingest::derived;
use crate::model::effects::smooth_laws::smooth_law;
use crate::pipeline::campaign::derived::{Derived, MadeOf};
use crate::pipeline::campaign::group_tags::take_tags;
use crate::pipeline::campaign::readings;
use crate::pipeline::{Context, PipelineError};
use crate::store::{NewResult, ResultKind};

/// Groups fitted between two commits.
const BATCH: usize = 8;

/// Fits of groups with an extended model.
pub(crate) struct Groups {
    /// Hash of the library of effects.
    library: String,
    /// How fits are asked for.
    asked: AskedFit,
}

impl Groups {
    pub(crate) fn new(asked: AskedFit) -> Groups {
        Groups {
            library: library_hash(),
            asked,
        }
    }
}

impl Derived for Groups {
    type Subject = ExtendedGroup;
    type Readings = Vec<Vec<Channel>>;
    type Found = Fit;
    const KIND: ResultKind = ResultKind::Fit;
    const DOING: &'static str = "fitting extended models";
    const AT_ONCE: usize = BATCH;

    fn subjects(&self, context: &Context) -> Result<Vec<ExtendedGroup>, PipelineError> {
        Ok(fit_plan(context, &self.asked)?.extended)
    }

    fn runs<'s>(&self, group: &'s ExtendedGroup) -> Vec<MadeOf<'s>> {
        group.runs.iter().map(|run| MadeOf::from(&run.task)).collect()
    }

    fn key(&self, group: &ExtendedGroup) -> String {
        input_hash(group, &self.library)
    }

    fn load(&self, context: &Context, group: &ExtendedGroup) -> Result<Vec<Vec<Channel>>, PipelineError> {
        let channels = |run: &Planned| readings::with_climate(context, &run.task);
        group.runs.iter().map(channels).collect()
    }

    fn make(&self, group: &ExtendedGroup, channels: Vec<Vec<Channel>>) -> Vec<Outcome> {
        fit_group(group, &channels)
    }

    fn fault(&self, reason: &str) -> Issue {
        fit_fault("the fit of its group", reason)
    }

    fn store(
        &self,
        context: &mut Context,
        results: &[NewResult<'_, Fit>],
        of: &[&ExtendedGroup],
    ) -> Result<Vec<bool>, PipelineError> {
        store(context, results, of.iter().flat_map(|group| &group.runs))
    }
}

/// One outcome for every run of the group.
fn fit_group(group: &ExtendedGroup, channels: &[Vec<Channel>]) -> Vec<Outcome> {
    let found = {
        let tasks = group.runs.iter().map(|run| &run.task);
        let responses: Vec<Vec<Channel>> = tasks
            .clone()
            .zip(channels)
            .map(|(task, channels)| derived::responses(channels, task.length_cm, Some(&task.drive)))
            .collect();
        let inputs: Vec<RunInput> = tasks
            .zip(&responses)
            .zip(&group.tags)
            .map(|((task, channels), tags)| RunInput {
                name: &task.path,
                input: FitInput {
                    channels,
                    drive: &task.drive,
                    area_cm2: task.area_cm2,
                },
                length_cm: task.length_cm,
                is_right: false,
                tags,
            })
            .collect();
        fit_extended(&inputs, &group.choice)
    };
    let missing = || {
        Err(Issue::warning(
            "not-fitted",
            format!(
                "{} cannot be fitted: the run has too few readings of current or curvature after the step, or no run of \
                 its group gives the search a start, or one of the effects cannot act in these runs",
                group.choice
            ),
        )
        .mend("`ieap list effects ID` says what an effect needs; take it out of the model, or fit with the base alone"))
    };
    let mut outcomes: Vec<Outcome> = group.runs.iter().map(|_| missing()).collect();
    for (place, mut fit) in found {
        let known = group.runs[place].known();
        if !known.is_empty() {
            fit.issues.push(known_not_used(&known, &group.choice.to_string()));
        }
        outcomes[place] = Ok(fit);
    }
    outcomes
}

/// Hash of everything that the fits of a group depend on.
fn input_hash(group: &ExtendedGroup, library: &str) -> String {
    let mut hash = InputHash::new();
    group.runs.iter().for_each(|run| take_task(&mut hash, &run.task));
    for known in group.runs.iter().flat_map(Planned::known) {
        hash.text(&known.to_string());
    }
    // Where none moves the form is that of fits before it could be.
    if group.runs.iter().any(|run| run.task.drive.moves()) {
        hash.whole(MOVING_VERSION.into());
    }
    let ids = || group.choice.effects.iter().map(|effect| effect.about().id);
    if ids().any(follows_a_tag) {
        take_tags(&mut hash, &group.tags);
    }
    let is_of_climate = |id: &str| smooth_law(id).is_some_and(|law| law.logged().is_some());
    if ids().any(is_of_climate) {
        let of_climate = group.runs.iter().map(|run| run.task.climate_hash.as_deref());
        of_climate.for_each(|climate| {
            hash.text_or_none(climate);
        });
    }
    let version = model_version(group.choice.base);
    hash.text(&group.choice.to_string())
        .whole(version.into())
        .text(library);
    hash.finished()
}
