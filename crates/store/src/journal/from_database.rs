//! The journal as a database would have it written: for campaigns that had none.

use rusqlite::{Connection, Row};

use super::{Entry, NamedBytes, NamedRun, ToldAlarm};
use crate::StepError;
use crate::columns::{json_in, key_in};
use crate::standing::{RUN_WORDS, read_word};
use crate::tags::{read_hand_tag, stated_beside};
use ieap_domain::RunKind;

/// An entry with the time at which it was said.
type Said = (String, Entry);

/// Everything that a database holds and no file does, in an order in which it can be said again.
pub(super) fn entries(connection: &Connection) -> Result<Vec<Said>, StepError> {
    let mut said = reads(connection)?;
    for rows in [logs, aliases, gone, tags, words, asked, alarms, commands] {
        said.extend(rows(connection)?);
    }
    Ok(said)
}

fn rows(
    connection: &Connection,
    sql: &str,
    read: impl Fn(&Row<'_>) -> Result<Said, StepError>,
) -> Result<Vec<Said>, StepError> {
    let mut statement = connection.prepare_cached(sql)?;
    let mut rows = statement.query([])?;
    let mut said = Vec::new();
    while let Some(row) = rows.next()? {
        said.push(read(row)?);
    }
    Ok(said)
}

/// Runs in the order in which they came; those of one file that came together stand in one entry.
fn reads(connection: &Connection) -> Result<Vec<Said>, StepError> {
    let mut said: Vec<Said> = Vec::new();
    let mut statement = connection
        .prepare_cached("SELECT id, path, revision, kind, ingested_at, format FROM run ORDER BY id")?;
    let mut found = statement.query([])?;
    while let Some(row) = found.next()? {
        let run = NamedRun {
            name: row.get("path")?,
            revision: row.get("revision")?,
        };
        let of_run = files(connection, row.get("id")?)?;
        let kind_now = key_in(row, "kind", "what a run measures", RunKind::from_key)?;
        let came_at: String = row.get("ingested_at")?;
        let read_by: String = row.get("format")?;
        if let Some((
            at,
            Entry::Read {
                kind,
                files,
                runs,
                reader,
            },
        )) = said.last_mut()
        {
            let is_new = runs.iter().all(|other| other.name != run.name);
            let is_same = *at == came_at && *kind == kind_now && *reader == read_by;
            if is_same && *files == of_run && is_new {
                runs.push(run);
                continue;
            }
        }
        let entry = Entry::Read {
            kind: kind_now,
            reader: read_by,
            files: of_run,
            runs: vec![run],
        };
        said.push((came_at, entry));
    }
    Ok(said)
}

fn files(connection: &Connection, run_id: i64) -> rusqlite::Result<Vec<NamedBytes>> {
    connection
        .prepare_cached("SELECT path, hash FROM run_file WHERE run_id = ?1 ORDER BY ordinal")?
        .query_map([run_id], read_bytes)?
        .collect()
}

fn read_bytes(row: &Row<'_>) -> rusqlite::Result<NamedBytes> {
    Ok(NamedBytes {
        path: row.get("path")?,
        hash: row.get("hash")?,
    })
}

fn logs(connection: &Connection) -> Result<Vec<Said>, StepError> {
    let sql = "SELECT ingested_at, path, hash, revision FROM climate_log ORDER BY id";
    rows(connection, sql, |row| {
        let (file, revision) = (read_bytes(row)?, row.get("revision")?);
        Ok((row.get("ingested_at")?, Entry::Log { file, revision }))
    })
}

fn aliases(connection: &Connection) -> Result<Vec<Said>, StepError> {
    let sql = "SELECT changed_at, path, hash FROM source_file, change_count
               WHERE state = 'alias' AND hash IS NOT NULL AND missing_since IS NULL ORDER BY path";
    rows(connection, sql, |row| {
        let file = read_bytes(row)?;
        Ok((row.get("changed_at")?, Entry::Alias { file }))
    })
}

fn gone(connection: &Connection) -> Result<Vec<Said>, StepError> {
    let sql = "SELECT missing_since, path FROM source_file WHERE missing_since IS NOT NULL ORDER BY path";
    rows(connection, sql, |row| {
        let path: String = row.get(1)?;
        let tags = stated_beside(connection, &path)?;
        Ok((row.get(0)?, Entry::Gone { path, tags }))
    })
}

fn tags(connection: &Connection) -> Result<Vec<Said>, StepError> {
    let sql = "SELECT run_path, key, value, set_by, set_at FROM hand_tag ORDER BY id";
    rows(connection, sql, |row| {
        let tag = read_hand_tag(row)?;
        Ok((tag.set_at.clone(), Entry::Tag(tag)))
    })
}

fn words(connection: &Connection) -> Result<Vec<Said>, StepError> {
    rows(connection, RUN_WORDS, |row| {
        let word = read_word(row)?;
        Ok((word.said_at.clone(), Entry::Word(word)))
    })
}

/// How runs were asked to be fitted.
fn asked(connection: &Connection) -> Result<Vec<Said>, StepError> {
    let sql = "SELECT changed_at, run_path, asked FROM asked_fit, change_count ORDER BY run_path";
    rows(connection, sql, |row| {
        let asked = json_in(row, "asked", "how a fit was asked for")?;
        let run = row.get("run_path")?;
        Ok((row.get("changed_at")?, Entry::Asked { run, asked }))
    })
}

fn alarms(connection: &Connection) -> Result<Vec<Said>, StepError> {
    let sql = "SELECT raised_at, id, sample, parameter, chart, run_path, message FROM alarm ORDER BY id";
    rows(connection, sql, |row| {
        let told = ToldAlarm {
            id: row.get("id")?,
            sample: row.get("sample")?,
            parameter: row.get("parameter")?,
            chart: row.get("chart")?,
            run: row.get("run_path")?,
            message: row.get("message")?,
        };
        Ok((row.get("raised_at")?, Entry::Told(told)))
    })
}

fn commands(connection: &Connection) -> Result<Vec<Said>, StepError> {
    let sql = "SELECT raised_at, id, command_status FROM alarm WHERE command_status IS NOT NULL ORDER BY id";
    rows(connection, sql, |row| {
        let entry = Entry::Command {
            id: row.get("id")?,
            status: row.get("command_status")?,
        };
        Ok((row.get("raised_at")?, entry))
    })
}
