//! The schema's history, and bringing a database up to date.

use std::path::Path;

use rusqlite::{Connection, Transaction, TransactionBehavior};

use super::StoreError;
use super::error::plain;
use super::place::has_no_tables;
use super::{seal, views};

/// The schema that the history begins with, and what was done to it since; the number of a file is the schema version that it
/// makes. Append only: never change, remove or reorder one. Not even a comment inside a statement: SQLite keeps it with the
/// table, and [`super::schema`] compares it.
pub(super) const HISTORY: [&str; 2] = [
    include_str!("../../../migrations/0017_base.sql"),
    include_str!("../../../migrations/0018_result.sql"),
];

/// The oldest schema that can be brought up to date. What an older one says its journal says too.
const OLDEST: i64 = 17;
/// Schema version that this program writes.
pub(super) const NEWEST: i64 = OLDEST + HISTORY.len() as i64 - 1;

/// Version of the schema in the database; 0 where it is empty.
pub(super) fn version(connection: &Connection) -> rusqlite::Result<i64> {
    connection.pragma_query_value(None, "user_version", |row| row.get(0))
}

/// Brings the database up to the newest schema and seals it, after a backup where it holds an older one: whole or not at all. A
/// newer database is refused, and one that is too old.
pub(super) fn migrate(connection: &mut Connection, path: &Path) -> Result<(), StoreError> {
    let found =
        version(connection).map_err(|e| StoreError::from_sql(path, "reading the schema version", e))?;
    refuse(found, path)?;
    refuse_unversioned(connection, path, found)?;
    if found == NEWEST {
        return Ok(());
    }
    if found > 0 {
        back_up(connection, path, found)?;
    }
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate);
    let migrated = transaction.and_then(|transaction| {
        to_newest(&transaction)?;
        transaction.commit()
    });
    migrated.map_err(|error| {
        if is_of_schema(&error) {
            StoreError::Migration {
                path: path.to_owned(),
                found,
                needed: NEWEST,
                detail: plain(&error),
            }
        } else {
            StoreError::from_sql(path, "bringing the schema up to date", error)
        }
    })
}

/// Does what was done to the schema since the version of the database; another program may have done it meanwhile.
fn to_newest(transaction: &Transaction<'_>) -> rusqlite::Result<()> {
    let found = version(transaction)?;
    if found == NEWEST {
        return Ok(());
    }
    // SQLite refuses to change a table under a view; they are made again when the database is opened.
    views::drop_all(transaction)?;
    for (makes, sql) in (OLDEST..).zip(HISTORY).filter(|(makes, _)| *makes > found) {
        transaction.execute_batch(sql)?;
        transaction.pragma_update(None, "user_version", makes)?;
    }
    seal::seal_all(transaction)
}

/// Refuses a database that this program cannot bring up to date.
pub(super) fn refuse(found: i64, path: &Path) -> Result<(), StoreError> {
    let (path, known) = (path.to_owned(), NEWEST);
    match found {
        found if found > NEWEST => Err(StoreError::Newer { path, found, known }),
        1..OLDEST => Err(StoreError::TooOld {
            path,
            found,
            needed: OLDEST,
        }),
        _ => Ok(()),
    }
}

/// Whether an error says that the database is not what its version says, rather than that it cannot be written.
fn is_of_schema(error: &rusqlite::Error) -> bool {
    use rusqlite::ErrorCode::{ConstraintViolation, Unknown};
    matches!(
        error.sqlite_error_code(),
        None | Some(Unknown | ConstraintViolation)
    )
}

/// Refuses a database that holds tables and says that it holds none.
pub(super) fn refuse_unversioned(connection: &Connection, path: &Path, found: i64) -> Result<(), StoreError> {
    let failed = |e| StoreError::from_sql(path, "reading the schema", e);
    if found == 0 && !has_no_tables(connection).map_err(failed)? {
        Err(StoreError::NoVersion {
            path: path.to_owned(),
        })
    } else {
        Ok(())
    }
}

/// Copies the database to `campaign.db.schema-<version>.backup` beside it.
fn back_up(connection: &Connection, path: &Path, found: i64) -> Result<(), StoreError> {
    let mut name = path.as_os_str().to_owned();
    name.push(format!(".schema-{found}.backup"));
    connection
        .backup("main", Path::new(&name), None)
        .map_err(|e| StoreError::from_sql(path, "backing up before a migration", e))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A database in memory with the first schema of the history.
    fn first() -> Connection {
        let connection = Connection::open_in_memory().unwrap();
        connection.execute_batch(HISTORY[0]).unwrap();
        connection.pragma_update(None, "user_version", OLDEST).unwrap();
        connection
    }

    #[test]
    fn the_number_of_a_file_is_the_schema_version_that_it_makes() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../migrations");
        let files = std::fs::read_dir(folder)
            .unwrap()
            .map(|file| file.unwrap().path());
        let mut files: Vec<_> = files
            .filter(|path| path.extension().is_some_and(|e| e == "sql"))
            .collect();
        files.sort();
        assert_eq!(files.len(), HISTORY.len());
        for (version, (path, sql)) in (OLDEST..).zip(files.iter().zip(HISTORY)) {
            let name = path.file_name().unwrap().to_string_lossy();
            assert!(name.starts_with(&format!("{version:04}_")), "{name}");
            assert_eq!(std::fs::read_to_string(path).unwrap(), sql, "{name}");
        }
    }

    #[test]
    fn the_schema_is_sound_and_strict() {
        let mut connection = Connection::open_in_memory().unwrap();
        migrate(&mut connection, Path::new("memory")).unwrap();
        assert_eq!(version(&connection).unwrap(), NEWEST);
        let loose: i64 = connection
            .query_row("SELECT count(*) FROM pragma_table_list WHERE schema = 'main' AND type = 'table' AND strict = 0 AND name NOT LIKE 'sqlite%'", [], |row| row.get(0))
            .unwrap();
        assert_eq!(loose, 0);
    }

    #[test]
    fn how_a_fit_was_asked_for_stays_when_results_go() {
        let mut connection = first();
        let sql = "INSERT INTO run (id, path, revision, state, status, status_evidence, format, reader_version, is_step_response,
                       time_zero_is_step, original_metadata, data_hash, tag_digest, ingested_at)
                   VALUES (1, 'runs/a.csv', 1, 'ready', '', '', '', 1, 1, 1, '[]', '', '', '');
                   UPDATE run SET superseded_at = 'now';
                   INSERT INTO run (id, path, revision, state, status, status_evidence, format, reader_version, is_step_response,
                       time_zero_is_step, original_metadata, data_hash, tag_digest, ingested_at)
                   VALUES (2, 'runs/a.csv', 2, 'ready', '', '', '', 1, 1, 1, '[]', '', '', '');
                   INSERT INTO fit (run_id, input_hash, model, model_version, code_version, method, converged, why_stopped,
                       n_samples, noise, issues, evaluations, made_at, asked)
                   SELECT value, '', '', 1, '', '', 1, '', 1, '[]', '[]', 1, '', '{\"model\":\"lumped-' || value || '\"}'
                   FROM json_each('[1, 2]')";
        connection.execute_batch(sql).unwrap();
        let folder = tempfile::tempdir().unwrap();
        migrate(&mut connection, &folder.path().join("campaign.db")).unwrap();
        let asked: (String, String) = connection
            .query_row("SELECT run_path, asked FROM asked_fit", [], |row| {
                Ok((row.get(0)?, row.get(1)?))
            })
            .unwrap();
        assert_eq!(
            asked,
            ("runs/a.csv".to_owned(), "{\"model\":\"lumped-2\"}".to_owned())
        );
        assert!(folder.path().join("campaign.db.schema-17.backup").exists());
    }

    #[test]
    fn a_database_that_forgot_its_version_is_named_as_such_and_left_alone() {
        let mut connection = Connection::open_in_memory().unwrap();
        migrate(&mut connection, Path::new("memory")).unwrap();
        connection.pragma_update(None, "user_version", 0).unwrap();
        let refused = migrate(&mut connection, Path::new("memory")).unwrap_err();
        assert!(matches!(refused, StoreError::NoVersion { .. }), "{refused}");
    }

    #[test]
    fn a_migration_that_fails_says_why_without_its_statements_and_leaves_the_database() {
        let mut connection = first();
        connection.execute_batch("DROP TABLE fit_along").unwrap();
        let folder = tempfile::tempdir().unwrap();
        let refused = migrate(&mut connection, &folder.path().join("campaign.db")).unwrap_err();
        let told = refused.to_string();
        assert!(told.contains("from schema 17 to"), "{told}");
        assert!(
            told.contains("no such table: fit_along") && !told.contains("CREATE"),
            "{told}"
        );
        assert_eq!(version(&connection).unwrap(), OLDEST);
        assert!(connection.execute_batch("SELECT * FROM fit").is_ok());
    }

    #[test]
    fn a_newer_and_a_too_old_database_are_refused_and_left_alone() {
        for other in [NEWEST + 1, OLDEST - 1] {
            let mut connection = first();
            connection.pragma_update(None, "user_version", other).unwrap();
            let refused = migrate(&mut connection, Path::new("memory")).unwrap_err();
            let is_told = matches!(refused, StoreError::Newer { .. } | StoreError::TooOld { .. });
            assert!(is_told, "{refused}");
            assert_eq!(version(&connection).unwrap(), other);
        }
    }
}
