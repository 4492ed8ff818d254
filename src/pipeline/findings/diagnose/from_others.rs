//! Every sample held against what the other samples of its material say of a cause that they share.

use std::collections::BTreeSet;

use super::inputs::{BATCH, not_condemned, with_inputs};
use super::subject::Subject;
use super::{Row, Saving, runs_of};
use crate::analysis::shared_effects::{shared_effects, values_without};
use crate::diagnose::{DiagnoseOptions, fall_from_others};
use crate::domain::fault::caught;
use crate::domain::{Channel, FromOthers, GroupDiagnosis, InputHash};
use crate::pipeline::campaign::batch::{Making, TO_THE_END};
use crate::pipeline::campaign::derived::Inputs;
use crate::pipeline::campaign::{readings, standing};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{Diagnosed, FitTask, ResultKind, StoredDiagnosis};

/// What a group is to be held against.
struct Due<'a> {
    stored: StoredDiagnosis,
    subject: &'a Subject,
    /// Falls are not known yet.
    wanted: Vec<FromOthers>,
}

/// Brings up to date what every group is held against. Groups whose own finding and whose others did not change are left
/// as they are.
pub(super) fn hold_against_others(
    context: &mut Context,
    subjects: &[Subject],
    tasks: &[FitTask],
    options: &DiagnoseOptions,
    observer: &dyn Observer,
) -> Result<BTreeSet<String>, PipelineError> {
    let due = due(context, subjects)?;
    let mut saving = Saving::of(|context: &Context| stored_still(context, &due, tasks));
    let making = Making {
        doing: "predicting samples from others",
        at_once: BATCH,
        observer,
        may_go_on: TO_THE_END,
    };
    let load = |context: &Context, due: &Due| -> Result<Vec<Vec<Channel>>, PipelineError> {
        let channels = |&index: &usize| readings::with_climate(context, &tasks[index]);
        due.subject.members.iter().map(channels).collect()
    };
    let make = |due: &Due, channels: Vec<Vec<Channel>>| held(due, tasks, &channels, options);
    making.run(context, &due, load, make, |context, made| {
        let rows: Vec<Row> = made.into_iter().map(|(_, row)| row).collect();
        saving.save(context, &rows, |_| {})
    })?;
    Ok(saving.changed)
}

/// What the findings that are to be held against others were made from, of those that are still the stored ones.
fn stored_still(
    context: &Context,
    due: &[Due],
    tasks: &[FitTask],
) -> Result<BTreeSet<Inputs>, PipelineError> {
    let keys = context.store.result_keys(ResultKind::Group)?;
    let still = due.iter().filter_map(|due| {
        let origin = &due.stored.origin;
        let is_stored = keys.get(&origin.name) == Some(&origin.key);
        is_stored.then(|| (origin.key.clone(), runs_of(due.subject, tasks)))
    });
    Ok(still.collect())
}

fn due<'a>(context: &Context, subjects: &'a [Subject]) -> Result<Vec<Due<'a>>, PipelineError> {
    let stored: Vec<StoredDiagnosis> = context
        .store
        .diagnoses()?
        .into_iter()
        .filter(|stored| stored.kind == ResultKind::Group)
        .collect();
    let found: Vec<GroupDiagnosis> = stored
        .iter()
        .map(|stored| stored.diagnosed.found.clone())
        .collect();
    let runs = standing::speaking(context)?;
    let campaign = &context.campaign;
    let shared = shared_effects(&found, &runs, campaign);
    let mut due = Vec::new();
    for stored in stored {
        let is_it =
            |subject: &&Subject| subject.kind == ResultKind::Group && subject.name == stored.origin.name;
        let Some(subject) = subjects.iter().find(is_it) else {
            continue;
        };
        let mut wanted = Vec::new();
        for effect in &shared {
            let own = effect
                .groups
                .iter()
                .find(|(group, _)| *group == stored.origin.name);
            let values = own.and_then(|(_, sample)| values_without(effect, sample, &found, &runs, campaign));
            let Some(others) = values else {
                continue;
            };
            let mut held = FromOthers {
                effect: effect.effect.clone(),
                variant: effect.variant.clone(),
                samples: others.samples,
                parameters: others.values,
                fall: f64::NAN,
                standard_error: f64::NAN,
                fall_own_strength: f64::NAN,
                made_of: String::new(),
            };
            held.made_of = made_of(&stored.origin.key, &held);
            wanted.push(held);
        }
        let is_same = wanted.len() == stored.diagnosed.found.from_others.len()
            && wanted
                .iter()
                .zip(&stored.diagnosed.found.from_others)
                .all(|(wanted, known)| wanted.made_of == known.made_of);
        if !is_same {
            due.push(Due {
                stored,
                subject,
                wanted,
            });
        }
    }
    Ok(due)
}

fn made_of(input_hash: &str, held: &FromOthers) -> String {
    let mut hash = InputHash::new();
    hash.text(input_hash)
        .text(&held.effect)
        .text_or_none(held.variant.as_deref());
    hash.count(held.samples.len());
    for sample in &held.samples {
        hash.text(sample);
    }
    let values: Vec<f64> = held.parameters.iter().map(|(_, value)| *value).collect();
    hash.numbers(&values).finished()
}

/// The group's row with what came out. An effect that cannot be held against the group is left without a fall.
fn held(due: &Due, tasks: &[FitTask], channels: &[Vec<Channel>], options: &DiagnoseOptions) -> Row {
    let mut found = due.stored.diagnosed.found.clone();
    found.from_others = with_inputs(due.subject, tasks, channels, |inputs| {
        let inputs = &not_condemned(inputs, &due.stored.diagnosed.found);
        let fill = |wanted: &FromOthers| {
            let values: Vec<f64> = wanted.parameters.iter().map(|(_, value)| *value).collect();
            let variant = wanted.variant.as_deref();
            // A fault in a kernel is that effect's failure, not the program's.
            let fall = caught(|| fall_from_others(inputs, options, &wanted.effect, variant, &values));
            let fall = fall.unwrap_or_default();
            FromOthers {
                fall: fall.map_or(f64::NAN, |found| found.fall),
                standard_error: fall.map_or(f64::NAN, |found| found.standard_error),
                fall_own_strength: fall.map_or(f64::NAN, |found| found.fall_own_strength),
                ..wanted.clone()
            }
        };
        due.wanted.iter().map(fill).collect()
    });
    let (origin, diagnosed) = (&due.stored.origin, &due.stored.diagnosed);
    Row {
        kind: due.stored.kind,
        name: origin.name.clone(),
        made_from: runs_of(due.subject, tasks),
        key: origin.key.clone(),
        made_by: origin.made_by.clone(),
        diagnosed: Diagnosed {
            found,
            ..diagnosed.clone()
        },
    }
}
