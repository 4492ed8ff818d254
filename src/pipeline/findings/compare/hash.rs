//! What a comparison depends on.

use crate::domain::InputHash;
use crate::fit::MOVING_VERSION;
use crate::model::FitModel;
use crate::store::FitTask;

/// Version of how models are held against each other: which parts are held out, how scores are made.
const VERSION: u32 = 1;

/// Hash of everything that the comparisons of a group depend on: its runs predict each other.
pub(super) fn input_hash(tasks: &[FitTask], models: &[&'static FitModel]) -> String {
    let mut hash = InputHash::new();
    hash.whole(VERSION.into());
    for task in tasks {
        hash.text(&task.path).text(&task.data_hash).drive(&task.drive);
        hash.number(task.area_cm2).number_or_none(task.length_cm);
    }
    // Where none moves the form is that of comparisons before it could be.
    if tasks.iter().any(|task| task.drive.moves()) {
        hash.whole(MOVING_VERSION.into());
    }
    for model in models {
        hash.text(model.id).whole(model.version.into());
    }
    hash.finished()
}
