//! Which groups wait for a diagnosis.

use super::choice::DiagnoseChoice;
use super::input_hash::input_hash;
use super::subject::subjects;
use crate::diagnose::DiagnoseOptions;
use crate::domain::RunRecord;
use crate::pipeline::campaign::standing;
use crate::pipeline::fits::input_hash::library_hash;
use crate::pipeline::{Context, PipelineError};
use crate::store::ResultKind;

/// Groups whose finding is not that of their runs as they are.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Waiting {
    /// Groups that were never diagnosed.
    pub missing: Vec<String>,
    /// Groups whose runs, tags, base model or library of effects changed since.
    pub outdated: Vec<String>,
}

/// Compares what every group of these runs, which are all, depends on with what its finding was made from. Seed and draws
/// may be any.
///
/// # Errors
/// The model of campaign.toml is not known, or the database cannot be read.
pub fn waiting(context: &Context, all: Vec<RunRecord>) -> Result<Waiting, PipelineError> {
    let options = DiagnoseChoice::default().options(&context.campaign)?;
    let tasks = context.store.fit_tasks()?;
    let (all, _) = subjects(context, &tasks, &standing::to_diagnose_of(context, all)?);
    let stored = context.store.diagnoses()?;
    let library = library_hash();
    let mut waiting = Waiting::default();
    for subject in all.iter().filter(|subject| subject.kind == ResultKind::Group) {
        let found = stored
            .iter()
            .find(|found| found.kind == subject.kind && found.origin.name == subject.name);
        match found {
            None => waiting.missing.push(subject.name.clone()),
            Some(found) => {
                let as_then = DiagnoseOptions {
                    seed: found.diagnosed.seed,
                    draws: found.diagnosed.draws,
                    ..options
                };
                if input_hash(subject, &tasks, &as_then, &library) != found.origin.key {
                    waiting.outdated.push(subject.name.clone());
                }
            }
        }
    }
    Ok(waiting)
}
