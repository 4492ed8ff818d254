//! Files that current runs were read from, each with what it gave; and runs that others take the place of.

use std::sync::Arc;

use rusqlite::params;

use super::insert_run::supersede;
use super::new_run::{NewRun, RunRow};
use super::{StepError, Store, StoreError, Transaction};
use ieap_domain::{ChannelSummary, Quantity, RunClock, RunKind, StartedAt};

/// A file of a current run.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadFile {
    /// The run's name.
    pub run: String,
    /// The file, relative, with `/`.
    pub path: String,
    /// How many files the run has.
    pub files: usize,
    /// Quantities that it gave.
    pub quantities: Vec<Quantity>,
    /// First and last time of its readings on its own clock, s; none without readings.
    pub times_s: Option<(f64, f64)>,
    /// The date and time that it states.
    pub stamp: Option<StartedAt>,
}

impl Store {
    /// The files of current actuation runs, by run and in the order of its files.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn read_files(&self) -> Result<Vec<ReadFile>, StoreError> {
        let runs = self.current_rows(RunKind::Actuation)?;
        let of = |run: &Arc<RunRow>| -> Vec<ReadFile> {
            let clocks = run.reading.origin.clocks.iter();
            clocks.map(|clock| read_file(run, clock)).collect()
        };
        Ok(runs.iter().flat_map(of).collect())
    }
}

fn read_file(run: &RunRow, clock: &RunClock) -> ReadFile {
    let channels = run.reading.channels.iter().skip(clock.first_channel);
    let channels: Vec<&ChannelSummary> = channels
        .take(clock.channels)
        .map(|channel| &channel.summary)
        .collect();
    let mut quantities: Vec<Quantity> = Vec::new();
    for channel in &channels {
        if !quantities.contains(&channel.quantity) {
            quantities.push(channel.quantity);
        }
    }
    let first_s = channels
        .iter()
        .filter_map(|channel| channel.first_time_s)
        .reduce(f64::min);
    let last_s = channels
        .iter()
        .filter_map(|channel| channel.last_time_s)
        .reduce(f64::max);
    ReadFile {
        run: run.path.clone(),
        path: clock.file.clone(),
        files: run.reading.files.len(),
        quantities,
        times_s: first_s.zip(last_s),
        stamp: clock.stamp.clone(),
    }
}

/// Retires the current runs whose place these take: a half of a run that is joined now, or a joined run whose files are
/// runs of their own now.
pub(super) fn supersede_parts(
    transaction: &Transaction<'_>,
    now: &str,
    runs: &[NewRun],
) -> Result<(), StepError> {
    let Some(first) = runs.first() else {
        return Ok(());
    };
    for content in &first.contents {
        let sql = "SELECT run.path FROM run JOIN run_file ON run_file.run_id = run.id
                   WHERE run_file.path = ?1 AND superseded_at IS NULL AND kind = ?2
                     AND (?3 OR (SELECT count(*) FROM run_file WHERE run_id = run.id) > 1)";
        let mut statement = transaction.prepare_cached(sql)?;
        let several = first.contents.len() > 1;
        let rows = statement.query_map(params![content.path, first.kind.key(), several], |row| row.get(0))?;
        let found: Vec<String> = rows.collect::<Result<_, _>>()?;
        for name in found
            .iter()
            .filter(|name| runs.iter().all(|run| run.path != **name))
        {
            supersede(transaction, now, name)?;
        }
    }
    Ok(())
}
