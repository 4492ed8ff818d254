//! Files that current runs were read from, each with what it gave; and runs that others take the place of.

use rusqlite::params;

use super::columns::count_in;
use super::new_run::{NewRun, supersede};
use super::origin::read_stamp;
use super::{StepError, Store, StoreError, Subject, Transaction};
use ieap_domain::{Quantity, StartedAt};

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
        let sql =
            "SELECT run.path AS run, file, stamp_raw, stamp_kind, stamp_local, stamp_offset, stamp_basis,
                     (SELECT count(*) FROM run_file WHERE run_id = run.id) AS files,
                     group_concat(DISTINCT channel.quantity) AS quantities,
                     min(first_time_s) AS first_s, max(last_time_s) AS last_s
                   FROM run JOIN run_clock ON run_clock.run_id = run.id
                     LEFT JOIN channel ON channel.run_id = run.id AND channel.ordinal >= first_channel
                       AND channel.ordinal < first_channel + run_clock.channels
                   WHERE superseded_at IS NULL AND kind = 'actuation'
                   GROUP BY run.id, run_clock.ordinal ORDER BY run.path, run_clock.ordinal";
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Runs)?;
        self.rows("listing the files of runs", sql, [], |row| {
            let quantities: Option<String> = row.get("quantities")?;
            let known = quantities.iter().flat_map(|keys| keys.split(','));
            let (first_s, last_s): (Option<f64>, Option<f64>) = (row.get("first_s")?, row.get("last_s")?);
            Ok(ReadFile {
                run: row.get("run")?,
                path: row.get("file")?,
                files: count_in(row, "files")?,
                quantities: known.filter_map(Quantity::from_key).collect(),
                times_s: first_s.zip(last_s),
                stamp: read_stamp(row)?,
            })
        })
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
