//! What the diagnoses that are due will condemn: an alarm waits for that, and for nothing else of them.

use std::collections::{BTreeMap, BTreeSet};

use super::choice::DiagnoseChoice;
use super::input_hash::input_hash;
use super::inputs::with_inputs;
use super::subject::{Subject, subjects};
use crate::diagnose::condemned;
use crate::domain::fault::caught;
use crate::numerics::interrupt;
use crate::pipeline::campaign::{readings, standing};
use crate::pipeline::fits::input_hash::library_hash;
use crate::pipeline::{Context, PipelineError};
use crate::store::ResultKind;

/// The runs that diagnoses will condemn of the groups of `runs` (by path) whose findings are not up to date: row id and
/// reason. Where a fault of the program stops the question nothing is known; the diagnosis tells of the fault.
///
/// # Errors
/// The model of campaign.toml is not known, or the database cannot be read.
pub(crate) fn condemned_ahead(
    context: &Context,
    choice: &DiagnoseChoice,
    runs: &BTreeSet<String>,
) -> Result<BTreeMap<i64, String>, PipelineError> {
    let options = choice.options(&context.campaign)?;
    let tasks = context.store.fit_tasks()?;
    let (all, _) = subjects(context, &tasks, &standing::to_diagnose(context)?);
    let (stored, library) = (context.store.diagnoses()?, library_hash());
    let is_due = |subject: &&Subject| {
        let found = stored
            .iter()
            .find(|found| found.kind == subject.kind && found.origin.name == subject.name);
        found.is_none_or(|found| found.origin.key != input_hash(subject, &tasks, &options, &library))
    };
    let is_asked = |subject: &&Subject| {
        let mut paths = subject.members.iter().map(|&member| &tasks[member].path);
        subject.kind == ResultKind::Group
            && subject.set_apart.is_none()
            && paths.any(|path| runs.contains(path))
    };
    let mut found = BTreeMap::new();
    for subject in all.iter().filter(is_asked).filter(is_due) {
        interrupt::check();
        let channels = subject.members.iter();
        let channels = channels.map(|&member| readings::with_climate(context, &tasks[member]));
        let channels = channels.collect::<Result<Vec<_>, _>>()?;
        let odd = caught(|| {
            with_inputs(subject, &tasks, &channels, |inputs| {
                condemned(inputs, options.model)
            })
        });
        for odd in odd.unwrap_or_default() {
            let task = tasks.iter().find(|task| task.path == odd.run);
            found.extend(task.map(|task| (task.run_id, odd.reason)));
        }
    }
    Ok(found)
}
