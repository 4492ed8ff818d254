//! Files whose bytes lie under other names: all that one look found, in one step, for names may have been exchanged.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::params;

use super::files::{forget, upsert_file};
use super::journal::{Entry, MovedFile, NamedBytes};
use super::measurement::{free_name, put_by, rename_rows};
use super::rows::CLIMATE_LOG;
use super::{FileRow, StepError, Store, StoreError, Transaction};

/// A file of a current run or climate log, and the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeldFile {
    /// Name of the run; of a log its path.
    pub run: String,
    /// Path of the file.
    pub path: String,
    /// BLAKE3 of its bytes.
    pub hash: String,
    /// Their number.
    pub size_bytes: u64,
}

/// What one look found of files under other names.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moves {
    /// Each file by its path before, as it is now.
    pub files: BTreeMap<String, FileRow>,
    /// Names of runs before and now.
    pub runs: Vec<(String, String)>,
}

/// Stands at the end of names that are given within the step alone.
const PASSING: char = '\u{1}';

impl Store {
    /// The files of all current runs, modulus logs and climate logs.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn held_files(&self) -> Result<Vec<HeldFile>, StoreError> {
        let _moment = self.snapshot()?;
        let runs = self.all_current_rows()?;
        let of_runs = runs.iter().flat_map(|run| {
            run.reading.files.iter().map(|file| HeldFile {
                run: run.path.clone(),
                path: file.path.clone(),
                hash: file.hash.clone(),
                size_bytes: file.size_bytes,
            })
        });
        let mut held: Vec<HeldFile> = of_runs.collect();
        let sql = "SELECT path, content.hash, size_bytes FROM climate_log JOIN content ON content.hash = climate_log.hash
                   WHERE superseded_at IS NULL ORDER BY path";
        let of_logs = self.rows("listing files of climate logs", sql, [], |row| {
            Ok(HeldFile {
                run: row.get("path")?,
                path: row.get("path")?,
                hash: row.get("hash")?,
                size_bytes: row.get::<_, i64>("size_bytes")?.unsigned_abs(),
            })
        })?;
        held.extend(of_logs);
        Ok(held)
    }

    /// Names runs, logs and their files after the files that hold their bytes now. What had such a name and is not among them
    /// is current no more.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn move_files(&mut self, now: &str, moves: &Moves) -> Result<(), StoreError> {
        self.write("naming runs after their files", now, |transaction| {
            let files: Vec<(&str, &str)> = (moves.files.iter())
                .map(|(old, row)| (old.as_str(), row.path.as_str()))
                .collect();
            rename_runs(transaction, now, &moves.runs, &files)?;
            rename_logs(transaction, now, &files)?;
            let taken: BTreeSet<&str> = files.iter().map(|(_, new)| *new).collect();
            let freed = moves.files.keys().filter(|old| !taken.contains(old.as_str()));
            freed.into_iter().try_for_each(|old| forget(transaction, old))?;
            moves
                .files
                .values()
                .try_for_each(|row| upsert_file(transaction, row))?;
            let moved = |(old, row): (&String, &FileRow)| MovedFile {
                old: old.clone(),
                now: NamedBytes {
                    path: row.path.clone(),
                    hash: row.hash.clone().unwrap_or_default(),
                },
            };
            let entry = Entry::Moved {
                files: moves.files.iter().map(moved).collect(),
                runs: moves.runs.clone(),
            };
            transaction.says(now, entry)
        })
    }
}

fn rename_runs(
    transaction: &Transaction<'_>,
    now: &str,
    runs: &[(String, String)],
    files: &[(&str, &str)],
) -> Result<(), StepError> {
    // Under a name of its own each first, so that two may exchange theirs.
    for (old, _) in runs {
        rename_rows(transaction, old, &passing(old), &[])?;
    }
    for (_, new) in runs {
        put_by(transaction, now, new)?;
    }
    for (old, new) in runs {
        rename_rows(transaction, &passing(old), new, files)?;
    }
    Ok(())
}

fn passing(name: &str) -> String {
    format!("{name}{PASSING}")
}

/// The same of climate logs, which are named by their files.
fn rename_logs(transaction: &Transaction<'_>, now: &str, files: &[(&str, &str)]) -> Result<(), StepError> {
    let moved: Vec<(&str, &str)> = {
        let mut statement =
            transaction.prepare_cached("SELECT EXISTS (SELECT 1 FROM climate_log WHERE path = ?1)")?;
        let mut moved = Vec::new();
        for (old, new) in files {
            if statement.query_row([old], |row| row.get(0))? {
                moved.push((*old, *new));
            }
        }
        moved
    };
    for (old, _) in &moved {
        rename_log(transaction, old, &passing(old))?;
    }
    for (old, new) in &moved {
        transaction.change(CLIMATE_LOG, ("path = ?1 AND superseded_at IS NULL", new), || {
            let sql = "UPDATE climate_log SET superseded_at = ?2 WHERE path = ?1 AND superseded_at IS NULL";
            transaction.prepare_cached(sql)?.execute(params![new, now])?;
            Ok(())
        })?;
        rename_log(transaction, new, &free_name(transaction, "climate_log", new)?)?;
        rename_log(transaction, &passing(old), new)?;
    }
    Ok(())
}

fn rename_log(transaction: &Transaction<'_>, old: &str, new: &str) -> Result<(), StepError> {
    let ids: Vec<i64> = transaction
        .prepare_cached("SELECT id FROM climate_log WHERE path = ?1")?
        .query_map([old], |row| row.get(0))?
        .collect::<rusqlite::Result<_>>()?;
    for id in ids {
        transaction.change(CLIMATE_LOG, ("id = ?1", &id), || {
            let sql = "UPDATE climate_log SET path = ?2 WHERE id = ?1";
            transaction.prepare_cached(sql)?.execute(params![id, new])?;
            Ok(())
        })?;
    }
    Ok(())
}
