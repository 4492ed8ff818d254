//! Analyses every modulus log that is not analysed yet, or whose readings or column tags changed.

use std::collections::BTreeSet;

use crate::analysis::dma;
use crate::domain::tag::keys;
use crate::domain::{Channel, InputHash, Issue, ModulusAnalysis, RunRecord, RunState};
use crate::ingest::named_columns::named_columns;
use crate::pipeline::campaign::derived::{Anew, Derived, Made, bring_up_to_date, sorted};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::{ResultKind, RunThen};

/// The verb `dma`.
#[derive(Debug, Clone, Copy, Default)]
pub struct AnalyseModulus {
    /// Analyse again even where nothing changed.
    pub again: bool,
}

/// What `dma` did.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct ModulusSummary {
    /// Logs analysed.
    pub analysed: usize,
    /// Logs whose analysis was up to date.
    pub up_to_date: usize,
    /// Logs that could not be analysed, now or before, with the reason.
    pub failed: Vec<(String, Issue)>,
}

impl ModulusSummary {
    /// Whether a fault of the program stopped an analysis, now or before.
    pub fn has_fault(&self) -> bool {
        self.failed.iter().any(|(_, issue)| issue.code == FAULT)
    }
}

/// Code of what is said of a log whose analysis a fault of the program stopped.
const FAULT: &str = "analysis-fault";

impl AnalyseModulus {
    /// Analyses what is missing or out of date. The outcome does not depend on the number of threads.
    ///
    /// # Errors
    /// The database fails; a log that cannot be analysed is no error.
    pub fn run(
        &self,
        context: &mut Context,
        observer: &dyn Observer,
    ) -> Result<ModulusSummary, PipelineError> {
        let mut summary = ModulusSummary::default();
        let mut analysed = BTreeSet::new();
        let mut again = self.again;
        loop {
            let logs = logs(context)?;
            let count = logs.len();
            let due = sorted(&Modulus, context, logs, again)?.due;
            let anew = bring_up_to_date(&Modulus, context, &due, observer, |_, log, made| {
                if made.is_ok() {
                    analysed.insert(log.to_owned());
                }
                observer.say(&format!("analysed {log}"));
            })?;
            if anew == Anew::No {
                summary.failed = failed(context)?;
                summary.analysed = analysed.len();
                summary.up_to_date = count.saturating_sub(summary.analysed + summary.failed.len());
                return Ok(summary);
            }
            again = false;
        }
    }
}

/// A modulus log, and what it is ([`FitTask::state`](crate::store::FitTask::state)).
type Log = (RunRecord, String);

/// Logs that can be analysed.
fn logs(context: &Context) -> Result<Vec<Log>, PipelineError> {
    let _moment = context.store.snapshot()?;
    let mut states = context.store.states_of_runs()?;
    let logs = context.store.dma_logs()?.into_iter();
    let ready = logs.filter(|log| log.state == RunState::Ready);
    let with_state = |log: RunRecord| {
        let state = states.remove(&log.id)?;
        Some((log, state))
    };
    Ok(ready.filter_map(with_state).collect())
}

/// Analyses of modulus logs.
struct Modulus;

impl Derived for Modulus {
    type Subject = Log;
    type Readings = Vec<Channel>;
    type Found = ModulusAnalysis;
    const KIND: ResultKind = ResultKind::Modulus;
    const DOING: &'static str = "analysing modulus logs";
    const AT_ONCE: usize = 8;

    fn runs<'s>(&self, (log, state): &'s Log) -> Vec<RunThen<'s>> {
        let (run_id, name) = (log.id, &log.path);
        vec![RunThen { run_id, name, state }]
    }

    fn key(&self, (log, _): &Log) -> String {
        let mut hash = InputHash::new();
        hash.whole(dma::VERSION.into()).text(&log.data_hash);
        let counts = |key: &str| key.ends_with(keys::COLUMN) || key == keys::LEAVE_OUT;
        for tag in log.tags.iter().filter(|tag| counts(&tag.key)) {
            hash.text(&tag.key).text(&tag.value);
        }
        hash.finished()
    }

    fn load(&self, context: &Context, (log, _): &Log) -> Result<Vec<Channel>, PipelineError> {
        Ok(context.store.channels(log.id)?)
    }

    fn make(&self, (log, _): &Log, channels: Vec<Channel>) -> Vec<Made<ModulusAnalysis>> {
        let (channels, _) = named_columns(&channels, &chosen_tags(log));
        vec![dma::analyse(&channels)]
    }

    fn fault(&self, reason: &str) -> Issue {
        let issue = Issue::fault(FAULT, "the analysis", reason);
        issue.mend("report it with this log; the other logs are not affected")
    }
}

/// The chosen tag of each key: the first of it.
fn chosen_tags(log: &RunRecord) -> Vec<crate::domain::Tag> {
    let mut seen = std::collections::BTreeSet::new();
    let tags = log.tags.iter();
    tags.filter(|tag| seen.insert(tag.key.clone())).cloned().collect()
}

/// Ready logs without an analysis, with the reason.
fn failed(context: &Context) -> Result<Vec<(String, Issue)>, PipelineError> {
    let logs = context.store.modulus_logs()?.into_iter();
    let failed = logs.filter(|log| log.analysis.is_none() && log.run.state == RunState::Ready);
    Ok(failed
        .filter_map(|log| {
            let worst = log.run.issues.iter().max_by_key(|issue| issue.severity)?;
            Some((log.run.path.clone(), worst.clone()))
        })
        .collect())
}
