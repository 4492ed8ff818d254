//! The current findings of a campaign: of groups and of single runs, those of runs that speak.

use std::collections::{BTreeMap, BTreeSet};

use crate::analysis::false_discovery::judge_together;
use crate::analysis::online::{OnlineDecision, online_decisions};
use crate::domain::{GroupDiagnosis, RunRecord, Verdict};
use crate::model::effects::summary;
use crate::pipeline::campaign::standing;
use crate::pipeline::{Context, PipelineError};
use crate::store::{ResultKind, StoredDiagnosis};

/// The current findings, with what holds over the whole campaign: of groups, and of single runs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CurrentFindings {
    /// Of groups, by name.
    pub groups: Vec<GroupDiagnosis>,
    /// Of single runs, by name.
    pub runs: Vec<GroupDiagnosis>,
    /// What could be claimed of every single run when it came, by name.
    pub turns: BTreeMap<String, OnlineDecision>,
}

/// Reads the current findings and judges each kind together.
///
/// # Errors
/// The database cannot be read.
pub fn current_findings(context: &Context) -> Result<CurrentFindings, PipelineError> {
    findings_among(context, &standing::all(context)?)
}

/// The same where all runs with their standing were read already.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn findings_among(
    context: &Context,
    known: &[RunRecord],
) -> Result<CurrentFindings, PipelineError> {
    let (groups, runs): (Vec<_>, Vec<_>) = context
        .store
        .diagnoses()?
        .into_iter()
        .partition(|stored| stored.kind == ResultKind::Group);
    let silent: BTreeSet<&str> = (known.iter().filter(|run| !run.standing.speaks()))
        .map(|run| run.path.as_str())
        .collect();
    // What was found in readings that are set aside since is no finding any more; that they allow none remains true.
    let holds = |found: &GroupDiagnosis| {
        found.verdict == Verdict::DataProblem || !found.runs.iter().any(|run| silent.contains(run.as_str()))
    };
    let found = |stored: Vec<StoredDiagnosis>| -> Vec<GroupDiagnosis> {
        stored
            .into_iter()
            .map(|stored| stored.diagnosed.found)
            .filter(holds)
            .collect()
    };
    let mut findings = CurrentFindings {
        groups: found(groups),
        runs: found(runs),
        turns: BTreeMap::new(),
    };
    findings.turns = turns_of(known.iter().collect(), &findings.runs);
    judge_together(&mut findings.groups, &summary);
    judge_together(&mut findings.runs, &summary);
    Ok(findings)
}

/// Tests the runs in the order in which they were stored. Runs that were stored again count as new.
fn turns_of(mut runs: Vec<&RunRecord>, found: &[GroupDiagnosis]) -> BTreeMap<String, OnlineDecision> {
    let p: BTreeMap<&str, f64> = found
        .iter()
        .filter_map(|found| Some((found.group.as_str(), found.p_misfit?)))
        .collect();
    runs.sort_by_key(|run| run.id);
    let (paths, p): (Vec<String>, Vec<f64>) = runs
        .into_iter()
        .filter_map(|run| Some((p.get(run.path.as_str()).copied()?, run.path.clone())))
        .map(|(p, path)| (path, p))
        .unzip();
    paths.into_iter().zip(online_decisions(&p)).collect()
}
