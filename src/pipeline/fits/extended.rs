//! Fits groups of runs with an extended model; every run is stored with the parameters of its group.

use super::input_hash::{library_hash, take_task};
use super::outcome::{FitSummary, Outcome, fit_fault, known_not_used, save};
use super::plan::{ExtendedGroup, Planned};
use crate::diagnose::{RunInput, fit_extended, model_version};
use crate::domain::diagnosis::follows_a_tag;
use crate::domain::fault::caught;
use crate::domain::{Channel, InputHash, Issue};
use crate::fit::{FitInput, MOVING_VERSION};
use crate::ingest::derived;
use crate::pipeline::campaign::batch::{Making, TO_THE_END};
use crate::pipeline::campaign::group_tags::take_tags;
use crate::pipeline::{Context, Observer, PipelineError};

/// Groups fitted between two commits.
const BATCH: usize = 8;

/// Fits the groups that are new or whose input changed.
pub(crate) fn fit_groups(
    context: &mut Context,
    groups: &[ExtendedGroup],
    again: bool,
    observer: &dyn Observer,
    summary: &mut FitSummary,
) -> Result<(), PipelineError> {
    let (done, due) = sorted(groups, again);
    summary.up_to_date += done.iter().map(|(_, group)| group.runs.len()).sum::<usize>();
    let making = Making {
        doing: "fitting extended models",
        at_once: BATCH,
        observer,
        may_go_on: TO_THE_END,
    };
    let load = |context: &Context, (_, group): &Hashed<'_>| -> Result<Vec<Vec<Channel>>, PipelineError> {
        let channels = |run: &Planned| Ok(context.store.channels(run.task.run_id)?);
        group.runs.iter().map(channels).collect()
    };
    let make = |(_, group): &Hashed<'_>, channels: Vec<Vec<Channel>>| fit_one(group, &channels);
    making.run(context, &due, load, make, |context, made| {
        for ((hash, group), outcomes) in made {
            let stamped = group.runs.iter().map(|run| (hash.as_str(), run)).zip(outcomes);
            save(context, stamped.collect(), summary)?;
        }
        Ok(())
    })
}

/// Number of runs in groups that would be fitted.
pub(crate) fn due(groups: &[ExtendedGroup], again: bool) -> usize {
    let (_, due) = sorted(groups, again);
    due.iter().map(|(_, group)| group.runs.len()).sum()
}

/// A group with the hash of all that its fits depend on.
type Hashed<'g> = (String, &'g ExtendedGroup);

/// The groups whose fits are up to date, and the others.
fn sorted(groups: &[ExtendedGroup], again: bool) -> (Vec<Hashed<'_>>, Vec<Hashed<'_>>) {
    let library = library_hash();
    let hashed = groups.iter().map(|group| (input_hash(group, &library), group));
    let is_done = |(hash, group): &Hashed<'_>| {
        let mut done = group.runs.iter().map(|run| run.task.done_input_hash.as_ref());
        !again && done.all(|done| done == Some(hash))
    };
    hashed.partition(is_done)
}

/// One outcome for every run of the group; a panic in a kernel is that group's failure, not the program's.
fn fit_one(group: &ExtendedGroup, channels: &[Vec<Channel>]) -> Vec<Outcome> {
    let work = || {
        let tasks = group.runs.iter().map(|run| &run.task);
        let responses: Vec<Vec<Channel>> = tasks
            .clone()
            .zip(channels)
            .map(|(task, channels)| derived::responses(channels, task.length_cm))
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
    let found = match caught(work) {
        Ok(found) => found,
        Err(reason) => {
            let fault = fit_fault("the fit of its group", &reason);
            return group.runs.iter().map(|_| Err(fault.clone())).collect();
        }
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
        .mend("`ieap effects ID` says what an effect needs; take it out of the model, or fit with the base alone"))
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
    let version = model_version(group.choice.base);
    hash.text(&group.choice.to_string())
        .whole(version.into())
        .text(library);
    hash.finished()
}
