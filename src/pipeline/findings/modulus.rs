//! Analyses every modulus log that is not analysed yet, or whose readings or column tags changed.

use crate::analysis::dma;
use crate::domain::fault::caught;
use crate::domain::tag::keys;
use crate::domain::{Channel, InputHash, Issue, ModulusAnalysis, RunRecord, RunState};
use crate::ingest::named_columns::named_columns;
use crate::pipeline::campaign::batch::{Making, TO_THE_END};
use crate::pipeline::campaign::context::{CODE_VERSION, now};
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::ModulusStamp;

/// Logs whose readings are in memory at once.
const BATCH: usize = 8;

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
        let logs = context.store.dma_logs()?;
        let ready: Vec<RunRecord> = (logs.into_iter())
            .filter(|log| log.state == RunState::Ready)
            .collect();
        let (mut summary, count) = (ModulusSummary::default(), ready.len());
        let mut due = Vec::new();
        for log in ready {
            let hash = input_hash(&log);
            if self.again || context.store.modulus_input_hash(log.id)?.as_ref() != Some(&hash) {
                due.push((log, hash));
            }
        }
        let making = Making {
            doing: "analysing modulus logs",
            at_once: BATCH,
            observer,
            may_go_on: TO_THE_END,
        };
        let load = |context: &Context, (log, _): &(RunRecord, String)| Ok(context.store.channels(log.id)?);
        let make = |(log, _): &(RunRecord, String), channels: Vec<Channel>| analyse(log, &channels);
        making.run(context, &due, load, make, |context, made| {
            for ((log, input_hash), found) in made {
                summary.analysed += usize::from(found.is_ok());
                store(context, log, input_hash, found)?;
                observer.say(&format!("analysed {}", log.path));
            }
            Ok(())
        })?;
        summary.failed = failed(context)?;
        summary.up_to_date = count - summary.analysed - summary.failed.len();
        Ok(summary)
    }
}

/// BLAKE3 over everything that an analysis depends on.
fn input_hash(log: &RunRecord) -> String {
    let mut hash = InputHash::new();
    hash.whole(dma::VERSION.into()).text(&log.data_hash);
    let counts = |key: &str| key.ends_with(keys::COLUMN) || key == keys::LEAVE_OUT;
    for tag in log.tags.iter().filter(|tag| counts(&tag.key)) {
        hash.text(&tag.key).text(&tag.value);
    }
    hash.finished()
}

/// A fault of the analysis stops its log only.
fn analyse(log: &RunRecord, channels: &[Channel]) -> Result<ModulusAnalysis, Issue> {
    let chosen = chosen_tags(log);
    let (channels, _) = named_columns(channels, &chosen);
    caught(|| dma::analyse(&channels)).unwrap_or_else(|reason| {
        let issue = Issue::fault(FAULT, "the analysis", &reason);
        Err(issue.mend("report it with this log; the other logs are not affected"))
    })
}

/// The chosen tag of each key: the first of it.
fn chosen_tags(log: &RunRecord) -> Vec<crate::domain::Tag> {
    let mut seen = std::collections::BTreeSet::new();
    let tags = log.tags.iter();
    tags.filter(|tag| seen.insert(tag.key.clone())).cloned().collect()
}

fn store(
    context: &mut Context,
    log: &RunRecord,
    input_hash: &str,
    found: Result<ModulusAnalysis, Issue>,
) -> Result<(), PipelineError> {
    let stamp = ModulusStamp {
        run_id: log.id,
        input_hash: input_hash.to_owned(),
        code_version: CODE_VERSION.to_owned(),
    };
    Ok(context
        .store
        .save_modulus_analysis(&now(), &stamp, found.as_ref())?)
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
