//! Runs as results are made from them: the one place where they are read from the database for that. Whoever makes results
//! takes [`speaking`]; lists of runs show the others with the reason.

use std::collections::BTreeMap;

use serde_json::json;

use crate::analysis::standing::{Grounds, decide};
pub use crate::domain::SetAside;
use crate::domain::{Campaign, ModulusLog, RunRecord, Sample, Standing};
use crate::pipeline::{Context, PipelineError};
use crate::store::PublishedRows;

/// Runs, by whether results are made from them; each by path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Runs {
    /// Those that results are made from.
    pub speaking: Vec<RunRecord>,
    /// The others.
    pub set_aside: Vec<RunRecord>,
}

impl Runs {
    /// Of all runs.
    pub(crate) fn of(all: Vec<RunRecord>) -> Runs {
        let (speaking, set_aside) = all.into_iter().partition(|run| run.standing.speaks());
        Runs { speaking, set_aside }
    }
}

/// The material of every sample, as rows for who asks the database in SQL: what a run is of is known before any report.
pub(crate) fn shown_samples(campaign: &Campaign) -> PublishedRows {
    let row = |sample: &Sample| json!({ "sample": sample.id, "material": sample.material }).to_string();
    ("sample", campaign.samples.iter().map(row).collect())
}

/// Every current actuation run with its standing, by path.
///
/// # Errors
/// The database cannot be read.
pub fn all(context: &Context) -> Result<Vec<RunRecord>, PipelineError> {
    let diagnosed = context.store.condemned_by_diagnosis()?;
    decided(context, context.store.runs()?, Some(&diagnosed))
}

/// The same, by whether they speak.
///
/// # Errors
/// The database cannot be read.
pub fn runs(context: &Context) -> Result<Runs, PipelineError> {
    Ok(Runs::of(all(context)?))
}

/// The runs that results are made from.
///
/// # Errors
/// The database cannot be read.
pub fn speaking(context: &Context) -> Result<Vec<RunRecord>, PipelineError> {
    Ok(runs(context)?.speaking)
}

/// The runs that a diagnosis is made from: it judges itself which of them it condemns.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn to_diagnose(context: &Context) -> Result<Vec<RunRecord>, PipelineError> {
    to_diagnose_of(context, context.store.runs()?)
}

/// The same where all runs were read already, with a standing or without.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn to_diagnose_of(
    context: &Context,
    all: Vec<RunRecord>,
) -> Result<Vec<RunRecord>, PipelineError> {
    Ok(Runs::of(decided(context, all, None)?).speaking)
}

/// The runs that results are made from once diagnoses that are due have condemned those of `ahead`: row id and reason.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn speaking_without(
    context: &Context,
    ahead: BTreeMap<i64, String>,
) -> Result<Vec<RunRecord>, PipelineError> {
    let mut diagnosed = context.store.condemned_by_diagnosis()?;
    diagnosed.extend(ahead);
    Ok(Runs::of(decided(context, context.store.runs()?, Some(&diagnosed))?).speaking)
}

/// Runs as they were, those of them that speak now: what is found out about readings is true of their earlier fits too.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn speaking_earlier(
    context: &Context,
    earlier: &crate::store::Earlier,
) -> Result<Vec<RunRecord>, PipelineError> {
    let now: BTreeMap<String, Standing> = (all(context)?.into_iter())
        .map(|run| (run.path, run.standing))
        .collect();
    let mut runs = context.store.runs_earlier(earlier)?;
    runs.retain(|run| now.get(&run.path).is_none_or(Standing::speaks));
    Ok(runs)
}

fn decided(
    context: &Context,
    mut runs: Vec<RunRecord>,
    diagnosed: Option<&BTreeMap<i64, String>>,
) -> Result<Vec<RunRecord>, PipelineError> {
    let grounds = Grounds {
        campaign: &context.campaign,
        words: &context.store.run_words()?,
        same: &context.store.same_readings()?,
        diagnosed,
    };
    decide(&mut runs, &grounds);
    Ok(runs)
}

/// Impedance spectra, those that results are made from and the others. Only a person sets one aside.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn spectra(context: &Context) -> Result<Runs, PipelineError> {
    let words = context.store.run_words()?;
    let mut spectra = context.store.spectra()?;
    for run in &mut spectra {
        if let Some(word) = words.get(&run.path).filter(|word| word.drops) {
            run.standing = Standing::Dropped(word.clone());
        }
    }
    Ok(Runs::of(spectra))
}

/// Modulus logs, those that results are made from and the others. Only a person sets one aside.
///
/// # Errors
/// The database cannot be read.
pub fn modulus_logs(context: &Context) -> Result<(Vec<ModulusLog>, Vec<ModulusLog>), PipelineError> {
    split_logs(context, context.store.modulus_logs()?)
}

/// The same for logs as they were.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn split_logs(
    context: &Context,
    mut logs: Vec<ModulusLog>,
) -> Result<(Vec<ModulusLog>, Vec<ModulusLog>), PipelineError> {
    let words = context.store.run_words()?;
    for log in &mut logs {
        if let Some(word) = words.get(&log.run.path).filter(|word| word.drops) {
            log.run.standing = Standing::Dropped(word.clone());
        }
    }
    Ok(logs.into_iter().partition(|log| log.run.standing.speaks()))
}
