//! Analyses every modulus log that is not analysed yet, or whose readings or column tags changed.

use std::collections::BTreeSet;

use crate::analysis::dma;
use crate::domain::tag::keys;
use crate::domain::{Channel, InputHash, Issue, ModulusAnalysis, RunRecord, RunState, Tag};
use crate::ingest::named_columns::named_columns;
use crate::pipeline::campaign::derived::{Derived, Made, MadeOf, bring_up_to_date, in_rounds, sorted};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::ResultKind;

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
    /// Logs that are left for the next call: what their analyses depend on changed each time that they were made.
    pub changing: Vec<String>,
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
        let mut analysed = BTreeSet::new();
        let mut count = 0;
        let changing = in_rounds(Modulus::DOING, observer, |is_first| {
            let logs = Modulus.subjects(context)?;
            count = logs.len();
            let due = sorted(&Modulus, context, logs, self.again && is_first)?.due;
            bring_up_to_date(&Modulus, context, &due, observer, |_, log, made| {
                if made.is_ok() {
                    analysed.insert(log.to_owned());
                }
                observer.say(&format!("analysed {log}"));
            })
        })?;
        let failed = failed(context)?;
        let not_up_to_date = analysed.len() + failed.len() + changing.len();
        Ok(ModulusSummary {
            analysed: analysed.len(),
            up_to_date: count.saturating_sub(not_up_to_date),
            failed,
            changing,
        })
    }
}

/// A modulus log as it is analysed.
struct Log {
    run_id: i64,
    path: String,
    /// Hash of the readings as they are used.
    readings: String,
    /// The tags that say what its columns measure.
    columns: Vec<Tag>,
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

    /// Logs that can be analysed.
    fn subjects(&self, context: &Context) -> Result<Vec<Log>, PipelineError> {
        let _moment = context.store.snapshot()?;
        let mut readings = context.store.readings_hashes()?;
        let logs = context.store.dma_logs()?.into_iter();
        let ready = logs.filter(|log| log.state == RunState::Ready);
        let read = |log: RunRecord| {
            Some(Log {
                run_id: log.id,
                readings: readings.remove(&log.id)?,
                columns: column_tags(&log),
                path: log.path,
            })
        };
        Ok(ready.filter_map(read).collect())
    }

    fn runs<'s>(&self, log: &'s Log) -> Vec<MadeOf<'s>> {
        let (run_id, name) = (log.run_id, log.path.as_str());
        vec![MadeOf { run_id, name }]
    }

    fn key(&self, log: &Log) -> String {
        let mut hash = InputHash::new();
        hash.whole(dma::VERSION.into()).text(&log.readings);
        for tag in &log.columns {
            hash.text(&tag.key).text(&tag.value);
        }
        hash.finished()
    }

    fn load(&self, context: &Context, log: &Log) -> Result<Vec<Channel>, PipelineError> {
        Ok(context.store.channels(log.run_id)?)
    }

    fn make(&self, log: &Log, channels: Vec<Channel>) -> Vec<Made<ModulusAnalysis>> {
        let (channels, _) = named_columns(&channels, &log.columns);
        vec![dma::analyse(&channels)]
    }

    fn fault(&self, reason: &str) -> Issue {
        let issue = Issue::fault(FAULT, "the analysis", reason);
        issue.mend("report it with this log; the other logs are not affected")
    }
}

/// The chosen tag of each key that says what a column measures: the first of it.
fn column_tags(log: &RunRecord) -> Vec<Tag> {
    let mut seen = BTreeSet::new();
    let tags = log.tags.iter().filter(|tag| tag.key.ends_with(keys::COLUMN));
    tags.filter(|tag| seen.insert(&tag.key)).cloned().collect()
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
