//! The schema of a database, and making it. A database of an earlier schema is made anew from what it was made from.

use std::path::Path;

use ieap_migrations::{NEWEST, SCHEMA};
use rusqlite::{Connection, Transaction, TransactionBehavior};

use super::StoreError;
use super::error::{StepError, named};
use super::place::has_no_tables;
use super::rows::hash_all;

/// Version of the schema in the database; 0 where it is empty.
pub(super) fn version(connection: &Connection) -> rusqlite::Result<i64> {
    connection.pragma_query_value(None, "user_version", |row| row.get(0))
}

/// Makes the schema where there is none: whole or not at all. A database of another one is refused.
pub(super) fn make(connection: &mut Connection, path: &Path) -> Result<(), StoreError> {
    let found =
        version(connection).map_err(|e| StoreError::from_sql(path, "reading the schema version", e))?;
    refuse(found, path)?;
    refuse_unversioned(connection, path, found)?;
    if found == NEWEST {
        return Ok(());
    }
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate);
    let made = transaction.map_err(StepError::from).and_then(|transaction| {
        make_tables(&transaction)?;
        Ok(transaction.commit()?)
    });
    made.map_err(named(path, "making the database"))
}

/// Another program may have done it meanwhile.
fn make_tables(transaction: &Transaction<'_>) -> Result<(), StepError> {
    if version(transaction)? == NEWEST {
        return Ok(());
    }
    transaction.execute_batch(SCHEMA)?;
    transaction.pragma_update(None, "user_version", NEWEST)?;
    hash_all(transaction)
}

/// Refuses a database of another schema.
pub(super) fn refuse(found: i64, path: &Path) -> Result<(), StoreError> {
    let path = path.to_owned();
    match found {
        found if found > NEWEST => Err(StoreError::Newer {
            path,
            found,
            known: NEWEST,
        }),
        1..NEWEST => Err(StoreError::Older {
            path,
            found,
            needed: NEWEST,
        }),
        _ => Ok(()),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn made() -> Connection {
        let mut connection = Connection::open_in_memory().unwrap();
        make(&mut connection, Path::new("memory")).unwrap();
        connection
    }

    #[test]
    fn the_schema_is_sound_and_strict() {
        let connection = made();
        assert_eq!(version(&connection).unwrap(), NEWEST);
        let loose: i64 = connection
            .query_row("SELECT count(*) FROM pragma_table_list WHERE schema = 'main' AND type = 'table' AND strict = 0 AND name NOT LIKE 'sqlite%'", [], |row| row.get(0))
            .unwrap();
        assert_eq!(loose, 0);
    }

    #[test]
    fn a_database_that_forgot_its_version_is_named_as_such_and_left_alone() {
        let mut connection = made();
        connection.pragma_update(None, "user_version", 0).unwrap();
        let refused = make(&mut connection, Path::new("memory")).unwrap_err();
        assert!(matches!(refused, StoreError::NoVersion { .. }), "{refused}");
    }

    #[test]
    fn a_newer_and_an_older_database_are_refused_and_left_alone() {
        for other in [NEWEST + 1, NEWEST - 1] {
            let mut connection = made();
            connection.pragma_update(None, "user_version", other).unwrap();
            let refused = make(&mut connection, Path::new("memory")).unwrap_err();
            let is_told = matches!(refused, StoreError::Newer { .. } | StoreError::Older { .. });
            assert!(is_told, "{refused}");
            assert_eq!(version(&connection).unwrap(), other);
        }
    }
}
