//! What a measurement is known by: its bytes. A name is an attribute of it that may change, and another measurement may have
//! the name then.
//!
//! Words of people hang on it: each line of the journal has the measurement that it is about. Where a file is measured on, or
//! mended, its run continues the measurement of before, and what was said of that holds; unless the earlier bytes lie in the
//! folder again, which makes them a measurement of their own.

use std::collections::BTreeSet;

use rusqlite::{OptionalExtension, Row, params};

use super::columns::{json_in, to_json};
use super::new_run::{Continues, NewRun, ReadDocument, RunRow};
use super::results::retire_of_run;
use super::rows::{RUN, RUN_FILE};
use super::{RunContent, StepError, Transaction};
use ieap_domain::RunKind;

/// What stands between the earlier bytes in `run.continues`.
const BETWEEN: char = ' ';

/// What the measurement of one run is known by: the hash of its file, or, of several files, of one table of a file and of what
/// lies in the folder of modulus logs, one over all that tells it.
pub fn measurement(of_folder: RunKind, contents: &[RunContent], table: &str) -> String {
    let is_log = of_folder == RunKind::Dma;
    match contents {
        [only] if table.is_empty() && !is_log => only.hash.clone(),
        _ => {
            let mut hasher = blake3::Hasher::new();
            hasher.update(if is_log { b"modulus log" } else { b"run" });
            for text in contents
                .iter()
                .map(|content| content.hash.as_str())
                .chain([table])
            {
                hasher.update(&(text.len() as u64).to_le_bytes());
                hasher.update(text.as_bytes());
            }
            hasher.finalize().to_hex().to_string()
        }
    }
}

/// A revision that a new one follows.
#[derive(Debug, Clone)]
struct Before {
    id: i64,
    path: String,
    measurement: String,
    continues: String,
    is_current: bool,
}

/// Makes room for a run under its name, and tells which earlier bytes it continues, as `run.continues` has them.
pub(super) fn make_room(transaction: &Transaction<'_>, now: &str, run: &NewRun) -> Result<String, StepError> {
    let here = before(transaction, "path = ?1 AND superseded_at IS NULL", &run.path)?;
    let is_same = |here: &Before| run.continues == Continues::Same || here.measurement == run.measurement;
    if let Some(here) = here.as_ref().filter(|here| is_same(here)) {
        supersede_row(transaction, now, here.id)?;
        return earlier_of(transaction, &run.measurement, here);
    }
    // Bytes that were here before and come back.
    let known = || before(transaction, "measurement = ?1", &run.measurement);
    let is_there = known()?.is_some_and(|known| !known.is_current && known.path == run.path);
    if !is_there || here.is_some() {
        put_by(transaction, now, &run.path)?;
    }
    let Some(known) = known()?.filter(|known| !known.is_current) else {
        return Ok(String::new());
    };
    // Its other revisions have the name of the one that is current, where there is one.
    let is_free = known.path != run.path
        && before(transaction, "path = ?1 AND superseded_at IS NULL", &known.path)?.is_none();
    if is_free {
        rename_rows(transaction, &known.path, &run.path, &[])?;
    }
    earlier_of(transaction, &run.measurement, &known)
}

/// The newest revision that fits a condition with one parameter; a current one before all others.
fn before(transaction: &Transaction<'_>, condition: &str, key: &str) -> Result<Option<Before>, StepError> {
    let sql = format!(
        "SELECT id, path, measurement, continues, superseded_at IS NULL AS is_current FROM run WHERE {condition}
         ORDER BY is_current DESC, id DESC LIMIT 1"
    );
    let mut statement = transaction.prepare_cached(&sql)?;
    let found = statement.query_row([key], |row| {
        Ok(Before {
            id: row.get("id")?,
            path: row.get("path")?,
            measurement: row.get("measurement")?,
            continues: row.get("continues")?,
            is_current: row.get("is_current")?,
        })
    });
    Ok(found.optional()?)
}

/// The earlier bytes of a run that follows another: those of that one, and of those before it the ones that something was said
/// of.
fn earlier_of(transaction: &Transaction<'_>, own: &str, before: &Before) -> Result<String, StepError> {
    let sql =
        "SELECT EXISTS (SELECT 1 FROM journal_line WHERE name = ?1 AND what IN ('tag', 'word', 'asked'))";
    let mut earlier = vec![before.measurement.clone()];
    for one in before.continues.split(BETWEEN).filter(|one| !one.is_empty()) {
        let is_spoken_of = transaction
            .prepare_cached(sql)?
            .query_row([one], |row| row.get(0))?;
        if is_spoken_of && !earlier.iter().any(|known| known == one) {
            earlier.push(one.to_owned());
        }
    }
    earlier.retain(|one| one != own);
    Ok(earlier.join(&BETWEEN.to_string()))
}

/// Takes a revision out of those that are current, and what was found of it.
pub(super) fn supersede_row(transaction: &Transaction<'_>, now: &str, id: i64) -> Result<(), StepError> {
    transaction.change(RUN, ("id = ?1", &id), || {
        let sql = "UPDATE run SET superseded_at = ?2 WHERE id = ?1";
        transaction.prepare_cached(sql)?.execute(params![id, now])?;
        Ok(())
    })?;
    retire_of_run(transaction, now, id)
}

/// Frees a name: what has it is current no more, and its revisions are kept under another.
pub(super) fn put_by(transaction: &Transaction<'_>, now: &str, path: &str) -> Result<(), StepError> {
    if let Some(here) = before(transaction, "path = ?1", path)? {
        if here.is_current {
            supersede_row(transaction, now, here.id)?;
        }
        rename_rows(transaction, path, &free_name(transaction, "run", path)?, &[])?;
    }
    Ok(())
}

/// A name for what lay under this one before.
pub(super) fn free_name(transaction: &Transaction<'_>, table: &str, path: &str) -> Result<String, StepError> {
    let sql = format!("SELECT EXISTS (SELECT 1 FROM {table} WHERE path = ?1)");
    let mut statement = transaction.prepare_cached(&sql)?;
    let mut number = 1;
    loop {
        let name = format!("{path} (replaced {number})");
        if !statement.query_row([&name], |row| row.get(0))? {
            return Ok(name);
        }
        number += 1;
    }
}

/// Gives all revisions of a run another name, and their files those of `files`: path before and path now.
pub(super) fn rename_rows(
    transaction: &Transaction<'_>,
    old: &str,
    new: &str,
    files: &[(&str, &str)],
) -> Result<(), StepError> {
    let rename = |name: &mut String| {
        if let Some((_, now)) = files.iter().find(|(before, _)| *before == name.as_str()) {
            (*now).clone_into(name);
        }
    };
    for (id, mut reading) in documents::<ReadDocument>(transaction, "reading", "path = ?1", old)? {
        reading.files.iter_mut().for_each(|file| rename(&mut file.path));
        reading
            .origin
            .clocks
            .iter_mut()
            .for_each(|clock| rename(&mut clock.file));
        let document = to_json("what was read of a run", &reading)?;
        transaction.change(RUN, ("id = ?1", &id), || {
            let sql = "UPDATE run SET path = ?2, reading = ?3 WHERE id = ?1";
            transaction
                .prepare_cached(sql)?
                .execute(params![id, new, document])?;
            Ok(())
        })?;
        transaction.change(RUN_FILE, ("run_id = ?1", &id), || {
            // Each once: names may be exchanged.
            let sql = "UPDATE run_file SET path = ?3 WHERE run_id = ?1 AND ordinal = ?2";
            for (ordinal, file) in reading.files.iter().enumerate() {
                transaction
                    .prepare_cached(sql)?
                    .execute(params![id, ordinal as i64, file.path])?;
            }
            Ok(())
        })?;
    }
    Ok(())
}

/// Row ids of runs and a document of each.
pub(super) fn documents<T: serde::de::DeserializeOwned>(
    transaction: &Transaction<'_>,
    column: &'static str,
    condition: &str,
    key: impl rusqlite::ToSql,
) -> Result<Vec<(i64, T)>, StepError> {
    let sql = format!("SELECT id, {column} FROM run WHERE {condition} ORDER BY id");
    let mut statement = transaction.prepare_cached(&sql)?;
    let mut rows = statement.query([key])?;
    let mut found = Vec::new();
    let read = |row: &Row<'_>| -> Result<(i64, T), StepError> {
        Ok((row.get("id")?, json_in(row, column, column)?))
    };
    while let Some(row) = rows.next()? {
        found.push(read(row)?);
    }
    Ok(found)
}

impl RunRow {
    /// Earlier bytes of it, and those of its files.
    pub(super) fn earlier_and_files(&self) -> impl Iterator<Item = &str> {
        let files = self.reading.files.iter().map(|file| file.hash.as_str());
        let earlier = self.continues.split(BETWEEN).filter(|one| !one.is_empty());
        earlier.chain(files)
    }

    /// All that words of people may hang on that hold of this run, where these are the measurements of all current runs: its
    /// own bytes, earlier ones that no other run has now, those of its files alone, and its name, as earlier versions of the
    /// program had it.
    pub(super) fn said_of(&self, current: &BTreeSet<&str>) -> Vec<String> {
        let mut of: Vec<String> = vec![self.measurement.clone()];
        for one in self.earlier_and_files().filter(|one| !current.contains(one)) {
            if !of.iter().any(|known| known == one) {
                of.push(one.to_owned());
            }
        }
        of.push(self.path.clone());
        of
    }
}
