//! Hashes of everything that a diagnosis depends on.

use super::subject::Subject;
use crate::diagnose::{self, DiagnoseOptions};
use crate::domain::InputHash;
use crate::pipeline::campaign::group_tags::take_tags;
use crate::pipeline::fits::input_hash::take_task;
use crate::store::FitTask;

/// Hash of readings, of the climate that was logged beside them, drives, dimensions, names, tags that differ, base model, library, seed, draws,
/// tolerance and versions.
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
            hash.text_or_none(tasks[member].climate_hash.as_deref());
        }
    }
    take_tags(&mut hash, &subject.tags);
    let model = options.model;
    hash.text(model.id)
        .whole(model.version.into())
        .whole(options.seed)
        .count(options.draws)
        .number(options.tolerance_percent)
        .text(library)
        .whole(diagnose::VERSION.into())
        .text_or_none(subject.set_apart.as_ref().map(|issue| issue.message.as_str()));
    hash.finished()
}
