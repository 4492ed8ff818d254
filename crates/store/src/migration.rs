//! The schema's history, and bringing a database up to date.

use std::path::Path;

use rusqlite::Connection;
use rusqlite_migration::{M, Migrations};

use super::StoreError;
use super::error::plain;
use super::place::has_no_tables;
use super::views;

/// Every migration in order; the number of its file is the schema version that it makes. Append only: never change, remove or
/// reorder one. Not even a comment inside a statement: SQLite keeps it with the table, and [`super::schema`] compares it.
pub(super) const HISTORY: [&str; 17] = [
    include_str!("../../../migrations/0001_initial.sql"),
    include_str!("../../../migrations/0002_climate.sql"),
    include_str!("../../../migrations/0003_modulus_logs.sql"),
    include_str!("../../../migrations/0004_origin.sql"),
    include_str!("../../../migrations/0005_diagnosis.sql"),
    include_str!("../../../migrations/0006_alarms.sql"),
    include_str!("../../../migrations/0007_fit_along.sql"),
    include_str!("../../../migrations/0008_no_steps.sql"),
    include_str!("../../../migrations/0009_standing.sql"),
    include_str!("../../../migrations/0010_asked_fit.sql"),
    include_str!("../../../migrations/0011_unread_files.sql"),
    include_str!("../../../migrations/0012_integrity.sql"),
    include_str!("../../../migrations/0013_diagnosis_document.sql"),
    include_str!("../../../migrations/0014_run_comparison.sql"),
    include_str!("../../../migrations/0015_impedance.sql"),
    include_str!("../../../migrations/0016_journal_lines.sql"),
    include_str!("../../../migrations/0017_shown.sql"),
];

/// Schema version that this program writes.
pub(super) const NEWEST: i64 = HISTORY.len() as i64;

/// Version of the schema in the database; 0 where it is empty.
pub(super) fn version(connection: &Connection) -> rusqlite::Result<i64> {
    connection.pragma_query_value(None, "user_version", |row| row.get(0))
}

/// Brings the database up to the newest schema, after a backup where it holds an older one; each migration
/// runs in a transaction of its own. A newer database is refused.
pub(super) fn migrate(connection: &mut Connection, path: &Path) -> Result<(), StoreError> {
    let found =
        version(connection).map_err(|e| StoreError::from_sql(path, "reading the schema version", e))?;
    if found > NEWEST {
        return Err(StoreError::Newer {
            path: path.to_owned(),
            found,
            known: NEWEST,
        });
    }
    refuse_unversioned(connection, path, found)?;
    if found == NEWEST {
        return Ok(());
    }
    if found > 0 {
        back_up(connection, path, found)?;
    }
    // SQLite refuses to change a table under a view; they are made again when the database is opened.
    views::drop_all(connection).map_err(|e| StoreError::from_sql(path, "taking the views out", e))?;
    let steps = HISTORY.iter().map(|sql| M::up(sql)).collect::<Vec<_>>();
    Migrations::new(steps)
        .to_latest(connection)
        .map_err(|error| match error {
            rusqlite_migration::Error::RusqliteError { err, .. } if !is_of_schema(&err) => {
                StoreError::from_sql(path, "bringing the schema up to date", err)
            }
            other => StoreError::Migration {
                path: path.to_owned(),
                found,
                needed: NEWEST,
                detail: match other {
                    rusqlite_migration::Error::RusqliteError { err, .. } => plain(&err),
                    other => other.to_string(),
                },
            },
        })
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

    /// Released migrations, by the BLAKE3 of their text.
    const RELEASED: [&str; 2] = [
        "f9a4411f7dd05d6ee0afd506271f76962fa6944e63b267910d3e356bd8ee129f",
        "4596c683ce4e61472008a5bc6504659763cdce692a056fea003ce82fdf756e8f",
    ];

    #[test]
    fn released_migrations_are_unchanged() {
        for (number, (sql, hash)) in HISTORY.iter().zip(RELEASED).enumerate() {
            assert_eq!(
                blake3::hash(sql.as_bytes()).to_hex().as_str(),
                hash,
                "migration {}",
                number + 1
            );
        }
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
        for (version, (path, sql)) in (1..).zip(files.iter().zip(HISTORY)) {
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
    fn files_of_the_first_schema_stay_and_may_be_logs() {
        let mut connection = Connection::open_in_memory().unwrap();
        let first = vec![M::up(HISTORY[0])];
        Migrations::new(first).to_latest(&mut connection).unwrap();
        let sql = "INSERT INTO source_file VALUES ('runs/a', 1, 2, 3, 'h', 'run', 'x/1', NULL, NULL)";
        connection.execute_batch(sql).unwrap();
        let steps = HISTORY.iter().map(|sql| M::up(sql)).collect::<Vec<_>>();
        Migrations::new(steps).to_latest(&mut connection).unwrap();
        connection
            .execute_batch("UPDATE source_file SET state = 'log'")
            .unwrap();
        let kept: (String, i64, String) = connection
            .query_row("SELECT path, inode, state FROM source_file", [], |row| {
                Ok((row.get("path")?, row.get("inode")?, row.get("state")?))
            })
            .unwrap();
        assert_eq!(kept, ("runs/a".to_owned(), 3, "log".to_owned()));
        assert!(
            connection
                .execute_batch("UPDATE source_file SET state = 'x'")
                .is_err()
        );
    }

    #[test]
    fn errors_of_the_system_that_were_stored_as_refusals_are_forgotten_and_other_refusals_stay() {
        let mut connection = Connection::open_in_memory().unwrap();
        let steps = |count: usize| {
            HISTORY
                .iter()
                .take(count)
                .map(|sql| M::up(sql))
                .collect::<Vec<_>>()
        };
        let place = HISTORY.iter().position(|sql| sql.contains("TABLE unread_file"));
        let before = place.unwrap();
        Migrations::new(steps(before)).to_latest(&mut connection).unwrap();
        for (path, code) in [("runs/a", "not-read"), ("runs/b", "no-reader")] {
            let sql = "INSERT INTO source_file VALUES (?1, 1, 2, 3, NULL, 'refused', 'x/1', ?2, NULL)";
            let issue =
                format!(r#"{{"severity":"error","code":"{code}","place":"","message":"","mend":""}}"#);
            connection.execute(sql, [path, &issue]).unwrap();
        }
        Migrations::new(steps(before + 1))
            .to_latest(&mut connection)
            .unwrap();
        let left: String = connection
            .query_row(
                "SELECT group_concat(path || changed_ns) FROM source_file",
                [],
                |row| row.get(0),
            )
            .unwrap();
        assert_eq!(left, "runs/b0");
    }

    #[test]
    fn a_stored_diagnosis_keeps_its_document() {
        let mut connection = Connection::open_in_memory().unwrap();
        let steps = |count: usize| {
            HISTORY
                .iter()
                .take(count)
                .map(|sql| M::up(sql))
                .collect::<Vec<_>>()
        };
        let place = HISTORY
            .iter()
            .position(|sql| sql.contains("DROP TABLE diagnosis_effect"));
        let before = place.unwrap();
        Migrations::new(steps(before)).to_latest(&mut connection).unwrap();
        let sql = "INSERT INTO diagnosis VALUES (1, 'group', 'S1', 'h', 'lumped-2', 'l', 7, 99, '0.1.0', 'named', 0.01, 0.5,
                       '{}', '2026-11-20T06:00:00Z', NULL);
                   INSERT INTO diagnosis_effect VALUES (1, 0, 'warburg', NULL, 0.01);
                   INSERT INTO diagnosis_parameter VALUES (1, 0, 0, 'strength', 1.0, NULL, NULL, NULL, 0, NULL)";
        connection.execute_batch(sql).unwrap();
        Migrations::new(steps(before + 1))
            .to_latest(&mut connection)
            .unwrap();
        let kept: (String, i64, String) = connection
            .query_row(
                "SELECT name, draws, document FROM diagnosis WHERE superseded_at IS NULL",
                [],
                |row| Ok((row.get("name")?, row.get("draws")?, row.get("document")?)),
            )
            .unwrap();
        assert_eq!(kept, ("S1".to_owned(), 99, "{}".to_owned()));
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
    fn a_migration_that_fails_says_why_without_its_statements() {
        let mut connection = Connection::open_in_memory().unwrap();
        let first = vec![M::up(HISTORY[0])];
        Migrations::new(first).to_latest(&mut connection).unwrap();
        connection.execute_batch("DROP TABLE source_file").unwrap();
        let folder = tempfile::tempdir().unwrap();
        let refused = migrate(&mut connection, &folder.path().join("campaign.db")).unwrap_err();
        let told = refused.to_string();
        assert!(told.contains("from schema 1 to"), "{told}");
        assert!(
            told.contains("no such table: source_file") && !told.contains("CREATE"),
            "{told}"
        );
    }

    #[test]
    fn a_newer_database_is_refused_and_left_alone() {
        let mut connection = Connection::open_in_memory().unwrap();
        connection
            .pragma_update(None, "user_version", NEWEST + 1)
            .unwrap();
        let refused = migrate(&mut connection, Path::new("memory")).unwrap_err();
        assert!(matches!(refused, StoreError::Newer { .. }), "{refused}");
        assert_eq!(version(&connection).unwrap(), NEWEST + 1);
    }

    #[test]
    fn an_older_database_is_backed_up_first() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("campaign.db");
        let connection = Connection::open(&path).unwrap();
        connection
            .execute_batch("CREATE TABLE kept (a); INSERT INTO kept VALUES (7)")
            .unwrap();
        back_up(&connection, &path, 3).unwrap();
        let backup = Connection::open(folder.path().join("campaign.db.schema-3.backup")).unwrap();
        let kept: i64 = backup
            .query_row("SELECT a FROM kept", [], |row| row.get(0))
            .unwrap();
        assert_eq!(kept, 7);
    }
}
