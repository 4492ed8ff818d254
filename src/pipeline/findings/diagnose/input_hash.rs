//! Hashes of everything that a diagnosis depends on.

use super::subject::Subject;
use crate::diagnose::{self, DiagnoseOptions};
use crate::domain::InputHash;
use crate::model::effects;
use crate::pipeline::campaign::group_tags::take_tags;
use crate::store::FitTask;

/// Hash of the library of effects: ids, forms, parameters with units, equations, limits.
pub(crate) fn library_hash() -> String {
    let mut hash = InputHash::new();
    for effect in effects::ALL {
        let about = effect.about();
        for text in [about.id, about.code, about.equation, about.vanishes] {
            hash.text(text);
        }
        hash.count(about.variants.len());
        for variant in about.variants {
            hash.text(variant);
        }
        hash.count(about.parameters.len());
        for parameter in about.parameters {
            hash.text(parameter.key).text(parameter.unit);
        }
    }
    hash.finished()
}

/// Adds what a run of a group is known by: name, readings, drive, dimensions.
pub(crate) fn take_task(hash: &mut InputHash, task: &FitTask) {
    hash.text(&task.path)
        .text(&task.data_hash)
        .drive(&task.drive)
        .number(task.area_cm2)
        .number_or_none(task.length_cm)
        .number_or_none(task.electrode_resistance_ohm_per_sq);
}

/// Hash of readings, drives, dimensions, names, tags that differ, base model, library, seed, draws, versions, and of whether a run is alone.
pub(super) fn input_hash(
    subject: &Subject,
    tasks: &[FitTask],
    options: &DiagnoseOptions,
    library: &str,
) -> String {
    let mut hash = InputHash::new();
    for members in [&subject.members, &subject.right] {
        hash.count(members.len());
        for &member in members {
            take_task(&mut hash, &tasks[member]);
        }
    }
    take_tags(&mut hash, &subject.tags);
    let model = options.model;
    hash.text(model.id)
        .whole(model.version.into())
        .whole(options.seed)
        .count(options.draws)
        .text(library)
        .whole(diagnose::VERSION.into())
        .flag(subject.of_several)
        .text_or_none(subject.set_apart.as_ref().map(|issue| issue.message.as_str()));
    hash.finished()
}
